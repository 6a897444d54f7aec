// Where the bodies are in a step, and how far they move in it.
#pragma once

#include "base/base.hpp"
#include "problem/problem.hpp"
#include "scene/scene.hpp"

namespace cd {

// The smallest radius of the disks or spheres [m]; infinite if there is none.
template <class Space> double smallestRadius(const WorldOf<Space>& world)
{
	double smallest = endless;
	for (const BodyOf<Space>& b : world.bodies)
		smallest = isBoundary(b) ? smallest : std::min(smallest, b.radius);
	return smallest;
}

// The shapes of boundaries, as they stand where contact is looked for. In the plane `Place` knows how far they have turned.
template <class Space> class StandingShapes {
    protected:
	void stand(const WorldOf<Space>&, double, bool, const uint8_t*) { }
};

template <> class StandingShapes<Space3> {
    public:
	const std::vector<SpaceShape>& shapes() const { return *shapeOf; }
	bool anyTurns() const { return shapeOf == &turned; }

    protected:
	// `any`: whether a boundary turns. ahead: how far ahead of the bodies' places [s]. still: World::stillSince.
	void stand(const WorldOf<Space3>&, double ahead, bool any, const uint8_t* still);

    private:
	std::vector<SpaceShape> turned; // if any turns
	bool filled = false; // whether `turned` holds what is still
	const std::vector<SpaceShape>* shapeOf = nullptr; // those of the world, or `turned`
};

template <class Space> class BodyMotion : public StandingShapes<Space> {
    public:
	using World = WorldOf<Space>;
	using Velocities = std::vector<BodyVelocityIn<Space>>; // of the bodies, and of what the system has beside them
	struct Start {
		bool turns = false; // a boundary turns
		bool sameMasses = true; // the inverse masses are those of the last step
		bool guides = false; // there is a disk or sphere that no force moves
	};
	// Sets the free velocities of the system's bodies, which the external forces alone would leave, and finds their places at the
	// mid-configuration (with stiffnesses: before the step) and their ways.
	Start begin(const World&, double dt, ContactSystem<Space>&, Threads&);
	// Sets the free velocities again, after a solution has replaced them.
	// A belt turns at 1 rad/s there: the lever arms of its contacts are the speeds of its surface (ProblemBuilder).
	static void resetFree(const World&, double dt, ContactSystem<Space>&, Threads&);

	// Finds the means of the velocities before the step and those that a solution has left. Those of an unsolved step may have any size: their
	// speeds are limited to four times the longest way plus two smallest radii, a step. Returns whether a body has become so fast that it may
	// reach, within the step, another body that is not listed with it.
	bool average(const World&, double dt, const Velocities&, bool solved, Threads&);
	// How far from its place before the step pairs of each body must be listed, so that it reaches no other within the step [m].
	std::vector<double> reaches(const World&, double dt) const;

	// Takes a disk or sphere back [m], at the mid-configuration and for good.
	void shift(int32_t body, const VectorOf<Space>&);
	std::size_t shifted() const { return shifts.size(); }

	// The kinetic energy that a step by backward Euler takes, sum m |v' - v|^2/2 [J]; before the bodies are moved.
	static double damped(const World&, const Velocities&, Threads&);
	// Moves the bodies to the end of the step. Returns whether any body moves.
	bool finish(World&, double dt, const Velocities&, Threads&);
	// Finds the places of the last step of dt anew, from the bodies after it.
	void placeBack(const World&, double dt);

	const std::vector<PlaceOf<Space>>& places() const { return placeOf; } // of the bodies at the mid-configuration
	const std::vector<typename Space::Mean>& means() const { return meanOf; } // of the bodies
	// How far two bodies together may move in the step without impulses; if one turns, its farthest point [m].
	double ways(const Pair& pair) const { return way[pair.a] + way[pair.b]; }
	double fastest() const { return largestSpeed; } // speed of a body after the step [m/s]

    private:
	double reach(const World&, std::size_t body, double dt) const;

	struct Shift {
		int32_t body;
		VectorOf<Space> by; // [m]
	};
	std::vector<PlaceOf<Space>> placeOf;
	std::vector<typename Space::Mean> meanOf;
	std::vector<double> way;
	std::vector<Shift> shifts; // of those that were stopped at a face
	double largestSpeed = 0;
	long seen = 0; // World::reading of the last step that was made
};

} // namespace cd
