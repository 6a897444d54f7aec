"""The scene in O as bytes, by YADE's own O.save and O.load in its binary form.

They use a file in memory, since O.save never returns if the disk is full.
"""
import os

from yade import O


def take():
    """Return what O.save writes, uncompressed."""
    with _memory() as file:
        O.save(_path(file))
        file.seek(0)
        return file.read()


def restore(scene):
    """Load a scene that `take` returned."""
    with _memory() as file:
        file.write(scene)
        file.flush()
        O.load(_path(file))


def _memory():
    return os.fdopen(os.memfd_create("scene"), "w+b")


def _path(file):
    return f"/proc/self/fd/{file.fileno()}"
