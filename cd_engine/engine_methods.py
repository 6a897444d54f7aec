"""What the engines do in Python: functions of their classes, installed once these are there, and the refusal of misspelt names."""
import difflib
import math
import numbers
import sys
import threading
import traceback


def summary(self):
    """Print how the engine is set and how its steps went, on one screen."""
    print(text(self))


def exportProblem(self, path, bodies=False):
    """Write the contact problem that the next step would solve to *path*.

    The format is FCLIB (HDF5) or, with *bodies*, a BodyProblem, in space a SpaceBodyProblem, as .npz, in the order of the sweeps and with the
    first guess; for :py:func:`cd_engine.core.read_problem` and for other codes. The ids of the bodies of each contact are in FCLIB's data set
    contact_ids. Nothing in the scene changes. External forces are gravity and the permanent ones (O.forces.setPermF); what engines add in the
    course of a step is not known before it, and is left out. ValueError if the name ends like one of the other format.
    """
    if str(path).lower().endswith((".hdf5", ".h5") if bodies else ".npz"):
        content = "bodies (.npz)" if bodies else "matrices (FCLIB, HDF5)"
        raise ValueError(f"ContactDynamics.exportProblem: {path} would hold {content}. Give it another ending, or bodies={not bodies}")
    if runs_besides():
        raise RuntimeError("ContactDynamics.exportProblem: a run goes on and changes the scene meanwhile. Call O.pause() first, or export from an "
                           "engine of the run (PyRunner)")
    from ._yade_plugin import next_problem
    from .core.files import export
    export.write_step(path, bodies, *next_problem(self))


def text(engine):
    """Return lines about the settings, the last step and all steps of an engine, as one text."""
    flow = f" (in flows {engine.flowTolerance:g})" if engine.flowTolerance > engine.tolerance else ""
    sweeps = f", exactly {engine.fixedIterations} sweeps" if engine.fixedIterations else ""
    springs = f", stiffness {engine.stiffness:g} and tangential {engine.tangentialStiffness:g} N/m" if engine.stiffness < math.inf else \
        ", stiffnesses of the materials" if engine.materialStiffness else ""
    space = " in space" if engine.inSpace else ""
    lines = [f"ContactDynamics{space}: method {engine.method}, tolerance {engine.tolerance:g}{flow}, at most {engine.maxIterations} iterations "
             f"a step, restitution {engine.restitution:g}, gapCorrection {engine.gapCorrection:g} beyond {engine.allowedOverlap:g} radii, "
             f"gravity {tuple(engine.gravity)} m/s^2{sweeps}{springs}"]
    if not engine.steps:
        return "\n".join(lines + ["No step yet."])
    by = engine.solvedBy if engine.iterations else "the forces of the step before"
    lines.append(f"Last step: {engine.status} after {engine.iterations} iterations (solved by {by}), tolerance {engine.stepTolerance:g}; "
                 f"error of the contacts {engine.residual:.2g}, of the bodies {engine.bodyError:.2g}")
    if engine.unsolvableContact:
        first, second = engine.unsolvableContact
        lines.append(f"  bodies #{first} and #{second} are squeezed or wedged, and no solution was found" if engine.status == "no_solution" else
                     f"  there may be no solution; the strongest sign of this is the contact of bodies #{first} and #{second}")
    elif engine.worstBody >= 0 and not engine.converged:
        lines.append(f"  body #{engine.worstBody} may have the largest error of its velocity")
    missed = "no tolerance is asked for" if engine.fixedIterations else f"{engine.unconvergedSteps} missed the tolerance"
    lines += [
        f"  {engine.contacts} contacts, {engine.loadedContacts} loaded, {engine.slidingContacts} sliding; "
        f"{engine.islands} islands, {engine.sleeping} asleep; overlap at most {engine.maxPenetration:.2g} m",
        f"All {engine.steps} steps: {missed}; {engine.totalIterations / engine.steps:.3g} iterations and "
        f"{1e3 * engine.solveTime / engine.steps:.3g} ms in the solver a step; overlap at most {engine.deepestPenetration:.2g} m; "
        f"{engine.dissipatedEnergy:.3g} J lost in friction and impacts"]
    if engine.woken:
        lines.append(f"Woken last in {engine.woken}")
    if engine.handoverOverlap > 1e-12:  # else round-off
        lines.append(f"Overlaps of up to {engine.handoverOverlap:.2g} m were there at the start and count as touching")
    return "\n".join(lines)


