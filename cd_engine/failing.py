"""Ends a run from within one of its steps, and raises the reason where a caller waits for the run.

A PyRunner holds a string; an exception or sys.exit in it ends or hangs YADE's process. So code that a run calls gives its exception to `fail`.
"""
import contextlib
import sys

_failure, _awaited = None, False  # what has ended a run and was not raised yet; whether `awaited` will raise it


def fail(error, words):
    """End the run when its step is over, because of this exception. words: what is printed if nobody waits for the run."""
    global _failure
    _failure = error
    if not _awaited:  # O.run() at the console
        print(words, file=sys.stderr, flush=True)
    stop()


def stop():
    """End the run when its step is over.

    O.pause() would let O.run(n, True) return while the step is still running. A following O.reset() would then wait for the step, and the step
    for Python, for ever.
    """
    from yade import O
    O.stopAtIter = O.iter + 1


@contextlib.contextmanager
def awaited():
    """Raise at the end what has failed in the run for which the caller waits, also before the wait began."""
    global _failure, _awaited
    _awaited = True
    try:
        yield
    finally:
        _awaited = False
        failure, _failure = _failure, None
    if failure:
        raise failure


def begin():
    """Forget what has ended an earlier run: another one begins."""
    global _failure
    _failure = None
