"""File locks that the kernel releases when the process that holds them ends, even by kill -9. Needs no YADE.

All locks of a folder are bytes of one file in it, `.locks`; the hash of a name gives the position of its byte. They are POSIX record locks, which
also work on a network file system and need no cleaning up.
"""
import contextlib
import fcntl
import hashlib
import pathlib

FILE = ".locks"


def _byte(path):
    """Return the position of the lock of `path` in the file. It has 62 bits, so no two names of a real folder share it in practice."""
    return int.from_bytes(hashlib.sha256(path.name.encode()).digest()[:8], "big") >> 2


@contextlib.contextmanager
def held(path, waiting=lambda: None):
    """Hold the lock of a file, which need not exist; its folder must. If another process holds it, call waiting() and wait.

    A process may hold only one lock of a folder at a time: closing the file releases all of them.
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
    def give_up():
        raise BlockingIOError
    try:
        with held(path, give_up):
            return False
    except BlockingIOError:
        return True
