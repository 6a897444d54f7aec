"""Disks in a box whose gravity turns, so that contacts come and go without end."""
import math
import random
import sys

import yade

import cd_engine
from yade_scripts.running import hooks

from . import plane

TURN = 2.0   # s, one turn of gravity: the disks fall across the box (0.4 s) before it has turned by a right angle
CHUNK = 50   # steps between two directions of gravity


def build(disks):
    """A square box half full of disks of unequal size, with the engines that tumble it; ContactDynamics."""
    draw, columns = random.Random(1), math.ceil(math.sqrt(2 * disks))
    material = plane.material(0.4)
    for axis in (0, 1):
        for place in (0, 0.11 * columns):
            yade.O.bodies.append(yade.utils.wall(place, axis=axis, material=material))
    for k in range(disks):
        plane.disk((0.11 * (k % columns + 0.5), 0.11 * (k // columns + 0.5)), draw.uniform(0.04, 0.05), mass=draw.uniform(5, 8), mat=material)
    reset, collider, engine = cd_engine.engines(gravity=(0, -9.81, 0), tolerance=1e-4)

    def turn():
        angle = 2 * math.pi * yade.O.time / TURN
        engine.gravity = (9.81 * math.sin(angle), -9.81 * math.cos(angle), 0)

    yade.O.engines = [reset, collider, hooks.runner(turn, iterPeriod=CHUNK), engine]
    yade.O.dt = 1e-3
    return engine


def enlarge_table_of_names():
    """Make Python's table of interned strings as large as it will ever be.

    YADE compiles a PyRunner's command whenever it runs; each time takes places in the table, which is copied to one twice as large (1.9 MB)
    after some thousands of them, no matter what the command is.
    """
    names = [sys.intern(f"name {k}") for k in range(100000)]
    del names  # the table keeps its size
