// Memory that one solve leaves to the next, so that none is allocated once the sizes have settled.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace cd {

// Belongs to whoever solves one problem after another, and ends with it. A system refers to it (ContactSystem::memory). Only one thread at a time may
// solve systems that refer to the same one.
class Workspace {
	template <class, class> friend class Borrowed;

	static inline std::atomic<std::size_t> kinds { 0 };
	std::vector<std::vector<std::shared_ptr<void>>> shelves; // one for each T and User of Borrowed; the last one returned is the next one lent
};

// An object as the last Borrowed of the same T and User has left it in the workspace; a new one if there is none, or no workspace.
template <class T, class User = T> class Borrowed {
    public:
	explicit Borrowed(Workspace* w)
	    : workspace(w)
	{
		if (workspace && !shelf().empty()) {
			object = std::static_pointer_cast<T>(shelf().back());
			shelf().pop_back();
		} else
			object = std::make_shared<T>();
	}
	~Borrowed()
	{
		if (!workspace)
			return;
		try {
			shelf().push_back(std::move(object));
		} catch (const std::bad_alloc&) { // then the next one is new
		}
	}
	Borrowed(const Borrowed&) = delete;
	Borrowed& operator=(const Borrowed&) = delete;

	T& operator*() const { return *object; }
	T* operator->() const { return object.get(); }

    private:
	std::vector<std::shared_ptr<void>>& shelf()
	{
		static const std::size_t kind = Workspace::kinds++;
		if (workspace->shelves.size() <= kind)
			workspace->shelves.resize(kind + 1);
		return workspace->shelves[kind];
	}

	Workspace* const workspace;
	std::shared_ptr<T> object;
};

} // namespace cd
