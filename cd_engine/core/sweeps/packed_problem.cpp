#include "sweeps/packed_problem.hpp"

#include <atomic>
#include <cassert>

namespace cd {

template <class Space> auto PackedProblem<Space>::pack(ContactSystem& system, Threads* threads) -> Same
{
	assert(system.contacts.postponed() || system.consistent());
	const auto found = bodies.classify(system.bodies, threads);
	// The contacts come from the step itself where they link the same bodies as those that were grouped.
	if (!found.sameKinds || !found.sameMasses || !partition.knows(system) || system.contacts.solvedBeside()
	    || blocks.contacts.size() != system.contacts.size())
		system.contacts.make();
	twisted = found.twisted;
	const bool others = partition.update(system, threads);
	contacts.makeSprings(system.contacts.compliant);
	if (!others && found.sameKinds && !contacts.ofBlock.empty() && fill(system, threads))
		return { true, found.sameMasses };
	system.contacts.make();
	blocks.cut(partition.links, partition.freedom);
	bodies.number(partition, blocks, contacts.ends);
	contacts.group(system.contacts, blocks, bodies);
	contacts.makeSprings(system.contacts.compliant);
	fill(system, threads);
	return { false, found.sameMasses };
}

// Returns false if a contact is no longer what it was when groups were made.
template <class Space> bool PackedProblem<Space>::fill(const ContactSystem& system, Threads* threads)
{
	std::atomic<bool> same { true };
	blocks.inEvery(threads, [&](int32_t block) {
		if (same && contacts.fill(block, system.contacts, bodies))
			bodies.pack(block, system.bodies);
		else
			same = false;
	});
	return same;
}

template <class Space> void PackedProblem<Space>::store(ContactSystem& system, Threads* threads) const
{
	ImpulseOf<Space>* const beside = system.contacts.postponed() ? system.contacts.storeBeside() : nullptr;
	blocks.inEvery(threads, [&](int32_t block) {
		contacts.forImpulses(block, [&](int32_t contact, const ImpulseOf<Space>& p) {
			if (beside)
				beside[contact] = p;
			else
				setImpulse(system.contacts[contact], p);
		});
		bodies.store(block, system.bodies);
	});
}

template struct PackedProblem<Plane>;
template struct PackedProblem<RollingPlane>;
template struct PackedProblem<Space3>;

} // namespace cd
