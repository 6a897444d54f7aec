"""Calls Python functions from inside YADE's loop, and passes their exceptions on to the caller.

A PyRunner holds a string; an exception or sys.exit in it ends or hangs the process. Here an exception stops the loop and is raised
again by `simulate`, so that a failed run can still write its file.
"""
import sys
import time

from yade import O
from yade.wrapper import PyRunner

# Labels of the engines that only record, check, sum energies, or measure known quantities. The other engines make the simulation.
SAMPLING, SUMMING, MEASURING, TIMING = OBSERVERS = "sampling", "summing", "measuring", "timing"

_functions = []
_observing = 0.0  # processor time [s] that samples and measurements have taken since the program started
_failure = None
_awaited = False  # whether `simulate` will raise the failure


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
    global _failure
    try:
        _functions[number]()
    except Exception as error:
        _failure = error
        if not _awaited:  # O.run() at the console
            print(f"Stopped at step {O.iter}: {error}", file=sys.stderr, flush=True)
        stop()


def stop():
    """End the loop from within a step, when this step is over.

    O.pause() would let O.run(n, True) return while the step is still running. A following O.reset() would then wait for the step, and the step
    for Python, for ever.
    """
    O.stopAtIter = O.iter + 1


def simulate(steps):
    """Make `steps` steps and wait for them. Raise the exception of a hook or an engine."""
    global _failure, _awaited
    _failure, _awaited = None, True
    try:
        O.run(steps, True)
    finally:
        _awaited = False
    if _failure is not None:
        raise _failure
