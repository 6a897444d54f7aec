// Memory that one solve of a thread leaves to the next, so that none is asked for once sizes have settled.
#pragma once

#include <utility>
#include <vector>

namespace cd {

// A vector that starts with what the last one of the same User in this thread left behind, of unknown size and content. A second one at
// the same time starts empty.
template <class T, class User> class HandedOn {
    public:
	HandedOn()
	    : values(std::move(left()))
	{
	}
	~HandedOn() { left() = std::move(values); }
	HandedOn(const HandedOn&) = delete;
	HandedOn& operator=(const HandedOn&) = delete;

	std::vector<T> values;

    private:
	static std::vector<T>& left()
	{
		static thread_local std::vector<T> one;
		return one;
	}
};

} // namespace cd
