"""What the engines' classes get in Python, once they are there: functions of ContactDynamics, and constructors that refuse unknown names."""
import difflib
import threading


def summary(self):
    """Print how the engine is set and how its steps went, on one screen."""
    print(text(self))


def exportProblem(self, path, bodies=False):
    """Write the contact problem that the next step would solve to *path*.

    The format is FCLIB (HDF5) or, with *bodies*, a BodyProblem as .npz, in the order of the sweeps and with the first guess; for
    :py:func:`cd_engine.core.read_problem` and for other codes. The ids of the bodies of each contact are in its data set contact_ids. Nothing in
    the scene changes. External forces are gravity and the permanent ones (O.forces.setPermF); what engines add in the course of a step is not
    known before it, and is left out.
    """
    from yade import O
    # An engine of the run that calls this (PyRunner) blocks the run, so it is safe: its thread is one of YADE's own, for Python a dummy.
    if O.running and not isinstance(threading.current_thread(), threading._DummyThread):
        raise RuntimeError("ContactDynamics.exportProblem: a run goes on and changes the scene meanwhile. Call O.pause() first, or export from an "
                           "engine of the run (PyRunner)")
    from ._yade_plugin import next_problem
    from .core import export
    (export.write_bodies if bodies else export.write_step)(path, *next_problem(self, bodies))


def text(engine):
    """Return lines about the settings, the last step and all steps of an engine, as one text."""
    lines = [f"ContactDynamics: method {engine.method}, tolerance {engine.tolerance:g}, at most {engine.maxIterations} iterations a step, "
             f"restitution {engine.restitution:g}, gapCorrection {engine.gapCorrection:g} beyond {engine.allowedOverlap:g} radii, "
             f"gravity {tuple(engine.gravity)} m/s^2" + (f", exactly {engine.fixedIterations} sweeps" if engine.fixedIterations else "")]
    if not engine.steps:
        return "\n".join(lines + ["No step yet."])
    lines.append(f"Last step: {engine.status} after {engine.iterations} iterations (solved by {engine.solvedBy}); "
                 f"error of the contacts {engine.residual:.2g}, of the bodies {engine.bodyError:.2g}")
    if engine.unsolvableContact:
        lines.append(f"  no velocities keep bodies #{engine.unsolvableContact[0]} and #{engine.unsolvableContact[1]} apart")
    elif engine.worstBody >= 0 and not engine.converged:
        lines.append(f"  the velocity of body #{engine.worstBody} may be the most wrong")
    lines += [
        f"  {engine.contacts} contacts, {engine.loadedContacts} loaded, {engine.slidingContacts} sliding; "
        f"{engine.islands} islands, {engine.sleeping} asleep; overlap at most {engine.maxPenetration:.2g} m",
        f"All {engine.steps} steps: {engine.unconvergedSteps} missed the tolerance; {engine.totalIterations / engine.steps:.3g} iterations and "
        f"{1e3 * engine.solveTime / engine.steps:.3g} ms in the solver a step; overlap at most {engine.deepestPenetration:.2g} m; "
        f"{engine.dissipatedEnergy:.3g} J lost in friction and impacts"]
    if engine.woken:
        lines.append(f"Woken last in {engine.woken}")
    if engine.handoverOverlap > 1e-12:  # else round-off
        lines.append(f"Overlaps of up to {engine.handoverOverlap:.2g} m were there at the start and count as touching")
    return "\n".join(lines)


def refuse_unknown_names(engine):
    """Have the constructor of an engine suggest names that are near an unknown one; YADE says only that there is no such attribute."""
    made = engine.__init__

    def __init__(self, *arguments, **settings):
        for name in settings:
            if not hasattr(engine, name):
                raise AttributeError(f"{engine.__name__} has no attribute {name!r}. {_remedy(engine, name)}")
        made(self, *arguments, **settings)

    engine.__init__ = __init__


def _remedy(engine, name):
    friction = "Friction is that of the bodies' materials: FrictMat(frictionAngle=...)."
    known = {"damping": "Rigid contacts have no damping; see restitution.", "dt": "The time step is O.dt; cd_engine.timeStep() proposes one.",
             "friction": friction, "mu": friction, "frictionAngle": friction}
    near = difflib.get_close_matches(name, [attribute for attribute in dir(engine) if not attribute.startswith("_")])
    return known.get(name) or (f"Did you mean {' or '.join(near)}?" if near else f"help(cd_engine.{engine.__name__}) lists them.")
