#include "sweeps/packed_bodies.hpp"

#include <algorithm>
#include <utility>

namespace cd {

template <class Space> auto PackedBodies<Space>::classify(const std::vector<BodyVelocity>& bodies, Threads* threads) -> Found
{
	const bool known = kinds.size() == bodies.size();
	kinds.resize(bodies.size());
	inverseRadii.resize(bodies.size());
	const auto classify = [&](std::size_t from, std::size_t to) {
		Found found { known, known, false };
		for (std::size_t i = from; i < to; i++) {
			found.twisted = found.twisted || bodies[i].twisted > 0;
			Kind& kind = kinds[i];
			if (known && std::equal(kind.w, kind.w + Space::freedoms, bodies[i].w))
				continue;
			found.sameMasses = false;
			const Kind before = kind;
			kind = packedKind(bodies[i]);
			found.sameKinds = found.sameKinds && kind.uniform == before.uniform && kind.turns == before.turns;
			inverseRadii[i] = 1 / kind.radius;
		}
		return found;
	};
	const auto both = [](const Found& a, const Found& b) {
		return Found { a.sameKinds && b.sameKinds, a.sameMasses && b.sameMasses, a.twisted || b.twisted };
	};
	return reduceRanges<Found>(threads, bodies.size(), classify, both);
}

template <class Space> void PackedBodies<Space>::number(const Partition& partition, const Blocks& blocks, std::vector<Ends>& ofContacts)
{
	place.assign(kinds.size(), -1);
	metIn.assign(kinds.size(), -1);
	ofContacts.resize(partition.links.size());
	ofBlock.resize(blocks.count());
	at.clear();
	for (std::size_t block = 0; block < blocks.count(); block++) {
		ofBlock[block].from = at.size();
		const auto number = [&](int32_t body) {
			const int32_t in = partition.freedom[body] > 0 ? 0 : static_cast<int32_t>(block);
			if (std::exchange(metIn[body], in) != in) {
				place[body] = static_cast<int32_t>(at.size());
				at.push_back(body);
			}
			return place[body];
		};
		for (const std::size_t k : blocks.contactsOf(block)) {
			const int32_t i = blocks.contacts[k];
			ofContacts[i].a = number(partition.links[i].a);
			ofContacts[i].b = number(partition.links[i].b);
		}
		ofBlock[block].to = at.size();
	}
	now.resize(nobody(static_cast<int32_t>(blocks.count())));
	free.resize(at.size());
	masses.resize(at.size());
}

template <class Space> void PackedBodies<Space>::pack(int32_t block, const std::vector<BodyVelocity>& bodies)
{
	for (const std::size_t i : ofBlock[block]) {
		if (i + fetchedAhead < ofBlock[block].to) {
			__builtin_prefetch(&bodies[at[i + fetchedAhead]]);
			__builtin_prefetch(&kinds[at[i + fetchedAhead]]);
		}
		const BodyVelocity& b = bodies[at[i]];
		now[i].w = b.w[0];
		free[i] = PackedBody::of(b, kinds[at[i]].radius, b.pushed);
		const double inverse = inverseMass(b);
		masses[i] = inverse > 0 ? 1 / inverse : 0;
	}
	now[nobody(block)] = {};
}

template <class Space> void PackedBodies<Space>::store(int32_t block, std::vector<BodyVelocity>& bodies) const
{
	for (const std::size_t i : ofBlock[block]) {
		if (i + fetchedAhead < ofBlock[block].to) {
			__builtin_prefetch(&bodies[at[i + fetchedAhead]], 1);
			__builtin_prefetch(&inverseRadii[at[i + fetchedAhead]]);
		}
		BodyVelocity& b = bodies[at[i]];
		if (isMovable(b)) // others keep their velocities
			now[i].store(b, free[i], inverseRadii[at[i]]);
	}
}

template class PackedBodies<Plane>;
template class PackedBodies<RollingPlane>;
template class PackedBodies<Space3>;

} // namespace cd
