// The attributes of ContactDynamics, as a user reads them and a scene saves them: type, name, value at first, Access, documentation.
CD_ATTRIBUTE(Vector3r, gravity, Vector3r::Zero(), setting, "Acceleration acting on every free body [m/s^2], in the plane of the scene.")
CD_ATTRIBUTE(double, tolerance, 1e-6, Access { Access::set, 0, 1, true },
    "Largest error of a solved step [1]: of *residual*, of the same error weighted by W_nn, and of *bodyError*, which is relative to what "
    "acts on a single body. If *flowTolerance* is larger, this is for steps in which nothing slides or collides. Assigning it sets "
    "*flowTolerance* to 0. With a *stiffness* it is relative to the motion of the step: to sum |p u|/sum W_nn |p|^2 of the step before, so that small "
    "changes of the load are solved as exactly as large ones.")
CD_ATTRIBUTE(double, flowTolerance, 0, within(0, 1),
    "If larger than *tolerance*: tolerance of steps after bodies have flowed or collided [1]; after slow motion the engine takes a tenth of it, a "
    "hundredth and so on, but at least *tolerance*. 0: *tolerance* holds in every step. Whether an island is at rest is always tested with "
    "*tolerance*. "
    ":py:func:`cd_engine.engines` sets it to 1e-4 if it is given no tolerance. Assign it after *tolerance*.")
CD_ATTRIBUTE(int, maxIterations, 20000, within(1, most),
    "Sweeps and factorizations after which a step is left unconverged [1]; in space the last 50, if they are more than 500, serve a search that helps "
    "lattices; up to a tenth more if the step has to be solved again, because further pairs have closed or, with *restitution*, because rebounds would "
    "create energy or leave no solution.")
CD_ATTRIBUTE(int, fixedIterations, 0, within(0, most),
    "If positive: make exactly this many plain Gauss-Seidel sweeps in every step, whatever *method*, and test nothing, for studies of "
    "under-converged contact dynamics [1].")
CD_ATTRIBUTE(std::string, method, "auto", setting,
    "Name of the solver: one of :py:func:`cd_engine.methods`. nsgs: plain Gauss-Seidel sweeps; accelerated: sweeps with momentum; newton: "
    "proximal-point semismooth Newton, for small problems; auto: accelerated, and newton where that stagnates, which can take half a second "
    "a step and more.")
CD_ATTRIBUTE(bool, warmStart, true, setting, "Take the contact forces present in the scene (of the last step, or of springs) as the first guess.")
CD_ATTRIBUTE(double, restitution, 0, within(0, 1),
    "Coefficient of normal restitution, by Moreau's law of impact [1]; 0 for quasi-static work. If an island of contacts with friction would "
    "gain energy, the engine lowers the coefficient there for this step; if the step has no solution with it, it takes 0 there.")
CD_ATTRIBUTE(Matches, en, {}, setting,
    "Coefficient of normal restitution by pair of materials [1], as a MatchMaker of ids in O.materials, like en of Ip2_FrictMat_FrictMat_MindlinPhys: "
    "MatchMaker(matches=((0, 1, 0.8), (1, 1, 0.3))). A pair that matches nothing has *restitution*, unless the algo of the MatchMaker is val or zero. "
    "A number holds for all pairs. None: *restitution* for all.")
CD_ATTRIBUTE(Matches, frictAngle, {}, setting,
    "Friction angle by pair of materials [rad], as frictAngle of Ip2_FrictMat_FrictMat_FrictPhys: a MatchMaker of ids in O.materials, whose algo (min, "
    "max, avg, harmAvg, val) holds for pairs that match nothing. A number holds for all pairs. None: the smaller angle of the two.")
CD_ATTRIBUTE(int, mask, 0, within(0, most),
    "As NewtonIntegrator.mask: if positive, a boundary whose groupMask shares no bit with it stays where it is, whatever its velocity, and its surface "
    "moves along itself: a belt. Each contact feels the part of state.vel (and of state.angVel about the centre) along the surface there [1].")
