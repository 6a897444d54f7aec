// When the engine warns in a step: once a run, and twice of overlaps. What it says is written in cd_engine/step_texts.py.
#include "../bindings/python.hpp"
#include "contact_dynamics.hpp"

#include <algorithm>
#include <iostream>
#include <utility>

namespace cd_engine {
namespace {

	// Share of the smallest radius from which an overlap is no longer just an error of a time step.
	constexpr double deep = 0.01, veryDeep = 0.25;
	constexpr double far = 4; // motion of two disks relative to each other in a step, in mean radii: from there on the user is warned
	constexpr double shortStep = 1e-3; // over the time in which a disk moves or falls by its radius: below it O.dt is one for springs

	cd::Vector velocity(const cd::Body& b) { return { b.v[0], b.v[1] }; }
	cd::Vector3 velocity(const cd::SpaceBody& b) { return velocityOf(b); }
	double acceleration(const cd::Body& b) { return std::hypot(b.force[0] * b.inverseMass[0], b.force[1] * b.inverseMass[1]); }
	double acceleration(const cd::SpaceBody& b)
	{
		return length(cd::Vector3 { b.force[0] * b.inverseMass[0], b.force[1] * b.inverseMass[1], b.force[2] * b.inverseMass[2] });
	}
	// What the rotation of a body adds to its velocity at this arm.
	cd::Vector turning(const cd::Body& b, cd::Vector arm) { return { -b.v[2] * arm.y, b.v[2] * arm.x }; }
	cd::Vector3 turning(const cd::SpaceBody& b, const cd::Vector3& arm) { return cross(spinOf(b), arm); }

} // namespace

// Facts that this function of step_texts.py puts into words, with those that the attributes tell.
template <class... Facts> std::string ContactDynamics::words(const char* function, const Facts&... facts)
{
	const WithInterpreterLock locked;
	return py::extract<std::string>(py::import("cd_engine.step_texts").attr(function)(py::ptr(this), scene_iter(scene), facts...));
}

template <class Space> void ContactDynamics::warnBeforeStep(double dt)
{
	SceneLink<Space>& link = course<Space>().link;
	warnOfLostBody<Space>();
	warnOfSpeed<Space>(dt);
	if (steps == 0)
		warnOfShortStep<Space>(dt);
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
	std::cerr << words("unsolved") << " Further such steps are counted in unconvergedSteps.\n";
}

// Prints one line a run, for the first body that leaves the scene.
template <class Space> void ContactDynamics::warnOfLostBody()
{
	SceneLink<Space>& link = course<Space>().link;
	const int id = warnedOfLost ? -1 : link.lost();
	if (id < 0)
		return;
	warnedOfLost = true;
	const cd::BodyOf<Space>& body = link.world.bodies[id];
	std::cerr << words("lost", id, link.placeOf(body), length(velocity(body))) << '\n';
}

// Prints one line a run if two bodies approach so fast that one may jump over the other: by more than the sum of their radii in half a step.
template <class Space> void ContactDynamics::warnOfSpeed(double dt)
{
	const SceneLink<Space>& link = course<Space>().link;
	if (warnedOfSpeed || !(2 * link.pairSearch().longestWay() > far))
		return;
	const auto& bodies = link.world.bodies;
	for (const cd::Pair& pair : link.world.pairs) {
		const auto speed = [&](int i) { return isBoundary(bodies[i]) ? -1 : length(velocity(bodies[i])); };
		const int fast = speed(pair.a) >= speed(pair.b) ? pair.a : pair.b, other = pair.a + pair.b - fast; // fast is a disk
		const cd::BodyOf<Space>&a = bodies[fast], &b = bodies[other];
		// The way of the disk in a step relative to what the other body does at its place; 0 for two disks that part.
		const auto from = centreOf(a) - centreOf(b), u = velocity(a) - velocity(b) - (isBoundary(b) ? turning(b, from) : 0. * from);
		const double way = !isBoundary(b) && dot(from, u) >= 0 ? 0 : dt * length(u);
		if (!(way > far * (isBoundary(b) ? a.radius : (a.radius + b.radius) / 2)))
			continue;
		warnedOfSpeed = true;
		std::cerr << words("fast", fast, other, way / a.radius, dt) << '\n';
		return;
	}
}

// Says at the first step if O.dt is one for springs. Where no force acts on the disks they may move as slowly as they like.
template <class Space> void ContactDynamics::warnOfShortStep(double dt)
{
	SceneLink<Space>& link = course<Space>().link;
	double pull = 0; // largest acceleration of a disk
	for (const cd::BodyOf<Space>& b : link.world.bodies)
		if (!isBoundary(b))
			pull = std::max(pull, acceleration(b));
	if (pull == 0 || dt == 1e-8) // which has a message of its own
		return;
	const double needed = std::min(1 / link.pairSearch().longestWay(), std::sqrt(cd::smallestRadius(link.world) / pull) / dt);
	if (shortStep * needed > 1)
		link.warnOnce(text("O.dt is ", dt, " s: a disk needs at least ", needed, " steps to fall or move by its radius."),
		    text(link.world.compliant() ? "Explicit springs need such short steps; contacts with a stiffness in ContactDynamics do not"
						: "Springs need such short steps; rigid contacts do not",
			", unless something will be much faster. cd_engine.timeStep() proposes O.dt."));
}

// Prints a line where disks have sunk into each other by a hundredth of a radius, and again by a quarter. before: the deepest of all earlier steps.
// A step without a solution, or in which a boundary is moved by its position, has its own warning, and counts for no later one.
template <class Space> void ContactDynamics::warnOfPenetration(double before, bool takesOver)
{
	auto& [link, step] = course<Space>();
	if (toldPenetration < 0)
		toldPenetration = before; // a loaded scene goes on
	if (!(maxPenetration > toldPenetration) || !unsolvableContact.empty() || link.boundariesPlaced())
		return;
	before = std::exchange(toldPenetration, maxPenetration);
	const double smallest = cd::smallestRadius(link.world), longest = link.pairSearch().longestWay();
	const auto passes = [&](double share) { return before <= share * smallest && maxPenetration > share * smallest; };
	if (!(passes(deep) && !link.world.compliant()) && !passes(veryDeep))
		return;
	const cd::Pair& deepest = link.deepest(step);
	// Two bodies can approach each other in the step. One that has come with it overlaps because it was put there; if the scene has just been
	// taken over, all have come, and only what they have approached since counts as overlap.
	const bool came = !takesOver && (link.cameIn(scene_iter(scene), deepest.a) || link.cameIn(scene_iter(scene), deepest.b));
	std::cerr << words("penetration", deepest.a, deepest.b, link.behindWall(deepest), maxPenetration - before, came ? 0 : 2 * longest * smallest,
	    smallest, longest, scene_dt(scene))
		  << '\n';
}

template void ContactDynamics::warnBeforeStep<cd::Plane>(double);
template void ContactDynamics::warnBeforeStep<cd::Space3>(double);
template void ContactDynamics::warnOfPenetration<cd::Plane>(double, bool);
template void ContactDynamics::warnOfPenetration<cd::Space3>(double, bool);

} // namespace cd_engine
