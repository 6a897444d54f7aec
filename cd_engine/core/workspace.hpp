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

	struct Shelf {
		virtual ~Shelf() = default;
	};
	template <class T> struct ShelfOf : Shelf {
		std::vector<std::unique_ptr<T>> objects; // the last one returned is the next one lent
	};

	static std::size_t newKind()
	{
		static std::atomic<std::size_t> kinds { 0 };
		return kinds++;
	}
	template <class T, class User> std::vector<std::unique_ptr<T>>& shelf()
	{
		static const std::size_t kind = newKind();
		if (shelves.size() <= kind)
			shelves.resize(kind + 1);
		if (!shelves[kind])
			shelves[kind] = std::make_unique<ShelfOf<T>>();
		return static_cast<ShelfOf<T>&>(*shelves[kind]).objects;
	}

	std::vector<std::unique_ptr<Shelf>> shelves; // one for each T and User
};

// An object as the last Borrowed of the same T and User has left it in the workspace; a new one if there is none, or no workspace.
template <class T, class User = T> class Borrowed {
    public:
	explicit Borrowed(Workspace* w)
	    : workspace(w)
	{
		if (workspace && !shelf().empty()) {
			object = std::move(shelf().back());
			shelf().pop_back();
		} else
			object = std::make_unique<T>();
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
	std::vector<std::unique_ptr<T>>& shelf() { return workspace->shelf<T, User>(); }

	Workspace* const workspace;
	std::unique_ptr<T> object;
};

} // namespace cd
