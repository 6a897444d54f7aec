// The attributes of the engine and its registration.
#include "contact_dynamics.hpp"

#include <algorithm>

namespace cd_engine {

const char* const ContactDynamics::documentation
    = "Contact Dynamics for disks in the plane: rigid bodies, unilateral contact (Signorini) and exact, non-associated Coulomb friction, "
      "solved implicitly for all contacts of a step at once; moves the bodies by the Moreau-Jean scheme. Takes the place of InteractionLoop and "
      "NewtonIntegrator; stands after ForceResetter (:py:func:`cd_engine.engines` makes the list). Finds near pairs itself, without a collider. "
      "Disks are Sphere bodies with blockedDOFs='zXY' in one plane of constant z; Box (turned about z at will) and Wall are boundaries: fixed, "
      "moving at a prescribed velocity, or free in some directions and pushed by O.forces. Two boundaries never touch each other. Friction: the "
      "smaller frictionAngle of the two. After a step every loaded contact is a real interaction with ScGeom and FrictPhys, and O.forces holds the "
      "total on each body, gravity of free bodies included.";

template <class Visitor> void ContactDynamics::attributes(Visitor&& visit)
{
	using C = ContactDynamics;
	constexpr double most = std::numeric_limits<int>::max();
	visit("gravity", &C::gravity, setting, "Acceleration acting on every free body [m/s^2], in the plane (x, y).");
	visit("tolerance", &C::tolerance, Access { Access::set, 0, 1, true },
	    "Largest error of a solved step [1]: of *residual*, of the same error weighted by W_nn, and of *bodyError*, which is relative to what "
	    "acts on a single body. If *flowTolerance* is larger, this is for steps in which nothing slides or collides. Assigning it sets "
	    "*flowTolerance* to 0.");
	visit("flowTolerance", &C::flowTolerance, within(0, 1),
	    "If larger than *tolerance*: tolerance of steps soon after bodies have flowed or collided, and of those that collide and are not solved "
	    "to *tolerance* in 1000 iterations; if bodies moved slowly, a tenth of it or less, but at least *tolerance* [1]. 0: *tolerance* "
	    "holds in every step. :py:func:`cd_engine.engines` sets it to 1e-4 if it is given no tolerance. Assign it after *tolerance*.");
	visit("maxIterations", &C::maxIterations, within(1, most),
	    "Sweeps and factorizations after which a step is left unconverged [1]; a tenth more where contacts are found only after the others are "
	    "solved.");
	visit("fixedIterations", &C::fixedIterations, within(0, most),
	    "If positive: make exactly this many plain Gauss-Seidel sweeps in every step, whatever *method*, and test nothing, for studies of "
	    "under-converged contact dynamics [1].");
	visit("method", &C::method, setting,
	    "Name of the solver: one of :py:func:`cd_engine.methods`. nsgs: plain Gauss-Seidel sweeps; accelerated: sweeps with momentum; newton: "
	    "proximal-point semismooth Newton, for small problems; auto: accelerated, and newton where that stagnates, which can take half a second "
	    "a step and more.");
	visit("warmStart", &C::warmStart, setting,
	    "Take the contact forces present in the scene (of the last step, or of springs) as the first guess.");
	visit("restitution", &C::restitution, within(0, 1),
	    "Coefficient of normal restitution, by Moreau's law of impact [1]; 0 for quasi-static work. If an island of contacts with friction would "
	    "gain energy, the engine lowers the coefficient there for this step; if the step has no solution with it, it takes 0 there.");
	visit("gapCorrection", &C::gapCorrection, within(0, 1),
	    "Share of an overlap, beyond the reference one and *allowedOverlap*, that a step pushes out [1]; 0: overlaps are only kept from growing. "
	    "The velocity of pushing out stays with the bodies, and its energy counts as dissipated with a minus sign. With few *fixedIterations* it "
	    "needs *warmStart* False: impulses that add up from step to step overshoot.");
	visit("allowedOverlap", &C::allowedOverlap, within(0, 1),
	    "Overlap that *gapCorrection* leaves, as a share of the smaller disk's radius [1]. With 0, a packing never comes to rest: the "
	    "corrections of its contacts contradict each other and keep it moving.");
	visit("seed", &C::seed, within(0, most),
	    "If positive: visit the contacts in a new random order in every sweep, drawn from this seed; 0: one fixed order, the fastest.");
	visit("reduce", &C::reduce, setting,
	    "Solve islands of contacts without a common movable body separately, each to the tolerance by itself, which is at least as strict as the "
	    "tolerance for the whole; bodies that touch nothing take no part. If there is one island only and the step needs sweeps, it has the same "
	    "bits as without. "
	    "Without effect under *fixedIterations* or *seed*, which mean the sweeps over all contacts.");
	visit("handover", &C::handover, setting,
	    "At the next step take the overlaps present as reference, from which gaps are counted, so that what springs left behind is not expelled. "
	    "Reset to False by that step. If it was True at first, it is set again when springs have run.");
	visit("searchMargin", &C::searchMargin, within(0, 10),
	    "How far around slow bodies near pairs are listed, at least, as a fraction of the smallest radius [1]; around fast ones as far as a step "
	    "needs. Pairs are searched anew when bodies have moved through their margins. Changes the cost of a run, never its result.");
	visit("publish", &C::publish, setting,
	    "When positions, velocities, interactions and O.forces are written to the scene. due: in a run that somebody waits for (O.run(n, True), "
	    "O.wait()) before any other engine that is due looks at them, and when the run ends; in every other step at once. always: in every step. "
	    "The motion is the same to the last bit. What Python threads of one's own see meanwhile may be as old as the last such moment.");
	visit("stopUnsolved", &C::stopUnsolved, setting,
	    "End the run, with an error that names the step, at a step that is not solved; the step has then been made. False: the engine warns of "
	    "the first such step and the run goes on.");
	visit("threads", &C::threads, within(0, 1024),
	    "Threads that share the work of a step [1]; 0: as many as YADE has (-j, OMP_NUM_THREADS). The motion is the same to the last bit with "
	    "any number. Only steps with thousands of bodies and contacts use more than one.");
	visit("iterations", &C::iterations, result,
	    "Sweeps, and factorizations of Newton's method, made in the last step: the largest number on one of its *islands* [1].");
	visit("residual", &C::residual, result,
	    "Error of the last step [1]: ||p - P_K(p - (u + mu |u_t| n)/W_nn)||/||p||, 2-norms over all contacts; p impulses, u relative velocities "
	    "after the step plus gap/dt, W_nn each contact's own normal compliance, P_K the projection on Coulomb's cone.");
	visit("residualMax", &C::residualMax, result, "The same for the worst contact, over the root mean square of p [1].");
	visit("bodyError", &C::bodyError, result,
	    "Estimated largest error of a body's velocity change in the last step, relative to what acts on the body: the impulses of its contacts "
	    "and the external one [1]. In packings, where some disks always carry hardly any load, it is relative to a mean over the island, "
	    "weighted by mass (cd_engine/core/residual.hpp has the formula).");
	visit("worstBody", &C::worstBody, result, "Id of the body whose velocity may have the largest error; -1: none.");
	visit("unsolvableContact", &C::unsolvableContact, result,
	    "Ids of the two bodies whose contact is the strongest sign that there is no solution, if *status* is no_solution or a doubt remains. "
	    "Example of "
	    "such a step: a disk between two walls that move towards each other.");
	visit("converged", &C::converged, result,
	    "Whether the last step is solved: the contact law holds to *stepTolerance*, relative to all impulses (*residual*), and the "
	    "estimated error of every body's velocity change is at most that, relative to what acts on the body (*bodyError*). The true error may be "
	    "many times larger (cd_engine/README.md).");
	visit("stepTolerance", &C::stepTolerance, result, "The tolerance of the last step: *tolerance*, *flowTolerance*, or one between them [1].");
	visit("status", &C::status, result,
	    "How the last step's solution ended: converged, fixed_iterations, max_iterations, stagnated, no_solution (*unsolvableContact*) or "
	    "diverged.");
	visit("solvedBy", &C::solvedBy, result, "The method that brought the last step to its tolerance, or none.");
	visit("contacts", &C::contacts, result, "Contacts the solver was given in the last step [1].");
	visit("unknowns", &C::unknowns, result,
	    "Velocities it had to find: three for a free disk, none for a fixed body, nor with *reduce* for a body without contacts [1].");
	visit("islands", &C::islands, result, "Islands of contacts solved apart; 1 for all contacts if they were not parted [1].");
	visit("resting", &C::resting, result,
	    "Islands whose first guess, the forces of the step before, was within the tolerance already, so that no sweep was made [1].");
	visit("sleeping", &C::sleeping, result,
	    "Of these, islands that are proven to be at rest, to a thousandth of the tolerance, and in which nothing changes: their velocities are "
	    "zero, and the engine only checks whether their bodies have changed [1].");
	visit("woken", &C::woken, result, "Why islands were woken last: the step, what had changed, and the body.");
	visit("loadsBeforeTrial", &C::loadsBeforeTrial, internal,
	    "In the step before a trial of rest: fingerprints of the loads of all bodies. What has another load then is not tried [1].");
	visit("restTrialAt", &C::restTrialAt, internal,
	    "Number of steps from which on slow islands have to prove their rest again: those that come to rest of themselves where a step is solved "
	    "to a thousandth of the tolerance are stopped and sleep [1].");
	visit("pressed", &C::pressed, internal,
	    "Whether the last step had no solution, or was left unsolved after such a one: its impulses may have grown without end.");
	visit("rested", &C::rested, internal,
	    "Whether the last step solved its one large island without a sweep; this decides in which order impulses are added, and so last digits.");
	visit("unrest", &C::unrest, internal,
	    "Energy dissipated in a step over the sum of W_nn |p|^2 of its contacts, the largest of the last steps: decides between *tolerance* and "
	    "*flowTolerance* [1].");
	visit("restTrialPause", &C::restTrialPause, internal, "Steps to the trial after that, 16 to 2048: more after each that fails [1].");
	visit("loadedContacts", &C::loadedContacts, result, "Contacts that carry a force [1].");
	visit("slidingContacts", &C::slidingContacts, result, "Loaded contacts with friction whose tangential force is at the Coulomb limit [1].");
	visit("maxPenetration", &C::maxPenetration, result, "Largest overlap beyond the reference one met in the last step [m].");
	visit("deepestPenetration", &C::deepestPenetration, result,
	    "Largest *maxPenetration* of all steps [m]. Beyond a hundredth of the smallest radius the engine warns, once: if forces are far "
	    "too small, bodies pass into each other, even though *residual* may be within the tolerance.");
	visit("largestResidual", &C::largestResidual, result, "Largest *residual* of all steps [1].");
	visit("handoverOverlap", &C::handoverOverlap, result, "Largest overlap taken as reference at the hand-over [m].");
	visit("dissipatedEnergy", &C::dissipatedEnergy, result,
	    "Energy lost in friction and impacts since the engine was made [J]. With O.trackEnergy it also goes into O.energy['plastDissip'], beside "
	    "'kinetic' and 'gravWork'.");
	visit("steps", &C::steps, result, "Steps made [1].");
	visit("unconvergedSteps", &C::unconvergedSteps, result,
	    "Steps that missed their tolerance [1]; steps under *fixedIterations* are not counted.");
	visit("totalIterations", &C::totalIterations, result, "Sweeps and factorizations made in all steps [1].");
	visit("solveTime", &C::solveTime, result,
	    "Time spent in the solver [s]; what O.timingEnabled shows beyond it went into geometry, reading and writing the scene.");
	visit("referenceIds", &C::referenceIds, internal, "Ids of the pairs that keep a reference overlap, two a pair.");
	visit("referenceOverlaps", &C::referenceOverlaps, internal,
	    "The reference overlaps of these pairs [m]. A pair forgets its overlap once its bodies are apart.");
	visit("bodyOrder", &C::bodyOrder, internal,
	    "In scenes of more than 2048 bodies: the place of every body along a curve through space (Hilbert's), by which contacts are ordered in "
	    "memory. Renewed where the bodies have moved far apart along it, and saved, so that a run goes on as if it had not been saved.");
	visit("bodyOrderLength", &C::bodyOrderLength, internal, "Length of the way through the disks in that order, when it was made [m].");
}

// Whoever assigns a tolerance wants it in every step.
void ContactDynamics::assigned(const std::string& attribute)
{
	if (attribute == "tolerance")
		flowTolerance = 0;
}

// Checks loaded lists that steps use unchecked. bodyOrder is not checked: it is only a hint, and is made anew if it is invalid.
void ContactDynamics::checkLoaded() const
{
	const std::string damaged = "ContactDynamics: the file is damaged: ";
	const std::string remedy = " Load another one, or empty both lists in it, which makes the overlaps present now count as such";
	const std::size_t pairs = referenceOverlaps.size();
	if (referenceIds.size() != 2 * pairs)
		throw SceneError(
		    text(damaged, "it has ", referenceIds.size(), " referenceIds for ", pairs, " referenceOverlaps, not two for each.", remedy));
	for (std::size_t i = 0; i < pairs; i++) {
		const int *const now = &referenceIds[2 * i], *const before = i > 0 ? now - 2 : nullptr;
		const std::string pair = text("of bodies #", now[0], " and #", now[1]);
		if (now[0] < 0 || now[0] >= now[1] || (before && !(std::make_pair(before[0], before[1]) < std::make_pair(now[0], now[1]))))
			throw SceneError(damaged + "the referenceIds " + pair + " are negative or not in order, the smaller first." + remedy);
		if (!(referenceOverlaps[i] > 0 && std::isfinite(referenceOverlaps[i])))
			throw SceneError(damaged + "the referenceOverlaps " + pair + " are " + std::to_string(referenceOverlaps[i]) + " m." + remedy);
	}
}

std::string ContactDynamics::wordFault(const char* attribute, const std::string& value)
{
	const std::vector<std::string> known = std::string(attribute) == "method" ? cd::solverNames() : std::vector<std::string> { "due", "always" };
	if (std::find(known.begin(), known.end(), value) != known.end())
		return "";
	std::string words;
	for (const std::string& word : known)
		words += (words.empty() ? "'" : ", '") + word + "'";
	return "='" + value + "' is not known; there is " + words;
}

template class RegisteredEngine<ContactDynamics>;

} // namespace cd_engine

CD_ENGINE_REGISTER(ContactDynamics)
