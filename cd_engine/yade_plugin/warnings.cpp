// When the engine warns in a step: once a run, and twice of overlaps. What it says is written in cd_engine/step_texts.py.
#include "../bindings/python.hpp"
#include "contact_dynamics.hpp"

#include <algorithm>
#include <iostream>

namespace cd_engine {
namespace {

	// Share of the smallest radius from which an overlap is no longer just an error of a time step.
	constexpr double deep = 0.01, veryDeep = 0.25;
	constexpr double far = 4; // motion of two disks relative to each other in a step, in mean radii: from there on the user is warned
	constexpr double shortStep = 1e-3; // over the time in which a disk moves or falls by its radius: below it O.dt is one for springs

} // namespace

// Facts that this function of step_texts.py puts into words, with those that the attributes tell.
template <class... Facts> std::string ContactDynamics::words(const char* function, const Facts&... facts)
{
	const WithInterpreterLock locked;
	return py::extract<std::string>(py::import("cd_engine.step_texts").attr(function)(py::ptr(this), scene_iter(scene), facts...));
}

void ContactDynamics::warnBeforeStep(double dt)
{
	warnOfLostBody();
	warnOfSpeed(dt);
	if (steps == 0)
		warnOfShortStep(dt);
	if ((restitution > 0 || en.given()) && gapCorrection > 0 && gapVelocity)
		link.warnOnce("restitution and gapCorrection with gapVelocity create energy: the velocity that removes an overlap takes part in "
			      "later rebounds.",
		    "Set gapVelocity=False. A smaller O.dt reduces overlaps.");
	if (const std::string& late = others.lateDriver(); !late.empty())
		link.warnOnce(late + " stands after ContactDynamics in O.engines, so the motion that it sets comes a step late.",
		    "Put it between ForceResetter and ContactDynamics.");
	if (others.deadIntegrator())
		link.warnOnce(
		    "a NewtonIntegrator stands dead in O.engines: utils.unbalancedForce() adds its gravity to forces that contain the weights.",
		    "Remove it.");
}

// Prints one line a run. unconvergedSteps counts on and is shown once more when YADE ends (cd_engine/__init__.py).
void ContactDynamics::warnOfUnsolved()
{
	if (std::exchange(warnedOfUnsolved, true))
		return;
	warnedOfUnsolvable = !unsolvableContact.empty();
	std::cerr << words("unsolved") << " Further such steps are counted in unconvergedSteps.\n";
}

// Prints one line a run, for the first body that leaves the scene.
void ContactDynamics::warnOfLostBody()
{
	const int id = warnedOfLost ? -1 : link.lost();
	if (id < 0)
		return;
	warnedOfLost = true;
	const cd::Body& body = link.world.bodies[id];
	std::cerr << words("lost", id, link.placeOf(body), std::hypot(body.v[0], body.v[1])) << '\n';
}

// Prints one line a run if two bodies approach so fast that one may jump over the other: by more than the sum of their radii in half a step.
void ContactDynamics::warnOfSpeed(double dt)
{
	if (warnedOfSpeed || !(2 * link.pairSearch().longestWay() > far))
		return;
	const auto& bodies = link.world.bodies;
	for (const cd::Pair& pair : link.world.pairs) {
		const auto speed = [&](int i) { return isBoundary(bodies[i]) ? -1 : std::hypot(bodies[i].v[0], bodies[i].v[1]); };
		const int fast = speed(pair.a) >= speed(pair.b) ? pair.a : pair.b, other = pair.a + pair.b - fast; // fast is a disk
		const cd::Body &a = bodies[fast], &b = bodies[other];
		// The way of the disk in a step relative to what the other body does at its place; 0 for two disks that part.
		const double x = a.x - b.x, y = a.y - b.y, turning = isBoundary(b) ? b.v[2] : 0;
		const double u = a.v[0] - b.v[0] + turning * y, v = a.v[1] - b.v[1] - turning * x;
		const double way = !isBoundary(b) && x * u + y * v >= 0 ? 0 : dt * std::hypot(u, v);
		if (!(way > far * (isBoundary(b) ? a.radius : (a.radius + b.radius) / 2)))
			continue;
		warnedOfSpeed = true;
		std::cerr << words("fast", fast, other, way / a.radius, dt) << '\n';
		return;
	}
}

// Says at the first step if O.dt is one for springs. Where no force acts on the disks they may move as slowly as they like.
void ContactDynamics::warnOfShortStep(double dt)
{
	double pull = 0; // largest acceleration of a disk
	for (const cd::Body& b : link.world.bodies)
		if (!isBoundary(b))
			pull = std::max(pull, std::hypot(b.force[0] * b.inverseMass[0], b.force[1] * b.inverseMass[1]));
	if (pull == 0 || dt == 1e-8) // which has a message of its own
		return;
	const double needed = std::min(1 / link.pairSearch().longestWay(), std::sqrt(cd::smallestRadius(link.world) / pull) / dt);
	if (shortStep * needed > 1)
		link.warnOnce(text("O.dt is ", dt, " s: a disk needs at least ", needed, " steps to fall or move by its radius."),
		    "Springs need such short steps; rigid contacts do not, unless something will be much faster. cd_engine.timeStep() proposes "
		    "O.dt.");
}

// Prints a line where disks have sunk into each other by a hundredth of a radius, and again by a quarter. before: the deepest of all earlier steps.
void ContactDynamics::warnOfPenetration(double before, bool takesOver)
{
	const double smallest = cd::smallestRadius(link.world), longest = link.pairSearch().longestWay();
	const auto passes = [&](double share) { return before <= share * smallest && deepestPenetration > share * smallest; };
	if (!(passes(deep) || passes(veryDeep)) || warnedOfUnsolvable || link.boundariesPlaced())
		return; // an unsolvable step, or a boundary that is moved by its position, has its own warning
	const cd::Pair& deepest = link.deepest(step);
	// Two bodies can approach each other in the step. One that has come with it overlaps because it was put there; if the scene has just been
	// taken over, all have come, and only what they have approached since counts as overlap.
	const bool came = !takesOver && (link.cameIn(scene_iter(scene), deepest.a) || link.cameIn(scene_iter(scene), deepest.b));
	std::cerr << words("penetration", deepest.a, deepest.b, link.behindWall(deepest), maxPenetration - before, came ? 0 : 2 * longest * smallest,
	    smallest, longest, scene_dt(scene))
		  << '\n';
}

} // namespace cd_engine
