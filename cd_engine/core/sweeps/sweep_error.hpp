// The error of residual.hpp from packed contacts, in the order of the sweep. It costs about three sweeps instead of thirty: a first pass adds up
// velocities and what acts on each body, a second one the misses.
#pragma once

#include "error/error.hpp"
#include "sweeps/packed_problem.hpp"

namespace cd {

template <class Space> class SweepError {
	using ContactSystem = cd::ContactSystem<Space>;
	using PackedBody = PackedBodyIn<Space>;
	using PackedBodies = cd::PackedBodies<Space>;
	using PackedContacts = cd::PackedContacts<Space>;
	using PackedProblem = cd::PackedProblem<Space>;
	using Group = cd::Group<Space>;

    public:
	// Prepares the sums for a problem that has just been packed.
	void prepare(const ContactSystem&, const PackedProblem&, typename PackedProblem::Same);
	// The velocities of the packed impulses, in the member w with what acts on each body, without external torques [m/s]. Recomputed only if
	// impulses have changed since, which the caller has to tell.
	const std::vector<PackedBody>& velocities(const PackedProblem&, Threads*);
	void impulsesHaveChanged() { current = false; }
	Residual operator()(const ContactSystem&, const PackedProblem&, Threads*);

    private:
	// Groups next to each other whose contacts all add to one sum; sum -1: several sums within a group.
	struct Run {
		Range groups;
		int32_t sum;
		std::size_t contacts;
	};
	struct Ranges {
		Range sums, runs, underHeavy;
	};
	void numberSums(const PackedProblem&);
	void addToRuns(const PackedContacts&, Ranges&, std::size_t group);
	void findHeavyOnLight(const ContactSystem&, const PackedProblem&);
	void twistBodies(const ContactSystem&, const PackedProblem&, Threads*);
	void findLeastHeavy();
	void addContacts(const PackedContacts&, int32_t block);
	void addEach(const PackedContacts&, const Range& groups);
	void addBodies(const PackedBodies&, int32_t block);

	bool current = false; // whether `moved` has the velocities of the present impulses
	std::vector<PackedBody> moved; // w: magnitude of what acts on the body [m/s]
	std::vector<ResidualSum> sums; // one for every island in every block, in the order of the sweep
	std::vector<int32_t> islandAt; // the island of each of these sums
	std::vector<int32_t> sumOfContact; // the sum that each contact,
	std::vector<int32_t> sumOfBody; // and each packed body adds to; -1: the body cannot move
	std::vector<ResidualSum> islands;
	std::vector<Run> runs;
	std::vector<std::pair<int32_t, int32_t>> heavyOnLight; // packed bodies that touch; the second is ten times heavier
	std::vector<double> leastHeavy; // of each packed body: smallest s of the far heavier bodies that it carries [m/s]
	std::vector<int32_t> underHeavy; // lanes of contacts of bodies that carry a far heavier one
	std::vector<GroupMiss> misses; // empty if all runs have one sum and no body carries a far heavier one
	std::vector<Ranges> ofBlock;
	std::vector<std::pair<int32_t, int32_t>> sumOfIsland; // of each island: block in which it was last met, and its sum there
};

} // namespace cd
