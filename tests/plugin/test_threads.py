"""Threads share the work of a step: the motion has the same bits with any number of them, and none is started without need."""
import pathlib

import numpy as np
import pytest
import yade
from yade import utils

import cd_engine
from cd_engine import core

from . import plane, programs

SIDE = 62        # disks in a row and a column: more contacts than one block of a sweep may have
COUNTS = 1, 2, 3, 16
RADIUS = 0.05


def helpers():
    """Return the number of the engine's threads besides those that call it."""
    names = []
    for task in pathlib.Path("/proc/self/task").iterdir():
        try:
            names.append((task / "comm").read_text().strip())
        except (FileNotFoundError, ProcessLookupError):  # the thread has ended before the file was opened, or before it was read
            pass
    return names.count("cd_engine")


def crystal(lid=False, speed=0.0, side=SIDE, **settings):
    """Disks row by row on a floor between two walls, each in a hollow of those below; `lid`: under a free wall that gravity presses on them.

    Settings are those of the engine.
    """
    material = plane.material(0.3)
    width, row = (2 * side + 1) * RADIUS, 3**0.5 * RADIUS
    for axis, place in ((1, 0), (0, 0), (0, width)):
        yade.O.bodies.append(utils.wall(place, axis=axis, material=material))
    for k in range(side * side):
        x, y = k % side, k // side
        plane.disk(((2 * x + 1 + y % 2) * RADIUS, RADIUS + y * row), RADIUS, mass=5 + k % 3, mat=material)
        yade.O.bodies[-1].state.vel = (speed * (k % 7 - 3), speed * (k % 5 - 2), 0)
    if lid:
        wall = yade.O.bodies[yade.O.bodies.append(utils.wall((side - 1) * row + 2 * RADIUS, axis=1, material=material))]
        wall.state.mass, wall.state.blockedDOFs = 500, "xzXYZ"
        press(wall)
    yade.O.dt = 1e-3
    yade.O.engines = cd_engine.engines(gravity=(0, -9.81, 0), **settings)


def press(lid):
    """Press the lid on the disks by a permanent force, which YADE saves in no scene."""
    yade.O.forces.setPermF(lid.id, (0, -5e3, 0))


SCENES = {
    "packing": (dict(), dict(tolerance=1e-4)),
    "free wall, as a whole": (dict(lid=True), dict(tolerance=1e-3, reduce=False)),
    "flow": (dict(speed=0.05, side=90), dict(tolerance=1e-2, restitution=0.6)),
    "flow, as a whole": (dict(speed=0.05, side=90), dict(tolerance=1e-2, restitution=0.6, reduce=False)),
    "plain sweeps": (dict(lid=True, speed=0.02), dict(tolerance=1e-2, method="nsgs", maxIterations=60)),
    "sweeps with momentum": (dict(lid=True, speed=0.02), dict(tolerance=1e-2, method="accelerated", maxIterations=60)),
    "springs": (dict(lid=True, speed=0.02), dict(stiffness=1e7, tangentialStiffness=5e6, dampingRatio=0.1)),
    "Newton's method": (dict(speed=0.02), dict(tolerance=1e-6, method="newton", maxIterations=12)),
}


@pytest.mark.parametrize("name", SCENES)
def test_every_number_of_threads_gives_the_same_bits(O, name):
    scene, settings = SCENES[name]
    digests, most = {}, 0
    crystal(**scene)
    O.saveTmp()
    for threads in COUNTS:
        O.loadTmp()  # faster than to build it
        if "lid" in scene:
            press(O.bodies[-1])
        O.engines = cd_engine.engines(gravity=(0, -9.81, 0), threads=threads, **settings)
        O.run(2, True)
        most = max(most, O.engines[-1].contacts)
        if settings.get("method") != "newton":
            O.run(5, True)
        digests[threads] = plane.digest()
        assert helpers() == threads - 1  # those of the engine before have ended
    assert most > 9000  # 8192 make more than one block
    assert set(digests.values()) == {digests[1]}


def test_a_small_scene_starts_no_thread_and_one_thread_ends_the_others(O):
    crystal(lid=True, side=20, threads=16)
    O.run(3, True)
    assert helpers() == 0
    O.reset()
    crystal(threads=4, tolerance=1e-2)
    O.run(2, True)
    assert helpers() == 3
    O.engines[-1].threads = 1
    O.run(1, True)
    assert helpers() == 0


def test_none_given_takes_as_many_as_yade_has():
    """In a process of its own, which ends with the threads there."""
    done = programs.in_python("import yade\nfrom tests.plugin import test_threads as t\n"
                              "t.crystal(tolerance=1e-2)\nyade.O.run(2, True)\nprint(t.helpers())", OMP_NUM_THREADS="3", OMP_WAIT_POLICY="passive")
    assert done.returncode == 0 and done.stdout.split()[-1:] == ["2"], done.stdout + done.stderr


def test_solve_without_yade_by_several_threads(O, tmp_path):
    crystal(lid=True, tolerance=1e-2)
    O.run(2, True)
    O.engines[-1].exportProblem(str(tmp_path / "problem.npz"), bodies=True)
    problem = core.read_problem(str(tmp_path / "problem.npz"))
    first, *others = (core.solve(problem, tolerance=1e-4, threads=threads) for threads in COUNTS)
    for other in others:
        assert np.array_equal(first.impulses, other.impulses) and (first.iterations, first.residual) == (other.iterations, other.residual)
    for number in (0, 1025, 1.5):
        with pytest.raises(ValueError, match="threads"):
            core.solve(problem, threads=number)


def test_a_process_that_is_forked_off_goes_on_alone():
    """The child has none of the helper threads; it drops what belongs to them and starts others. The parent keeps its own."""
    program = """
import os
from yade import O
from tests.plugin import test_threads as t

def steps(side, threads):
    O.reset()
    t.crystal(side=side, tolerance=1e-2, threads=threads)
    O.run(3, True)
    return t.plane.digest()

wanted = steps(t.SIDE, 3)
assert t.helpers() == 2
for side, threads in ((t.SIDE, 3), (t.SIDE, 1), (5, 3)):
    child = os.fork()
    if child == 0:
        os._exit(0 if steps(side, threads) == wanted or side == 5 else 1)
    assert os.waitpid(child, 0)[1] == 0, (side, threads)
assert steps(t.SIDE, 3) == wanted
print("forked", flush=True)
os._exit(0)
"""
    done = programs.in_python(program)
    assert "forked" in done.stdout, done.stderr[-2000:]
