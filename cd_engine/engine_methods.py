"""Functions of ContactDynamics that are written in Python; installed once its class is there."""
import threading

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
    safe: it runs in a thread of YADE's own, which Python's threading module knows only as a dummy."""
    from yade import O
    return O.running and not isinstance(threading.current_thread(), threading._DummyThread)