def in_a_run():
    """Return whether an engine of a run (PyRunner) calls this code, in a thread of YADE's own. Python's threading module knows this thread only as a
    dummy, and Python code begins there with a command; in a thread made by _thread it begins with a function."""
    *_, (first, _) = traceback.walk_stack(sys._getframe())
    return isinstance(threading.current_thread(), threading._DummyThread) and first.f_code.co_name == "<module>"


def is_number(value):
    """Return whether a value is a finite number."""
    return isinstance(value, numbers.Real) and math.isfinite(value)


def slaves(engines):
    """Return the engines that stand inside the live ParallelEngines of a list."""
    parallel = [engine for engine in engines if type(engine).__name__ == "ParallelEngine" and not engine.dead]
    return [inside for engine in parallel for row in engine.slaves for inside in (row if isinstance(row, (list, tuple)) else [row])]


def gravity(engines):
    """Return the gravity of the first live engine that has one; None without any."""
    return next((engine.gravity for engine in engines if hasattr(engine, "gravity") and not engine.dead), None)


def runs_besides():
    """Return whether a run in the background changes the scene meanwhile. Code that an engine of the run calls blocks the run, so it is safe."""
    from yade import O
    return O.running and not in_a_run()


def complete(engine):
    """Let a class of the plug-in's engines list its attributes in its documentation, refuse misspelt names, and make copies that have the settings
    and made no step."""
    own = {name: value for name, value in vars(engine).items() if isinstance(value, property) and not name.startswith("_")}
    settings, results = [name for name in own if own[name].fset], [name for name in own if not own[name].fset]

    def set_attribute(self, name, value):
        if type(self) is engine:  # a class derived in Python may have attributes of its own
            check_name(engine, name)  # Python would keep a misspelt name as an attribute that nothing reads
        object.__setattr__(self, name, value)

    def set_state(self, state):
        self.updateAttrs({name: value for name, value in state.items() if name not in results})

    engine.__doc__ += f"\n\nTo set: {', '.join(settings)}" + (f"\n\nTo read after a step: {', '.join(results)}" if results else "")
    engine.__setattr__, engine.__setstate__ = set_attribute, set_state


def check_name(engine, name):
    """Raise AttributeError for a result, and for a name that this class of engines lacks, with the nearest name. The plug-in calls this before
    an attribute is set."""
    present, result = getattr(engine, name, None), lambda known: isinstance(known, property) and not known.fset
    if result(present):
        limit = ". The most iterations of a step are `maxIterations`" if name == "iterations" else ""
        raise AttributeError(f"{engine.__name__}.{name} is a result and cannot be set{limit}")
    if hasattr(engine, name):
        return
    friction = "Friction is that of the bodies' materials: FrictMat(frictionAngle=...)."
    bounce = "The share of the speed that an impact gives back is `restitution`."
    stiffness = "The stiffness of contacts is `stiffness`, `tangentialStiffness` or `materialStiffness`."
    rigid = {"damping": "Rigid contacts have no damping; see restitution, and with a stiffness dampingRatio.",
             "es": bounce, "coefficientOfRestitution": bounce,
             "kn": stiffness, "ks": stiffness, "dt": "The time step is O.dt; cd_engine.timeStep() proposes one.",
             "friction": friction, "mu": friction, "frictionAngle": friction}
    meant = {"tol": "tolerance", "solver": "method", "numThreads": "threads", "nThreads": "threads"}
    settings = [known for known in dir(engine) if not known.startswith("_") and known != "ompThreads" and not result(getattr(engine, known))]
    near = [meant[name]] if meant.get(name) in settings else difflib.get_close_matches(name, settings, n=1)
    remedy = rigid.get(name) if "restitution" in settings else None
    remedy = remedy or (f"Did you mean {near[0]}?" if near else None)
    raise AttributeError(f"{engine.__name__} has no attribute {name!r}. {remedy or f'help(cd_engine.{engine.__name__}) lists them.'}")
