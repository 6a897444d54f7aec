// Contacts that go straight into the groups of a sweep.
#pragma once

#include "kernels/group.hpp"
#include "problem/problem.hpp"

namespace cd {

template <class Space> class GroupSource : public RowSource<Space> {
    public:
	// Writes contacts into the lanes of `count` groups, eight a group. inverseRadius: of every body, one over its radius of gyration; springs: of
	// the groups, null if contacts are rigid. Sets a bit of `left` for each lane that only row() can tell, and for every empty lane (-1).
	virtual void fill(const int32_t* contacts, std::size_t count, const double* inverseRadius, Group<Space>* groups, GroupSprings<Space>* springs,
	    uint8_t* left) const = 0;

    protected:
	~GroupSource() = default;
};

} // namespace cd
