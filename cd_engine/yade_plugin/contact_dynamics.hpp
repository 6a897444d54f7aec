// The engine that YADE sees.
#pragma once

#include "other_engines.hpp"
#include "registered_engine.hpp"
#include "scene_link.hpp"

#include <atomic>
#include <mutex>
#include <optional>

namespace cd_engine {

class ContactDynamics : public RegisteredEngine<ContactDynamics> {
    public:
	static constexpr const char* name = "ContactDynamics";
	static const char* const documentation;

	~ContactDynamics() override;

	// Set by the user.
	Vector3r gravity = Vector3r::Zero();
	double tolerance = 1e-6;
	int maxIterations = 20000;
	int fixedIterations = 0;
	std::string method = "auto";
	bool warmStart = true;
	double restitution = 0;
	double gapCorrection = 0;
	double allowedOverlap = 1e-3;
	int seed = 0;
	bool reduce = true;
	bool handover = true;
	double searchMargin = 0.1;
	std::string publish = "due";
	bool stopUnsolved = false;
	int threads = 0;

	// Results of the last step.
	int iterations = 0;
	double residual = 0;
	double residualMax = 0;
	double bodyError = 0;
	int worstBody = -1;
	std::vector<int> unsolvableContact;
	bool converged = false;
	std::string status = "no step yet";
	std::string solvedBy = "none";
	int contacts = 0;
	int unknowns = 0;
	int islands = 0;
	int resting = 0;
	int sleeping = 0;
	std::string woken;
	int loadedContacts = 0;
	int slidingContacts = 0;
	double maxPenetration = 0;
	double handoverOverlap = 0;

	// Over all steps.
	double deepestPenetration = 0;

	// The step of the next trial of rest, and the loads in the step before it. Saved, because a trial stops what it finds at rest.
	std::vector<int> loadsBeforeTrial;
	long restTrialAt = 0;
	int restTrialPause = 16;
	bool pressed = false;

	// Summed over the steps.
	double dissipatedEnergy = 0;
	long steps = 0;
	long unconvergedSteps = 0;
	long totalIterations = 0;
	double solveTime = 0;

	// The reference overlaps, so that they survive O.save.
	std::vector<int> referenceIds;
	std::vector<double> referenceOverlaps;

	// The order of the contacts. Saved, because it decides the last digits of a step.
	std::vector<int> bodyOrder;
	double bodyOrderLength = 0;

	template <class Visitor> static void attributes(Visitor&& visit); // see RegisteredEngine
	// Throws std::invalid_argument (Python's ValueError) where the attribute cannot have this value.
	static void checkText(const char* attribute, const std::string& value);
	void checkLoaded() const;

	void action() override;
	// Brings the scene up to date, by the engine that has made the last step.
	static void settleLatest();
	void exportProblem(const std::string& path, bool bodies);
	static void summary(const boost::python::object& self);
	template <class Class> static void methods(Class&);

    private:
	cd::StepSettings settings(yade::Scene*) const;
	void settle();
	bool somebodyLooks() const;
	void takeOver();
	void forget();
	void advance();
	void report(const cd::StepReport&, const cd::StepSettings&);
	void planRestTrial(const cd::Effort&, bool tried);
	bool sleepGoesOn(const cd::StepSettings&) const;
	Memory memory() { return { { referenceIds, referenceOverlaps }, { bodyOrder, bodyOrderLength }, attributesLock }; }
	bool looksAtOrder() const { return steps % 64 == 0; }
	void warn();
	std::string unsolved() const;
	void tellOfLost();
	void tellOfSpeed(double dt);
	void watchPenetration(double before) const;

