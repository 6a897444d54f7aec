// The numbers from .. to - 1.
#pragma once

#include <cstddef>

namespace cd {

struct Range {
	struct Number {
		std::size_t i;
		std::size_t operator*() const { return i; }
		void operator++() { i++; }
		bool operator!=(const Number& other) const { return i != other.i; }
	};
	Number begin() const { return { from }; }
	Number end() const { return { to }; }
	std::size_t size() const { return to - from; }

	std::size_t from = 0, to = 0;
};

} // namespace cd
