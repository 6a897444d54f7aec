// Memory that one solve leaves to the next of the same thread, so that none is allocated once the sizes have settled.
#pragma once

#include <utility>
#include <vector>

namespace cd {

// A vector that takes over the memory that an earlier object with the same User left in this thread. Its size and content are arbitrary.
template <class T, class User> class HandedOn {
    public:
	HandedOn()
	{
		if (left().empty())
			return;
		values = std::move(left().back());
		left().pop_back();
	}
	~HandedOn() { left().push_back(std::move(values)); }
	HandedOn(const HandedOn&) = delete;
	HandedOn& operator=(const HandedOn&) = delete;

	std::vector<T> values;

    private:
	// A stack: where several live at once, the one that ends first leaves its vector to the one that begins next.
	static std::vector<std::vector<T>>& left()
	{
		static thread_local std::vector<std::vector<T>> all;
		return all;
	}
};

} // namespace cd
