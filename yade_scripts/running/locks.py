"""File locks that the kernel releases when the process that holds them ends, even by kill -9. Needs no YADE.

All locks of a folder are bytes of one file, `.locks` in it, the byte being the hash of what is locked. They are POSIX record locks, which
hold over a network file system, too; the kernel drops them with the process, kill -9 included, so nothing has to be cleaned up.
"""
import contextlib
import fcntl
import hashlib
import pathlib

FILE = ".locks"


def _byte(path):
    """Return where in the file the lock of `path` is: 62 bits, so that two names share a byte in none of any real folder."""
    return int.from_bytes(hashlib.sha256(path.name.encode()).digest()[:8], "big") >> 2


@contextlib.contextmanager
def held(path, waiting=lambda: None):
    """Hold the lock of a file that need not exist, in a folder that must; where another process holds it, wait, calling waiting() first.

    One lock a process and folder: closing the file lets go of all of them.
    """
    path = pathlib.Path(path)
    with open(path.parent / FILE, "ab") as file:
        try:
            fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, _byte(path))
        except BlockingIOError:
            waiting()
            fcntl.lockf(file, fcntl.LOCK_EX, 1, _byte(path))
        yield


def taken(path):
    """Tell whether another process holds the lock of a file."""
    path = pathlib.Path(path)
    if not (path.parent / FILE).exists():
        return False
    with open(path.parent / FILE, "ab") as file:
        try:
            fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, _byte(path))
        except BlockingIOError:
            return True
    return False
