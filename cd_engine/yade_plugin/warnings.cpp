// What the engine tells the user of a step, once a run.
#include "contact_dynamics.hpp"
#include "waiting.hpp"

#include <algorithm>
#include <iostream>

namespace cd_engine {
namespace {

	// Share of the smallest radius from which an overlap is no longer just an error of a time step.
	constexpr double deep = 0.01;
	constexpr double loose = 1e-3; // tolerance above which pushing out the overlaps that it leaves would stir a packing
	constexpr double far = 4; // radii that a disk may move in a step without a warning
	constexpr double shortStep = 1e-3; // over the time in which a disk moves or falls by its radius: below it O.dt is one for springs

} // namespace

// Describes why a step is not solved, and what to do.
std::string ContactDynamics::unsolved() const
{
	const std::string begin
	    = text("ContactDynamics: step ", scene_iter(scene), " is not solved (", status, " after ", iterations, " iterations): ");
	if (!unsolvableContact.empty())
		return text(begin, "no velocities keep bodies #", unsolvableContact[0], " and #", unsolvableContact[1],
		    " from overlapping. Look for boundaries that move towards each other with disks between them; one that is to press with a force "
		    "needs a mass, free directions and O.forces.setPermF instead of a velocity. Do not trust the steps that follow.");
	return text(begin, "the error of the contact law is ", residual, ", relative to all impulses",
	    worstBody < 0 ? ""
			  : text(", and the velocity change of body #", worstBody, " may be wrong by ", bodyError, ", relative to what acts on it"),
	    "; the tolerance is ", tolerance, ". ",
	    status == "stagnated" ? "More iterations do not help: raise tolerance" : "Raise maxIterations or tolerance", ", or take a smaller O.dt.");
}

// Prints one line a run. unconvergedSteps counts on and is shown once more when YADE ends (cd_engine/__init__.py).
void ContactDynamics::warn()
{
	if (stopUnsolved) {
		if (link.ahead())
			link.publish(scene, step);
		// Not thrown here: the other engines and the clock have to make this step, too.
		const std::string error = unsolved() + " (stopUnsolved is set; the step has been made)";
		stopAfter(scene_iter(scene) + 1, scene_stopAtIter(scene), error);
		others.wake();
		toldOfUnsolvable = !unsolvableContact.empty();
		if (waiting == 0)
			std::cerr << error << '\n';
		return;
	}
	if (warned)
		return;
	warned = true;
	toldOfUnsolvable = !unsolvableContact.empty();
	std::cerr << unsolved() << " Further such steps are counted in unconvergedSteps.\n";
}

// Prints one line a run, for the first body that leaves the scene.
void ContactDynamics::tellOfLost()
{
	const int id = toldOfLost ? -1 : link.lost();
	if (id < 0)
		return;
	toldOfLost = true;
	const cd::Body& body = link.world.bodies[id];
	std::cerr << "ContactDynamics: step " << scene_iter(scene) << ": body #" << id << " has left the scene: it is at (" << body.x << ", "
		  << body.y << ") m, at " << std::hypot(body.v[0], body.v[1]) << " m/s. Erase it (O.bodies.erase(" << id
		  << ")) or give the scene a boundary that holds it. Further bodies that leave are not reported.\n";
}

// Prints one line a run if a disk moves so far in a step, relative to a neighbour, that it may jump over it.
void ContactDynamics::tellOfSpeed(double dt)
{
	if (toldOfSpeed || !(link.pairSearch().longestWay() > far))
		return;
	const auto& bodies = link.world.bodies;
	const auto wayOf = [&](const cd::Body& b) { return dt * std::hypot(b.v[0], b.v[1]); };
	const auto tooFar = [&](const cd::Body& b) { return b.radius > 0 && wayOf(b) > far * b.radius; };
	const auto meets = [&](const cd::Pair& pair) {
		const cd::Body &a = bodies[pair.a], &b = bodies[pair.b];
		const double relative = dt * std::hypot(a.v[0] - b.v[0], a.v[1] - b.v[1]);
		return (tooFar(a) && relative > far * a.radius) || (tooFar(b) && relative > far * b.radius);
	};
	const auto near = std::find_if(link.world.pairs.begin(), link.world.pairs.end(), meets);
	if (near == link.world.pairs.end())
		return;
	const auto fast = bodies.begin() + (tooFar(bodies[near->a]) ? near->a : near->b);
	toldOfSpeed = true;
	std::cerr
	    << "ContactDynamics: step " << scene_iter(scene) << ": body #" << fast - bodies.begin() << " moves " << wayOf(*fast) / fast->radius
	    << " times its radius in a step and may jump over others. O.dt is " << dt
	    << " s: take a smaller one. cd_engine.timeStep() proposes one by sizes, speeds and gravity; it does not know other forces, which may "
	       "grow without bound, such as a strong drag. Further such bodies are not reported.\n";
}

// Says at the first step if O.dt is YADE's default or one for springs.
void ContactDynamics::tellOfShortStep(double dt, const Vector3r& weighs)
{
	const double g = weighs.norm(); // without gravity a sample may deform as slowly as it likes
	const double longest
	    = g > 0 ? std::min(1 / link.pairSearch().longestWay(), std::sqrt(cd::smallestRadius(link.world) / g) / dt) : 0; // in steps
	const std::string remedy
	    = "Rigid contacts have no stiffness that asks for such short steps: cd_engine.timeStep() proposes O.dt, often 1e-3 s.";
	if (dt == 1e-8)
		link.tell("O.dt is 1e-8 s, the value that YADE starts with.", remedy);
	else if (longest < cd::endless && shortStep * longest > 1)
		link.tell(text("O.dt is ", dt, " s: a disk needs at least ", longest, " steps to fall or move by its radius."), remedy);
}

// Prints one line a run if disks sink into each other. Reasons: e, relative to all impulses, is small long before a heavy body on a light one is
// carried; fixedIterations demand no error; small errors add up; and a step may be too long for the speed or rotation of the bodies.
void ContactDynamics::watchPenetration(double before) const
{
	const double smallest = cd::smallestRadius(link.world);
	if (deepestPenetration <= deep * smallest || before > deep * smallest || toldOfUnsolvable || link.boundariesPlaced())
		return; // an unsolvable step, or a boundary that is moved by its position, has its own warning
	const cd::Pair& deepest = link.deepest(step);
	std::string remedy;
	const bool atOnce = maxPenetration - before > 0.5 * deep * smallest, misses = !converged || fixedIterations > 0;
	// That two bodies can approach each other in the step; one that has come with it approaches none.
	const double way = link.cameIn(scene_iter(scene), deepest.a) || link.cameIn(scene_iter(scene), deepest.b)
	    ? 0
	    : 2 * link.pairSearch().longestWay() * smallest;
	if (const std::string behind = link.behindWall(deepest); atOnce && maxPenetration - before > way && !behind.empty())
		remedy = "No speed explains it: " + behind;
	else if (atOnce && maxPenetration - before > way)
		remedy = std::string("No speed explains it: bodies were put there, moved, turned or resized, or have overlapped from the start "
				     "(handover=False). Move them apart")
		    + (gapCorrection == 0 && maxPenetration < smallest ? ", or set gapCorrection=0.1, which pushes overlaps out" : "");
	else if (restitution > 0 && (atOnce || !misses))
		remedy = "A contact that impulses of other contacts close rebounds only in the next step, and until then it overlaps by up to its "
			 "closing speed times O.dt. Take a smaller O.dt";
	else if (atOnce && misses)
		remedy = "It came in this one step, which is not solved, or too long for the speed of the bodies: take a smaller O.dt "
			 "(cd_engine.timeStep() proposes one), or raise maxIterations or fixedIterations";
	else if (atOnce)
		remedy = "It came in this one step, which is too long for the speed of the bodies: take a smaller O.dt (cd_engine.timeStep() "
			 "proposes one)";
	else if (misses)
		remedy = "The forces that hold them apart are too small: raise maxIterations or fixedIterations";
	else if (tolerance > loose)
		remedy = "It grew step by step, since solver errors within the tolerance add up: lower tolerance to 1e-4 or less";
	else if (gapCorrection == 0)
		remedy = "It grew step by step, since solver errors within the tolerance add up, a boundary changes its velocity, or disks grow: set "
			 "gapCorrection=0.1, which removes overlaps, or lower tolerance";
	else
		remedy = "It grew step by step by more than gapCorrection pushes out: take a smaller O.dt, or lower tolerance";
	std::cerr << "ContactDynamics: step " << scene_iter(scene) << ": bodies #" << deepest.a << " and #" << deepest.b << " overlap by "
		  << maxPenetration << " m, " << maxPenetration / smallest
		  << " of the smallest radius, more than when Contact Dynamics took the scene over. " << remedy
		  << ". The attribute deepestPenetration gives the largest overlap of all steps.\n";
}

} // namespace cd_engine
