"""What the engines do in Python: functions of ContactDynamics, installed once its class is there, and the refusal of misspelt names."""
import difflib
import sys
import threading
import traceback

from .summary import text


def install(engine):
    """Give the class its functions."""
    engine.summary, engine.exportProblem = summary, exportProblem


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
    if _runs_besides():
        raise RuntimeError("ContactDynamics.exportProblem: a run goes on and changes the scene meanwhile. Call O.pause() first, or export from an "
                           "engine of the run (PyRunner)")
    from ._yade_plugin import next_problem
    from .core import export
    (export.write_bodies if bodies else export.write_step)(path, *next_problem(self, bodies))


def _runs_besides():
    """Return whether a run in the background changes the scene meanwhile. Code that an engine of the run calls (PyRunner) blocks the run, so it is
    safe: it runs in a thread of YADE's own. Python's threading module knows this thread only as a dummy, and Python code begins there with a
    command; in a thread made by _thread it begins with a function."""
    from yade import O
    *_, (first, _) = traceback.walk_stack(sys._getframe())
    return O.running and not (isinstance(threading.current_thread(), threading._DummyThread) and first.f_code.co_name == "<module>")


def check_name(engine, name):
    """Raise AttributeError, with the names that are near, for a name that is no attribute of this class of engines. The plug-in calls it."""
    if hasattr(engine, name):
        return
    near = difflib.get_close_matches(name, [known for known in dir(engine) if not known.startswith("_")])
    friction = "Friction is that of the bodies' materials: FrictMat(frictionAngle=...)."
    remedy = {"damping": "Rigid contacts have no damping; see restitution.", "dt": "The time step is O.dt; cd_engine.timeStep() proposes one.",
              "friction": friction, "mu": friction, "frictionAngle": friction}.get(name, f"Did you mean {' or '.join(near)}?" if near else "")
    raise AttributeError(f"{engine.__name__} has no attribute {name!r}. {remedy or f'help(cd_engine.{engine.__name__}) lists them.'}")
