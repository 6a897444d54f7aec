"""Calls Python functions from inside YADE's loop, and passes their exceptions on to the caller.

An exception stops the loop and is raised again by `simulate`, so that a failed run can still write its file.
"""
import time

from yade import O
from yade.wrapper import PyRunner

from cd_engine import failing

# Labels of the engines that only record, check, sum energies, or measure known quantities. The other engines make the simulation.
SAMPLING, SUMMING, MEASURING, TIMING = OBSERVERS = "sampling", "summing", "measuring", "timing"

_functions = []
_observing = 0.0  # processor time [s] that samples and measurements have taken since the program started


def runner(function, **period):
    """Return a PyRunner that calls `function()`; period: iterPeriod, initRun, label and so on."""
    _functions.append(_apart(function) if period.get("label") in (SAMPLING, MEASURING) else function)
    return PyRunner(command=f"import yade_scripts.running.hooks; yade_scripts.running.hooks.fire({len(_functions) - 1})", updateGlobals=False,
                    **period)


def _apart(function):
    """Return a function that calls `function()` and leaves the time it takes out of `processor_time`."""
    def observe():
        global _observing
        begin = time.process_time()
        try:
            function()
        finally:
            _observing += time.process_time() - begin
    return observe


def processor_time():
    """Return the processor time [s] of this process, of all threads, without that of samples and measurements: a run that nobody observes
    would not spend it."""
    return time.process_time() - _observing


def engine(kind):
    """Return the first engine of the class `kind` in O; None if there is none."""
    return next((engine for engine in O.engines if type(engine).__name__ == kind), None)


def fire(number):
    try:
        _functions[number]()
    except Exception as error:
        failing.fail(error, f"Stopped at step {O.iter}: {error}")


def simulate(steps):
    """Make `steps` steps and wait for them. Raise the exception of a hook or an engine."""
    with failing.awaited():
        O.run(steps, True)
