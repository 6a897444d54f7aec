#include "sweeps/packed_problem.hpp"

#include <atomic>
#include <cassert>

namespace cd {

PackedProblem::Same PackedProblem::pack(ContactSystem& system, Threads* threads)
{
	assert(system.contacts.postponed() || system.consistent());
	const PackedBodies::Found found = bodies.classify(system.bodies, threads);
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
bool PackedProblem::fill(const ContactSystem& system, Threads* threads)
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

void PackedProblem::store(ContactSystem& system, Threads* threads) const
{
	double* const beside = system.contacts.postponed() ? system.contacts.storeBeside() : nullptr;
	blocks.inEvery(threads, [&](int32_t block) {
		contacts.forImpulses(block, [&](int32_t contact, const Components<double>& p) {
			if (!beside)
				return setImpulse(system.contacts[contact], p);
			beside[2 * contact] = p.n;
			beside[2 * contact + 1] = p.t;
		});
		bodies.store(block, system.bodies);
	});
}

} // namespace cd
