// Gauss-Seidel sweeps over the rows of W: what sweep.hpp does in the velocities of disks, for any bodies.
#pragma once

#include "delassus_system.hpp"
#include "random_order.hpp"
#include "residual.hpp"

namespace cd {

class DelassusSweep {
    public:
	using System = DelassusSystem;

	DelassusSweep(DelassusSystem& s, unsigned seed)
	    : system(s)
	    , order(seed)
	{
	}

	// Solves every contact once, exactly, the others held. A block of W is 36 bytes and 8 operations; disks in a dense packing have seven a
	// contact.
	void operator()();

	// The impulses stay in the system all the time, and no velocity is kept: each is the product of a row with the impulses, made when needed.
	void storeImpulses() { }
	void restoreVelocities() { }
	Residual error() const { return residual(system); }

	template <class F> void forEachImpulse(F&& f)
	{
		for (std::size_t i = 0; i < system.contacts(); i++)
			f(system.p[2 * i], system.p[2 * i + 1], i);
	}
	std::size_t size() const { return system.contacts(); }
	template <class F> void forEachVelocity(F&&) { }
	std::size_t velocities() const { return 0; }

    private:
	void solve(std::size_t contact);

	DelassusSystem& system;
	RandomOrder order;
};

} // namespace cd
