#include "sweeps/packed_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cd {

PackedBodies::Found PackedBodies::classify(const std::vector<BodyVelocity>& bodies, Threads* threads)
{
	const bool known = kinds.size() == bodies.size();
	kinds.resize(bodies.size());
	inverseRadii.resize(bodies.size());
	const auto classify = [&](std::size_t from, std::size_t to) {
		Found found { known, known, false };
		for (std::size_t i = from; i < to; i++) {
			const Motion<double> w = motionOf(bodies[i].w);
			found.twisted = found.twisted || bodies[i].twisted > 0;
			Kind& kind = kinds[i];
			if (known && w.x == kind.w.x && w.y == kind.w.y && w.spin == kind.w.spin)
				continue;
			found.sameMasses = false;
			const bool turns = w.x > 0 && w.spin > 0, uniform = w.x == w.y && (w.x > 0 || w.spin == 0);
			const double k = turns ? std::sqrt(w.x / w.spin) : 1;
			found.sameKinds = found.sameKinds && uniform == kind.uniform && turns == kind.turns;
			kind = { w, k, uniform, turns };
			inverseRadii[i] = 1 / k;
		}
		return found;
	};
	const auto both = [](const Found& a, const Found& b) {
		return Found { a.sameKinds && b.sameKinds, a.sameMasses && b.sameMasses, a.twisted || b.twisted };
	};
	return reduceRanges<Found>(threads, bodies.size(), classify, both);
}

void PackedBodies::number(const Partition& partition, const Blocks& blocks, std::vector<Ends>& ofContacts)
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

void PackedBodies::pack(int32_t block, const std::vector<BodyVelocity>& bodies)
{
	for (const std::size_t i : ofBlock[block]) {
		if (i + fetchedAhead < ofBlock[block].to) {
			__builtin_prefetch(&bodies[at[i + fetchedAhead]]);
			__builtin_prefetch(&kinds[at[i + fetchedAhead]]);
		}
		const BodyVelocity& b = bodies[at[i]];
		now[i].w = b.w[0];
		free[i] = { b.v[0], b.v[1], b.v[2] * kinds[at[i]].radius, b.pushed };
		const double inverse = std::max(b.w[0], b.w[1]);
		masses[i] = inverse > 0 ? 1 / inverse : 0;
	}
	now[nobody(block)] = {};
}

void PackedBodies::store(int32_t block, std::vector<BodyVelocity>& bodies) const
{
	for (const std::size_t i : ofBlock[block]) {
		if (i + fetchedAhead < ofBlock[block].to) {
			__builtin_prefetch(&bodies[at[i + fetchedAhead]], 1);
			__builtin_prefetch(&inverseRadii[at[i + fetchedAhead]]);
		}
		BodyVelocity& b = bodies[at[i]];
		if (!(b.w[0] > 0 || b.w[1] > 0 || b.w[2] > 0))
			continue; // immobile: keeps its velocity
		b.v[0] = now[i].vx;
		b.v[1] = now[i].vy;
		// Adds only the change, so that a spin that nothing changes stays the same to the last bit.
		b.v[2] += (now[i].spin - free[i].spin) * inverseRadii[at[i]];
	}
}

} // namespace cd
