"""Calls a function on a file that may be damaged, in a process of its own, so that a crash there does not end this one.

libhdf5 trusts what it reads: on some damaged files it loops for ever or crashes, and neither can be caught in the same process.
"""
import faulthandler
import multiprocessing
import os
import resource
import signal

SECONDS, PER_MEGABYTE = 2, 1  # s of processor time; an undamaged file takes 1 ms


def call(function, path):
    """Return function(path), computed in a process of its own. Raise its ValueError here, and one if the process crashes or takes too long."""
    allowed = SECONDS + PER_MEGABYTE * (os.path.getsize(path) >> 20)
    here, there = multiprocessing.Pipe(duplex=False)
    child = os.fork()  # multiprocessing.Process cannot be started in a worker of a multiprocessing.Pool
    if child == 0:
        try:
            _answer(function, path, there, allowed)
        finally:
            os._exit(1)
    there.close()
    answer = None
    try:
        with here:
            answer = here.recv()
    except (EOFError, OSError):  # the process has ended without a whole answer
        pass
    finally:
        status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    if answer is None:
        what = "did not finish reading it" if status == -signal.SIGXCPU else f"fails on it (status {status})"
        raise ValueError(f"{path}: damaged, libhdf5 {what}")
    value, error = answer
    if error is not None:
        raise ValueError(error)
    return value


def _answer(function, path, there, seconds):
    """Send function(path), or the message of its error, through the pipe."""
    faulthandler.disable()
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)  # hides the libraries' own messages; the caller reports in one sentence
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))
    signal.signal(signal.SIGXCPU, signal.SIG_DFL)
    try:
        there.send((function(path), None))
    except (ValueError, MemoryError) as error:
        there.send((None, str(error) or f"{path}: asks for more memory than there is"))
