"""Saves the scene in O to bytes and loads it again, by O.save and O.load in YADE's binary format.

The file is in memory, since O.save never returns if the disk is full.
"""
import contextlib
import os

from yade import O
from yade.wrapper import PyRunner


@contextlib.contextmanager
def _memory():
    """Give a file in memory, and the name by which YADE opens it."""
    with os.fdopen(os.memfd_create("scene"), "w+b") as file:
        yield file, f"/proc/self/fd/{file.fileno()}"


def take():
    """Return what O.save writes, uncompressed."""
    with _memory() as (file, name):
        O.save(name)
        file.seek(0)
        return file.read()


def restore(scene):
    """Load a scene that `take` returned. Its PyRunners get the commands of those in O: saved commands hold numbers of the process that saved them."""
    commands = [engine.command for engine in O.engines if isinstance(engine, PyRunner)]
    with _memory() as (file, name):
        file.write(scene)
        file.flush()
        O.load(name)
    for engine, command in zip((engine for engine in O.engines if isinstance(engine, PyRunner)), commands, strict=True):
        engine.command = command
