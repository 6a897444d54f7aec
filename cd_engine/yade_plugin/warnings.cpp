// What the engine warns of in a step: once a run, and twice of overlaps.
#include "contact_dynamics.hpp"
#include "waiting.hpp"

#include <algorithm>
#include <iomanip>
#include <iostream>

namespace cd_engine {
namespace {

	// Share of the smallest radius from which an overlap is no longer just an error of a time step.
	constexpr double deep = 0.01, veryDeep = 0.25;
	constexpr double loose = 1e-3; // tolerance above which pushing out the overlaps that it leaves would stir a packing
	constexpr double far = 4; // motion of two disks relative to each other in a step, in mean radii: from there on the user is warned
	constexpr double shortStep = 1e-3; // over the time in which a disk moves or falls by its radius: below it O.dt is one for springs

} // namespace

// Describes why a step is not solved, and what to do.
std::string ContactDynamics::unsolved() const
{
	const std::string begin
	    = text("ContactDynamics: step ", scene_iter(scene), " is not solved (", status, " after ", iterations, " iterations): ");
	const bool proven = status == cd::name(cd::Status::no_solution) || status == cd::name(cd::Status::indefinite);
	if (!unsolvableContact.empty() && proven)
		return text(begin, "bodies #", unsolvableContact[0], " and #", unsolvableContact[1],
		    " are squeezed or wedged, and no solution was found. Look for boundaries that move towards each other with disks between "
		    "them; one that is to press with a force needs a mass, free directions and O.forces.setPermF instead of a velocity. With "
		    "friction there may still be a solution, which another method or seed may find. Do not trust the steps that follow.");
	const std::string doubt = unsolvableContact.empty() ? ""
							    : text(" It may have no solution; the strongest sign of this is the contact of bodies #",
								unsolvableContact[0], " and #", unsolvableContact[1], ".");
	if (residual <= stepTolerance && bodyError <= stepTolerance)
		return text(begin, "the error of the contact law, relative to all impulses, and that of the bodies are within the tolerance of ",
		    stepTolerance, ", but ",
		    doubt.empty() ? "the error of the contact law weighted by W_nn is larger." : "contacts that carry load still close.", doubt,
		    " Take a smaller O.dt.");
	return text(begin, "the error of the contact law is ", residual, ", relative to all impulses",
	    worstBody < 0 ? ""
			  : text(", and the velocity change of body #", worstBody, " may be wrong by ", bodyError, ", relative to what acts on it"),
	    "; the tolerance is ", stepTolerance, ". ",
	    status == "stagnated" ? "More iterations do not help: set a larger tolerance" : "Raise maxIterations or set a larger tolerance",
	    ", or take a smaller O.dt.", doubt);
}

void ContactDynamics::warnBeforeStep(double dt)
{
	warnOfLostBody();
	warnOfSpeed(dt);
	if (steps == 0)
		warnOfShortStep(dt);
	if (restitution > 0 && gapCorrection > 0)
		link.warnOnce(
		    "restitution and gapCorrection together create energy: the velocity that removes an overlap takes part in later rebounds.",
		    "Set one of them to 0. A smaller O.dt reduces overlaps.");
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
	if (warnedOfUnsolved && !stopUnsolved)
		return;
	warnedOfUnsolvable = !unsolvableContact.empty();
	if (!stopUnsolved) {
		warnedOfUnsolved = true;
		std::cerr << unsolved() << " Further such steps are counted in unconvergedSteps.\n";
		return;
	}
	if (link.isUnpublished())
		link.publish(scene, step);
	// Not thrown here: the other engines and the clock have to make this step, too.
	const std::string error = unsolved() + " (stopUnsolved is set; the step has been made)";
	stopAfter(scene_iter(scene) + 1, scene_stopAtIter(scene), error);
	others.wake();
	if (waiting == 0)
		std::cerr << error << '\n';
}

// Prints one line a run, for the first body that leaves the scene.
void ContactDynamics::warnOfLostBody()
{
	const int id = warnedOfLost ? -1 : link.lost();
	if (id < 0)
		return;
	warnedOfLost = true;
	const cd::Body& body = link.world.bodies[id];
	std::cerr << "ContactDynamics: step " << scene_iter(scene) << ": body #" << id << " has left the scene: it is at " << link.placeOf(body)
		  << ", at " << std::hypot(body.v[0], body.v[1]) << " m/s. Erase it (O.bodies.erase(" << id
		  << ")) or give the scene a boundary that holds it. Further bodies that leave are not reported.\n";
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
		std::cerr << "ContactDynamics: step " << scene_iter(scene) << ": body #" << fast << " moves " << way / a.radius
			  << " times its radius in a step relative to body #" << other << " and may jump over it. O.dt is " << dt
			  << " s: take a smaller one. cd_engine.timeStep() proposes one by sizes, speeds, gravity and permanent forces; it does not "
			     "know others, which may grow without bound, such as a strong drag. Further such bodies are not reported.\n";
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
void ContactDynamics::warnOfPenetration(double before, bool takesOver) const
{
	const double smallest = cd::smallestRadius(link.world);
	const auto passes = [&](double share) { return before <= share * smallest && deepestPenetration > share * smallest; };
	if (!(passes(deep) || passes(veryDeep)) || warnedOfUnsolvable || link.boundariesPlaced())
		return; // an unsolvable step, or a boundary that is moved by its position, has its own warning
	const cd::Pair& deepest = link.deepest(step);
	std::cerr << "ContactDynamics: step " << scene_iter(scene) << ": bodies #" << deepest.a << " and #" << deepest.b << " overlap by "
		  << maxPenetration << " m, " << maxPenetration / smallest
		  << " of the smallest radius, beyond what was there when Contact Dynamics began. "
		  << remedyForPenetration(deepest, maxPenetration - before, smallest, takesOver)
		  << ". The attribute deepestPenetration gives the largest overlap of all steps.\n";
}

// Reasons: e, relative to all impulses, is small long before a heavy body on a light one is carried; fixedIterations demand no error; small errors
// add up; and a step may be too long for the speed or rotation of the bodies. grown: in this step [m].
std::string ContactDynamics::remedyForPenetration(const cd::Pair& deepest, double grown, double smallest, bool takesOver) const
{
	const bool atOnce = grown > 0.5 * deep * smallest, misses = !converged || fixedIterations > 0;
	const double longest = link.pairSearch().longestWay();
	// That two bodies can approach each other in the step. One that has come with it overlaps because it was put there; if the scene has just
	// been taken over, all have come, and only what they have approached since counts as overlap.
	const bool came = !takesOver && (link.cameIn(scene_iter(scene), deepest.a) || link.cameIn(scene_iter(scene), deepest.b));
	if (atOnce && grown > (came ? 0 : 2 * longest * smallest)) {
		const std::string behind = link.behindWall(deepest);
		return "No speed explains it: "
		    + (!behind.empty()
			    ? behind
			    : std::string("bodies were put there, moved, turned or resized, or have overlapped from the start (handover=False). "
					  "Move them apart")
				+ (gapCorrection == 0 && maxPenetration < smallest ? ", or set gapCorrection=0.1, which pushes overlaps out" : ""));
	}
	if (restitution > 0 && (atOnce || !misses))
		return "A contact that impulses of other contacts close rebounds only in the next step, and until then it overlaps by up to its "
		       "closing "
		       "speed times O.dt. Take a smaller O.dt";
	// The step in which no disk moves by more than a quarter of a radius, or, if that is longer, leaves half of what is reported, since a small
	// overlap that comes at once is proportional to O.dt.
	if (atOnce)
		return text("It came in this one step, which is ", misses ? "not solved, or " : "",
		    "too long for the speed of the bodies: take a smaller O.dt, about ", std::setprecision(2),
		    scene_dt(scene) * std::min(0.5, std::max(0.25 / longest, 0.5 * deep * smallest / grown)), " s",
		    misses ? ", or raise maxIterations or fixedIterations" : "");
	if (misses)
		return "The forces that hold them apart are too small: raise maxIterations or fixedIterations";
	if (stepTolerance > loose)
		return "It grew step by step, since solver errors within the tolerance add up: lower tolerance to 1e-4 or less";
	if (gapCorrection > 0)
		return "It grew step by step by more than gapCorrection pushes out: take a smaller O.dt, or lower tolerance";
	return "It grew step by step, since solver errors within the tolerance add up, a boundary changes its velocity (by the change times O.dt/2), "
	       "or "
	       "disks grow. Means over a flow bear overlaps of some hundredths of a radius; else take a smaller O.dt, lower tolerance, or set "
	       "gapCorrection=0.1, which removes overlaps";
}

} // namespace cd_engine
