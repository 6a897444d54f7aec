// Gauss-Seidel sweeps over packed contacts, in the velocities of the bodies: the inner loop that all sweeping solvers share.
#pragma once

#include "sweeps/sweep_error.hpp"

namespace cd {

// What a method needs, for a problem given by its bodies. DelassusSweep has the same functions for a problem given by its matrix.
template <class Space> class Sweep {
	using ContactSystem = cd::ContactSystem<Space>;
	using PackedBody = PackedBodyIn<Space>;
	using PackedProblem = cd::PackedProblem<Space>;

    public:
	using System = ContactSystem;
	using Iterate = SweptImpulses<Space>; // the impulses of an iterate, saved to restore it later

	// Packs the contacts and applies the impulses of the first guess to the bodies. seed > 0: each sweep visits the groups of contacts in a new
	// random order. threads: share the work; the bits do not depend on them.
	Sweep(ContactSystem& system, unsigned seed, Threads* threads = nullptr);

	// Solves every contact once, exactly, while the others are held. About 104 bytes and 45 operations a contact.
	void operator()();
	// The same from y = p + beta (p - q), with q the impulses before the last such sweep (at the first one q = p).
	AheadReport ahead(double beta);

	// Recomputes the velocities from the impulses. This removes the round-off that updates in place leave behind.
	void restoreVelocities();
	// Copies impulses and velocities back to the system. To be called once.
	void store() { problem.store(system, threads); }
	// The error of the packed impulses: that of residual(), except for the order of its sums.
	Residual error() { return packed.error(system, problem, threads); }

	// The smallest share of a contact's own stiffness in its block of W + C, C_n/(W_nn + C_n); 0 where contacts are rigid.
	double yield() const;

	void copyTo(Iterate&) const;
	void copyFrom(const Iterate&);

	const Blocks& blocks() const { return problem.blocks; }
	Workspace* memory() const { return system.memory; }

    private:
	// Results of a sweep with momentum in a block.
	struct alignas(128) AheadSums {
		LaneSums groups;
		AheadReport loose;
	};
	// The next Sweep with the same memory finds it.
	struct Packed {
		PackedProblem problem;
		SweepError<Space> error;
		std::vector<PackedBody> bodiesBefore; // one sweep ago,
		Iterate before; // and the impulses
		std::vector<AheadSums> sums; // of each block
	};
	template <class Work> void inOrder(const Work&);

	ContactSystem& system;
	Borrowed<Packed> kept;
	Packed& packed;
	PackedProblem& problem;
	bool remembered = false; // whether `bodiesBefore` and `before` are set
	RandomOrder order;
	Threads* const threads;
};

} // namespace cd
