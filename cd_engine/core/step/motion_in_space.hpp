// Where the bodies are in a step in space: motion.hpp says what the members do.
#pragma once

#include "step/motion.hpp"

namespace cd {

double smallestRadius(const WorldOf<Space3>&);

template <> class BodyMotion<Space3> {
    public:
	struct Start {
		bool turns = false; // a boundary turns
		bool sameMasses = true;
		bool guides = false; // there is a sphere that no force moves
	};
	Start begin(const WorldOf<Space3>&, double dt, ContactSystem<Space3>&, Threads&);
	static void resetFree(const WorldOf<Space3>&, double dt, ContactSystem<Space3>&, Threads&);
	bool average(const WorldOf<Space3>&, double dt, const std::vector<BodyVelocity<Space3>>&, bool solved, Threads&);
	std::vector<double> reaches(const WorldOf<Space3>&, double dt) const;
	void shift(int32_t sphere, const Vector3&);
	std::size_t shifted() const { return shifts.size(); }
	static double damped(const WorldOf<Space3>&, const std::vector<BodyVelocity<Space3>>&, Threads&);
	bool finish(WorldOf<Space3>&, double dt, const std::vector<BodyVelocity<Space3>>&, Threads&) const;
	void placeBack(const WorldOf<Space3>&, double dt);

	const std::vector<SpacePlace>& places() const { return placeOf; }
	// Of the boundaries, as they stand there.
	const std::vector<SpaceShape>& shapes() const { return *shapeOf; }
	bool anyTurns() const { return shapeOf == &turned; }
	const std::vector<SpaceMean>& means() const { return meanOf; }
	double ways(const Pair& pair) const { return way[pair.a] + way[pair.b]; }
	double fastest() const { return largestSpeed; }

    private:
	double reach(const WorldOf<Space3>&, std::size_t body, double dt) const;
	void standShapes(const WorldOf<Space3>&, double ahead);

	struct Shift {
		int32_t sphere;
		Vector3 by; // [m]
	};
	std::vector<SpacePlace> placeOf;
	std::vector<SpaceShape> turned; // if any turns
	const std::vector<SpaceShape>* shapeOf = nullptr; // those of the world, or `turned`
	std::vector<SpaceMean> meanOf;
	std::vector<double> way;
	std::vector<Shift> shifts;
	double largestSpeed = 0;
};

} // namespace cd