CD_ATTRIBUTE(double, stiffness, INFINITY, (Access { Access::set, 0, INFINITY, true }),
    "Normal stiffness k_n of every contact [N/m]; inf: rigid. The springs are those of Molecular Dynamics, solved implicitly at the end of the step "
    "(backward Euler), so that O.dt has no stability limit. *tolerance* is then relative to the motion of a step, and *flowTolerance*, *restitution* "
    "and *gapCorrection* have no meaning.")
CD_ATTRIBUTE(double, tangentialStiffness, INFINITY, (Access { Access::set, 0, INFINITY }),
    "Tangential stiffness k_t [N/m] of contacts that have a *stiffness*; 0: no friction; inf: friction without a spring.")
CD_ATTRIBUTE(bool, materialStiffness, false, setting,
    "Take k_n and k_t of each contact from the materials (young, poisson) and radii, as YADE's Ip2_FrictMat_FrictMat_FrictPhys does; a boundary counts "
    "as a disk of the other's radius, a Facet of twice this radius. It takes the place of *stiffness* and *tangentialStiffness*.")
CD_ATTRIBUTE(double, dampingRatio, 0, within(0, 10),
    "Normal dashpot of contacts that have a stiffness, as a share of critical damping [1]: c = 2 dampingRatio sqrt(k_n m), 1/m = 1/m1 + 1/m2 (betan of "
    "YADE's FrictViscoMat). It never pulls. A restitution e needs -ln(e)/sqrt(pi^2 + ln(e)^2) and steps far below sqrt(m/k_n); the scheme itself damps, "
    "too.")
CD_ATTRIBUTE(double, gapCorrection, 0, within(0, 1),
    "Share of an overlap, beyond the reference one and *allowedOverlap*, that a step removes [1]; 0: overlaps are only kept from growing. It moves "
    "the bodies, after the step, and gives them no velocity (a split impulse). A pile that grows by this gains potential energy.")
CD_ATTRIBUTE(bool, gapVelocity, false, setting,
    "Let *gapCorrection* act on the velocities, which the bodies keep, as in studies of contact dynamics with few *fixedIterations* (Unger and "
    "Kertesz 2002). The energy that this adds is subtracted from *dissipatedEnergy*. With few sweeps set *warmStart* False, too: impulses "
    "that add up from step to step overshoot.")
CD_ATTRIBUTE(double, allowedOverlap, 1e-3, within(0, 1),
    "Overlap that *gapCorrection* leaves, as a share of the smaller disk's radius [1]. With 0, a packing never comes to rest: the "
    "corrections of its contacts contradict each other and keep it moving.")
CD_ATTRIBUTE(int, seed, 0, within(0, most),
    "If positive: visit the contacts in a new random order in every sweep, drawn from this seed; 0: one fixed order, the fastest.")
CD_ATTRIBUTE(bool, reduce, true, setting,
    "Solve islands of contacts without a common movable body separately, each to the tolerance by itself, which is at least as strict as the "
    "tolerance for the whole; bodies that touch nothing take no part. With a single island the result is the same to the last bit as with False, "
    "if the step needs sweeps. It has no effect if *fixedIterations* or *seed* is set, because these apply to sweeps over all contacts.")
CD_ATTRIBUTE(bool, handover, true, setting,
    "At the next step take the overlaps present as reference, from which gaps are counted, so that what springs left behind is not expelled. "
    "Reset to False by that step. If it was True at first, it is set again when springs have run.")
CD_ATTRIBUTE(double, searchMargin, 0.1, within(0, 10),
    "How far around slow bodies near pairs are listed, at least, as a fraction of the smallest radius [1]; around fast ones as far as a step "
    "needs. Pairs are searched anew when bodies have moved through their margins. Changes the cost of a run, not the "
    "motion of bodies that move by less than a radius in a step.")
CD_ATTRIBUTE(std::string, publish, "due", setting,
    "When positions, velocities, interactions and O.forces are written to the scene. due: in a run that somebody waits for (O.run(n, True), "
    "O.wait()) before any other engine that is due looks at them, and when the run ends; in a run that nobody waits for, after every step. "
    "always: after every step. "
    "The motion is the same to the last bit. What Python threads of one's own see meanwhile may be as old as the last such moment.")
