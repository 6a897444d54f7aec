"""Calls a function on a file that may be damaged, in a process of its own, so that a crash there does not end this one.

libhdf5 trusts what it reads: on some damaged files it loops for ever or crashes, and neither can be caught in the same process.
"""
import faulthandler
import os
import pickle
import resource
import signal

SECONDS, PER_MEGABYTE = 2, 1  # s of processor time; an undamaged file takes 1 ms


def call(function, path):
    """Return function(path), computed in a process of its own. Raise its ValueError here, and one if the process crashes or takes too long."""
    allowed = SECONDS + PER_MEGABYTE * (os.path.getsize(path) >> 20)
    out, into = os.pipe()
    child = os.fork()
    if child == 0:
        _answer(function, path, into, allowed)
    os.close(into)
    try:
        with os.fdopen(out, "rb") as answer:
            message = answer.read()
    finally:
        ended = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    if ended == -signal.SIGXCPU:
        raise ValueError(f"{path}: damaged, libhdf5 did not finish reading it")
    if ended != 0:
        raise ValueError(f"{path}: damaged, libhdf5 fails on it (status {ended})")
    value, error = pickle.loads(message)
    if error is not None:
        raise ValueError(error)
    return value


def _answer(function, path, into, seconds):
    """Compute the answer in the child process, send it through the pipe `into`, and exit."""
    status = 1
    try:
        faulthandler.disable()
        os.dup2(os.open(os.devnull, os.O_WRONLY), 2)  # hides the libraries' own messages; the caller reports in one sentence
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))
        signal.signal(signal.SIGXCPU, signal.SIG_DFL)
        try:
            message = function(path), None
        except (ValueError, MemoryError) as error:
            message = None, str(error) or f"{path}: asks for more memory than there is"
        with os.fdopen(into, "wb") as answer:
            pickle.dump(message, answer, pickle.HIGHEST_PROTOCOL)
        status = 0
    finally:
        os._exit(status)
