"""HDF5 files that end with the SHA-256 of everything before it. HDF5 ignores what follows its content, so any program can open them.

A file is written under a temporary name and then renamed: after a crash either the old or the new file exists, and it is complete.
"""
import hashlib
import io
import os
import pathlib

import h5py

MARK = b"\nsha256:"
HDF5 = b"\x89HDF\r\n\x1a\n\0"  # how a file begins that h5py writes; LENGTH then holds the length of its content
LENGTH = slice(40, 48)


class Damaged(ValueError):
    """The content of a file has changed since it was written. The message states what is wrong."""


class Unreadable(Damaged):
    """The file may be good, but the system does not let it be read."""


class Foreign(Damaged):
    """The file does not say that it is of the expected kind: it never was, or it is damaged where it says so."""


def write(path, content):
    """Write the bytes of an HDF5 file to `path`, with the checksum appended."""
    replace(path, content + _seal(content))


def replace(path, content):
    """Write bytes to a temporary file beside `path`, flush it to the disk, then rename it to `path`."""
    path = pathlib.Path(path)
    new = path.with_name(f"{path.name}.{os.getpid()}.new")
    try:
        with open(new, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        os.replace(new, path)
    except BaseException as error:
        new.unlink(missing_ok=True)
        if isinstance(error, OSError) and error.filename is None:
            error.filename = str(path)
        raise
    folder = os.open(path.parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)


def open_checked(path, mark=b""):
    """Return the file opened for reading. Raise Damaged unless its checksum matches its content, Foreign if it does not hold the bytes `mark`."""
    path = pathlib.Path(path)
    try:
        if path.is_dir():
            raise Unreadable("is a folder (give the files in it, such as results/*.h5)")
        if path.exists() and not path.is_file():  # such as a pipe, which would never open
            raise Unreadable("cannot be read (not a regular file, move it away)")
        content = path.read_bytes()
    except OSError as error:
        raise Unreadable(f"cannot be read ({error.strerror})") from None
    cut_off = content.startswith(HDF5) and len(content) < int.from_bytes(content[LENGTH], "little")
    if mark not in content and not cut_off:  # before HDF5 sees it: libhdf5 may crash on a damaged file
        raise Foreign("is no result of this project; if it was one, it is damaged: make it again")
    length = len(_seal(b""))
    if content[-length:] != _seal(content[:-length]):
        raise Damaged("is damaged, or another program has changed it: its checksum is missing or does not match its content")
    try:
        return h5py.File(io.BytesIO(content[:-length]), "r")
    except OSError as error:
        raise Damaged(f"is no HDF5 file ({error})") from None


def _seal(content):
    return MARK + hashlib.sha256(content).hexdigest().encode() + b"\n"