CD_ATTRIBUTE(int, threads, 0, within(0, 1024),
    "Threads that share the work of a step [1]; 0: as many as YADE has (-j, OMP_NUM_THREADS). The motion is the same to the last bit with "
    "any number. Only steps with thousands of bodies and contacts use more than one.")
CD_ATTRIBUTE(int, iterations, 0, result,
    "Sweeps, and factorizations of Newton's method, made in the last step: the largest number on one of its *islands* [1].")
CD_ATTRIBUTE(double, residual, 0, result,
    "Error of the last step [1]: ||p - P_K(p - (u + mu |u_t| n)/W_nn)||/||p||, 2-norms over all contacts; p impulses, u relative velocities "
    "after the step plus gap/dt, W_nn each contact's inverse effective mass in the normal direction [1/kg], P_K the projection on Coulomb's cone.")
CD_ATTRIBUTE(double, residualMax, 0, result, "The same for the worst contact, over the root mean square of p [1].")
CD_ATTRIBUTE(double, bodyError, 0, result,
    "Estimated largest error of a body's velocity change in the last step, relative to what acts on the body: the impulses of its contacts "
    "and the external one [1]. In packings, where some disks always carry hardly any load, it is relative to a mean over the island, "
    "weighted by mass (cd_engine/core/error/residual.hpp has the formula).")
CD_ATTRIBUTE(int, worstBody, -1, result, "Id of the body whose velocity may have the largest error; -1: none.")
CD_ATTRIBUTE(bool, inSpace, false, result,
    "Whether the scene is solved in space. It is if a body can leave every plane (state.blockedDOFs), from the first step with such a body on; else the "
    "scene is solved in the plane, in which its bodies are kept, which costs less than half.");
CD_ATTRIBUTE(std::vector<int>, unsolvableContact, {}, result,
    "Ids of the two bodies whose contact is the strongest sign that there is no solution, if *status* is no_solution or a doubt remains. "
    "Example of "
    "such a step: a disk between two walls that move towards each other.")
CD_ATTRIBUTE(bool, converged, false, result,
    "Whether the last step is solved: the contact law holds to *stepTolerance*, relative to all impulses (*residual*), and the "
    "estimated error of every body's velocity change is at most that, relative to what acts on the body (*bodyError*). The true error may be "
    "many times larger (cd_engine/README.md).")
CD_ATTRIBUTE(double, stepTolerance, 0, result, "The tolerance of the last step: *tolerance*, *flowTolerance*, or one between them [1].")
CD_ATTRIBUTE(std::string, status, "no step yet", result,
    "How the last step's solution ended: converged, fixed_iterations, max_iterations, stagnated, no_solution (*unsolvableContact*) or "
    "diverged.")
CD_ATTRIBUTE(std::string, solvedBy, "none", result, "The method that brought the last step to its tolerance, or none.")
CD_ATTRIBUTE(int, contacts, 0, result, "Contacts the solver was given in the last step [1].")
CD_ATTRIBUTE(int, unknowns, 0, result,
    "Unknown velocities in the last step: three for a free disk, none for a fixed body, nor with *reduce* for a body without contacts [1].")
CD_ATTRIBUTE(int, islands, 0, result, "Islands of contacts solved apart; 1 for all contacts if they were not parted [1].")
CD_ATTRIBUTE(int, resting, 0, result,
    "Islands whose first guess, the forces of the step before, was within the tolerance already, so that no sweep was made [1].")
CD_ATTRIBUTE(int, sleeping, 0, result,
    "Of the islands counted in *resting*: those that were proven to be at rest, to a thousandth of *tolerance*, and have not changed since. Their "
    "velocities are zero, and the engine only checks whether their bodies have changed [1].")
CD_ATTRIBUTE(std::string, woken, {}, result, "Why islands were woken last: the step, what had changed, and the body.")
CD_ATTRIBUTE(std::vector<int>, loadsBeforeTrial, {}, internal,
    "In the step before a trial of rest: fingerprints of the loads of all bodies. What has another load then is not tried [1].")
CD_ATTRIBUTE(long, restTrialAt, 0, internal,
    "Value of *steps* from which the next trial of rest is due: the engine then solves slow islands to a thousandth of *tolerance*, and those that "
    "this shows to be at rest are stopped and sleep [1].")