	// The scene from step to step; all of it can be rebuilt. Only the engine that has made the last step keeps it.
	SceneLink link;
	std::optional<ColliderRest> rest { std::in_place };
	cd::TimeStep step;
	static std::atomic<ContactDynamics*> latest; // the engine that has made the last step
	std::mutex stepping; // held during a step: O.pause() may return while the last step still runs
	OtherEngines others;
	bool warned = false, toldOfLost = false, toldOfSpeed = false, toldOfUnsolvable = false;
	cd::StepSettings last; // settings of the last step
	bool idle = false; // the last step changed nothing, nor will the next one unless somebody changes something
};

inline const char* const ContactDynamics::documentation
    = "Contact Dynamics for disks in the plane: rigid bodies, unilateral contact (Signorini) and exact, non-associated Coulomb friction, "
      "solved implicitly for all contacts of a step at once; moves the bodies by the Moreau-Jean scheme. Takes the place of InteractionLoop and "
      "NewtonIntegrator; stands after ForceResetter (:py:func:`cd_engine.engines` makes the list). Finds near pairs itself, without a collider. "
      "Disks are Sphere bodies with blockedDOFs='zXY' in one plane of constant z; Box (turned about z at will) and Wall are boundaries: fixed, "
      "moving at a prescribed velocity, or free in some freedoms and pushed by O.forces. Two boundaries never touch each other. Friction: the "
      "smaller frictionAngle of the two. After a step every loaded contact is a real interaction with ScGeom and FrictPhys, and O.forces holds the "
      "total on each body, gravity of free bodies included.";

template <class Visitor> void ContactDynamics::attributes(Visitor&& visit)
{
	using C = ContactDynamics;
	const Range any, relative { 0, 1, true };
	visit("gravity", &C::gravity, Access::set, any, "Acceleration acting on every free body [m/s^2], in the plane (x, y).");
	visit("tolerance", &C::tolerance, Access::set, relative,
	    "The step is solved when the contact law is met and every body's velocity change is right to this (*residual*, the same weighted by "
	    "W_nn, and *bodyError*) [1].");
	visit("maxIterations", &C::maxIterations, Access::set, Range { 1, 2147483647. },
	    "Sweeps and factorizations after which a step is left unconverged [1]; a tenth more where contacts are found only after the others are "
	    "solved.");
	visit("fixedIterations", &C::fixedIterations, Access::set, Range { 0, 2147483647. },
	    "If positive: make exactly this many plain Gauss-Seidel sweeps in every step, whatever *method*, and test nothing, for studies of "
	    "under-converged contact dynamics [1].");
	visit("method", &C::method, Access::set, any,
	    "Name of the solver: one of :py:func:`cd_engine.methods`. nsgs: plain Gauss-Seidel sweeps; accelerated: sweeps with momentum; newton: "
	    "proximal-point semismooth Newton, for small problems; auto: accelerated, and newton where that stagnates, which can take half a second "
	    "a step and more.");
	visit("warmStart", &C::warmStart, Access::set, any,
	    "Take the contact forces present in the scene (of the last step, or of springs) as the first guess.");
	visit("restitution", &C::restitution, Access::set, Range { 0, 1 },
	    "Coefficient of normal restitution, by Moreau's law of impact [1]; 0 for quasi-static work. Contacts with friction that hang together "
	    "take a smaller one in a step in which this one would add energy, and 0 where nothing solves the step with it.");
	visit("gapCorrection", &C::gapCorrection, Access::set, Range { 0, 1 },
	    "Share of an overlap, beyond the reference one and *allowedOverlap*, that a step pushes out [1]; 0: overlaps are only kept from growing. "
	    "The velocity of pushing out stays with the bodies, and its energy counts as dissipated with a minus sign. With few *fixedIterations* it "
	    "needs *warmStart* False: impulses that add up from step to step overshoot.");
	visit("allowedOverlap", &C::allowedOverlap, Access::set, Range { 0, 1 },
	    "Overlap that *gapCorrection* leaves, as a share of the smaller disk's radius [1]. With 0, a packing at rest is stirred for ever: the "
	    "corrections of its contacts contradict each other.");
	visit("seed", &C::seed, Access::set, Range { 0, 2147483647. },
	    "If positive: visit the contacts in a new random order in every sweep, drawn from this seed; 0: one fixed order, the fastest.");
	visit("reduce", &C::reduce, Access::set, any,
	    "Solve islands of contacts without a common movable body separately, each to the tolerance by itself, which is never less than the "
	    "tolerance for the whole; bodies that touch nothing take no part. A step of one island is the same to the last bit. "
	    "Without effect under *fixedIterations* or *seed*, which mean the sweeps over all contacts.");
	visit("handover", &C::handover, Access::set, any,
	    "At the next step take the overlaps present as reference, from which gaps are counted, so that what springs left behind is not expelled. "
	    "Reset to False by that step; set it again after an interlude with springs.");
	visit("searchMargin", &C::searchMargin, Access::set, Range { 0, 10 },
	    "How far around slow bodies near pairs are listed, at least, as a fraction of the smallest radius [1]; around fast ones as far as a step "
	    "needs. Pairs are searched anew when bodies have moved through their margins. Changes the cost of a run, never its result.");
	visit("publish", &C::publish, Access::set, any,
	    "When positions, velocities, interactions and O.forces are written to the scene. due: in a run that somebody waits for (O.run(n, True), "
	    "O.wait()) before any other engine that is due looks at them, and when the run ends; in every other step at once. always: in every step. "
	    "The motion is the same to the last bit. What Python threads of one's own see meanwhile may be as old as the last such moment.");
	visit("stopUnsolved", &C::stopUnsolved, Access::set, any,
	    "End the run, with an error that names the step, at a step that is not solved; the step has then been made. False: the first one is told "
	    "of and the run goes on.");
	visit("threads", &C::threads, Access::set, Range { 0, 1024 },
	    "Threads that share the work of a step [1]; 0: as many as YADE has (-j, OMP_NUM_THREADS). The motion is the same to the last bit with "
	    "any number. Only steps with thousands of bodies and contacts use more than one.");
	visit("iterations", &C::iterations, Access::read, any,
	    "Sweeps, and factorizations of Newton's method, made in the last step, of its *islands* the most [1].");
	visit("residual", &C::residual, Access::read, any,
	    "Error of the last step [1]: ||p - P_K(p - (u + mu |u_t| n)/W_nn)||/||p||, 2-norms over all contacts; p impulses, u relative velocities "
	    "after the step plus gap/dt, W_nn each contact's own normal compliance, P_K the projection on Coulomb's cone.");
	visit("residualMax", &C::residualMax, Access::read, any, "The same for the worst contact, over the root mean square of p [1].");
	visit("bodyError", &C::bodyError, Access::read, any,
	    "How far off the velocity changes of the last step may be, relative to what acts on the body: its contacts' impulses and its external "
	    "one [1]. Of all islands of contacts the largest. In packings, where some disks always carry next to nothing, relative to the mean over "
	    "the mass of the island (cd_engine/core/residual.hpp has the formula).");
	visit("worstBody", &C::worstBody, Access::read, any, "Id of the body whose velocity may be the most wrong; -1: none.");
	visit("unsolvableContact", &C::unsolvableContact, Access::read, any,
	    "Where *status* is no_solution: ids of the bodies of the contact that speaks most against one. A disk between two walls that move "
	    "towards each other has none.");
	visit("converged", &C::converged, Access::read, any,
	    "Whether the last step is solved: the contact law holds to *tolerance*, relative to all impulses (*residual*), and the velocity change "
	    "of every body is right to *tolerance*, relative to what acts on that body (*bodyError*).");
	visit("status", &C::status, Access::read, any,
	    "How the last step's solution ended: converged, fixed_iterations, max_iterations, stagnated, no_solution (*unsolvableContact*) or "
	    "diverged.");
	visit("solvedBy", &C::solvedBy, Access::read, any, "The method that brought the last step to its tolerance, or none.");
	visit("contacts", &C::contacts, Access::read, any, "Contacts the solver was given in the last step [1].");
	visit("unknowns", &C::unknowns, Access::read, any,
	    "Velocities it had to find: three for a free disk, none for a fixed body, nor with *reduce* for a body without contacts [1].");
	visit("islands", &C::islands, Access::read, any, "Islands of contacts solved apart; 1 for all contacts if they were not parted [1].");
	visit("resting", &C::resting, Access::read, any,
	    "Islands whose first guess, the forces of the step before, was within the tolerance already, so that no sweep was made [1].");
	visit("sleeping", &C::sleeping, Access::read, any,
	    "Of these, islands at rest, proven to a thousandth of the tolerance, in which nothing changes: their velocities are zero, and nothing of "
	    "them is looked at but their bodies [1].");
	visit("woken", &C::woken, Access::read, any, "Why islands were woken last: the step, what had changed, and the body.");
	visit("loadsBeforeTrial", &C::loadsBeforeTrial, Access::internal, any,
	    "In the step before a trial of rest: fingerprints of the loads of all bodies. What has another load then is not tried [1].");
	visit("restTrialAt", &C::restTrialAt, Access::internal, any,
	    "Number of steps from which on slow islands have to prove their rest again: those that come to rest of themselves where a step is solved "
	    "to a thousandth of the tolerance are stopped and sleep [1].");
	visit("pressed", &C::pressed, Access::internal, any,
	    "Whether the last step had no solution, or was left unsolved after such a one: its impulses may have grown without end.");
	visit("restTrialPause", &C::restTrialPause, Access::internal, any,
	    "Steps to the trial after that, 16 to 2048: more after each that fails [1].");
	visit("loadedContacts", &C::loadedContacts, Access::read, any, "Contacts that carry a force [1].");
	visit("slidingContacts", &C::slidingContacts, Access::read, any,
	    "Loaded contacts with friction whose tangential force is at the Coulomb limit [1].");
	visit("maxPenetration", &C::maxPenetration, Access::read, any, "Largest overlap beyond the reference one met in the last step [m].");
	visit("deepestPenetration", &C::deepestPenetration, Access::read, any,
	    "Largest *maxPenetration* of all steps [m]. Beyond a hundredth of the smallest radius the engine warns, once: bodies pass into each "
	    "other where forces are far too small, even if *converged* says that the error e is.");
	visit("handoverOverlap", &C::handoverOverlap, Access::read, any, "Largest overlap taken as reference at the hand-over [m].");
	visit("dissipatedEnergy", &C::dissipatedEnergy, Access::read, any,
	    "Energy lost in friction and impacts since the engine was made [J]. With O.trackEnergy it also goes into O.energy['plastDissip'], beside "
	    "'kinetic' and 'gravWork'.");
	visit("steps", &C::steps, Access::read, any, "Steps made [1].");
	visit("unconvergedSteps", &C::unconvergedSteps, Access::read, any,
	    "Steps that missed *tolerance* [1]; steps under *fixedIterations* are not counted.");
	visit("totalIterations", &C::totalIterations, Access::read, any, "Sweeps and factorizations made in all steps [1].");
	visit("solveTime", &C::solveTime, Access::read, any,
	    "Time spent in the solver [s]; what O.timingEnabled shows beyond it went into geometry, reading and writing the scene.");
	visit("referenceIds", &C::referenceIds, Access::internal, any, "Ids of the pairs that keep a reference overlap, two a pair.");
	visit("referenceOverlaps", &C::referenceOverlaps, Access::internal, any,
	    "The reference overlaps of these pairs [m]. A pair forgets its overlap once its bodies are apart.");
	visit("bodyOrder", &C::bodyOrder, Access::internal, any,
	    "In scenes of more than 2048 bodies: the place of every body along a curve through space (Hilbert's), by which contacts are ordered in "
	    "memory. Renewed where the bodies have moved far apart along it, and saved, so that a run goes on as if it had not been saved.");
	visit("bodyOrderLength", &C::bodyOrderLength, Access::internal, any,
	    "Length of the way through the disks in that order, when it was made [m].");
}

template <class Class> void ContactDynamics::methods(Class& cls)
{
	cls.def(
	    "summary", &ContactDynamics::summary, boost::python::arg("self"), "Print how the engine is set and how its steps went, on one screen.");
	cls.def("exportProblem", &ContactDynamics::exportProblem,
	    (boost::python::arg("self"), boost::python::arg("path"), boost::python::arg("bodies") = false),
	    "Write the contact problem that the next step would solve to *path* (FCLIB, HDF5; with *bodies* a BodyProblem as .npz, in the order of "
	    "the sweeps and with the first guess) for :py:func:`cd_engine.core.read_problem` and for other codes; the ids of the bodies of each "
	    "contact are in its data set contact_ids. Nothing in the scene changes. External forces are gravity and the permanent ones "
	    "(O.forces.setPermF); what engines add in the course of a step is not known before it, and is left out. ");
}

} // namespace cd_engine