CD_ATTRIBUTE(bool, unbounded, false, internal,
    "Whether the last step had no solution, or was not solved after a step without one: its impulses may have grown without end.")
CD_ATTRIBUTE(bool, rested, false, internal,
    "Whether the last step solved its one large island without a sweep; this decides in which order impulses are added, and so last digits.")
CD_ATTRIBUTE(double, unrest, 0, internal,
    "Energy dissipated in the last step over the sum of W_nn |p|^2 of its contacts, or 0.9 times the value of the step before if that is larger: "
    "decides between *tolerance* and *flowTolerance* [1].")
CD_ATTRIBUTE(int, restTrialPause, 16, internal, "Steps from one trial of rest to the next, 16 to 2048: twice as many after each that fails [1].")
CD_ATTRIBUTE(int, loadedContacts, 0, result, "Contacts that carry a force [1].")
CD_ATTRIBUTE(int, slidingContacts, 0, result, "Loaded contacts with friction whose tangential force is at the Coulomb limit [1].")
CD_ATTRIBUTE(double, maxPenetration, 0, result, "Largest overlap beyond the reference one met in the last step [m].")
CD_ATTRIBUTE(double, deepestPenetration, 0, result,
    "Largest *maxPenetration* of all steps [m]. Beyond a hundredth of the smallest radius the engine warns, once: if forces are far "
    "too small, bodies pass into each other, even though *residual* may be within the tolerance.")
CD_ATTRIBUTE(double, largestResidual, 0, result, "Largest *residual* of all steps [1].")
CD_ATTRIBUTE(double, handoverOverlap, 0, result,
    "Largest overlap taken as reference at the hand-over [m]; above 0 also if there was none, 0 if nothing has been taken over.")
CD_ATTRIBUTE(double, dissipatedEnergy, 0, result,
    "Energy lost in friction and impacts since the engine was made [J]. With O.trackEnergy it also goes into O.energy['plastDissip'], beside "
    "'kinetic' and 'gravWork'.")
CD_ATTRIBUTE(double, storedEnergy, 0, result,
    "Energy of the springs of contacts with a stiffness after the last step [J]; with O.trackEnergy also O.energy['elastPotential'].")
CD_ATTRIBUTE(double, dashpotEnergy, 0, result,
    "Energy lost in their dashpots (*dampingRatio*) since the engine was made [J]; also O.energy['viscDissip'].")
CD_ATTRIBUTE(double, dampedEnergy, 0, result,
    "Energy lost in the time step since the engine was made [J]: backward Euler damps contacts with a stiffness, a contact of frequency omega by the "
    "factor 1/sqrt(1 + (omega O.dt)^2) a step. Also O.energy['numDissip'].")
CD_ATTRIBUTE(long, steps, 0, result, "Steps made [1].")
CD_ATTRIBUTE(long, unconvergedSteps, 0, result, "Steps that missed their tolerance [1]; steps under *fixedIterations* are not counted.")
CD_ATTRIBUTE(long, totalIterations, 0, result, "Sweeps and factorizations made in all steps [1].")
CD_ATTRIBUTE(double, solveTime, 0, result,
    "Time spent in the solver [s]; what O.timingEnabled shows beyond it went into geometry, reading and writing the scene.")
CD_ATTRIBUTE(std::vector<int>, referenceIds, {}, internal, "Ids of the pairs that keep a reference overlap, two a pair.")
CD_ATTRIBUTE(std::vector<double>, referenceOverlaps, {}, internal,
    "The reference overlaps of these pairs [m]. A pair forgets its overlap once its bodies are apart.")
CD_ATTRIBUTE(std::vector<int>, bodyOrder, {}, internal,
    "In scenes of more than 2048 bodies: the place of every body along a curve through space (Hilbert's), by which contacts are ordered in "
    "memory. Renewed where the bodies have moved far apart along it, and saved, so that a run goes on as if it had not been saved.")
CD_ATTRIBUTE(double, bodyOrderLength, 0, internal, "Length of the way through the disks in that order, when it was made [m].")
