"""What Python may do while a run continues in the background."""
import _thread
import threading
import time

import pytest

from cd_engine import core
from yade_scripts.running.hooks import runner

from . import plane, programs
from .test_export_problem import ids


def columns(O):
    """Fifty columns of disks on a floor, a step of which takes a while; ContactDynamics."""
    plane.columns(*(0.03 * k for k in range(50)), disks=10)
    return plane.run(2, 1e-3, gravity=(0, -9.81, 0), tolerance=1e-10)


def in_a_thread(start, call):
    """Call it in a thread of its own, which `start` starts. Raise here what it raises there."""
    errors, ended = [], threading.Event()

    def thread():
        try:
            call()
        except Exception as error:
            errors.append(error)
        ended.set()

    start(thread)
    assert ended.wait(60)
    for error in errors:
        raise error


@pytest.mark.parametrize("calling", [lambda call: call(), lambda call: in_a_thread(lambda function: threading.Thread(target=function).start(), call),
                                     lambda call: in_a_thread(lambda function: _thread.start_new_thread(function, ()), call)],
                         ids=["main", "threading", "_thread"])
def test_no_problem_is_exported_beside_a_run(O, tmp_path, calling):
    """The export would read the scene while it changes."""
    cd = columns(O)
    O.run(10**9)
    try:
        before = cd.steps
        for _ in range(20):
            with pytest.raises(RuntimeError, match=r"run goes on.*O\.pause\(\)"):
                calling(lambda: cd.exportProblem(str(tmp_path / "a")))
        deadline = time.monotonic() + 60
        while cd.steps == before and time.monotonic() < deadline:
            time.sleep(0.01)
        assert cd.steps > before  # the run was really under way
    finally:
        O.pause()
        O.wait()
    assert not (tmp_path / "a").exists()
    cd.exportProblem(str(tmp_path / "a"))
    assert core.read_problem(tmp_path / "a").contacts == 500


@pytest.mark.parametrize("place", ["before", "after"])
def test_an_engine_of_the_run_may_export(O, tmp_path, place):
    """A PyRunner makes the run wait, so the scene does not change."""
    cd = columns(O)
    export = runner(lambda: cd.exportProblem(str(tmp_path / "a")), iterPeriod=1, nDo=1)
    O.engines = [export, *O.engines] if place == "before" else [*O.engines, export]
    O.run(3, True)
    assert len(ids(tmp_path / "a")) == 500


def test_a_velocity_set_beside_a_run_holds(O):
    """Of a boundary, whose velocity the engine only reads. A step that was under way must not write back the one it began with."""
    cd = columns(O)
    O.bodies[0].state.blockedDOFs = "xyzXYZ"
    O.run(10**9)
    try:
        for k in range(20):
            O.bodies[0].state.vel = (1e-6 * (k + 1), 0, 0)
            begin, deadline = cd.steps, time.monotonic() + 60
            while cd.steps < begin + 3 and time.monotonic() < deadline:
                time.sleep(0.001)
            assert cd.steps >= begin + 3 and O.bodies[0].state.vel[0] == 1e-6 * (k + 1)
    finally:
        O.pause()
        O.wait()


def test_attributes_are_read_whole_beside_a_run(O):
    """Also texts and lists, which a step rewrites while they are copied. The thread sanitizer checks this test in `make soak`."""
    cd = columns(O)
    words = {"converged", "stagnated", "max_iterations"}
    O.run(10**9)
    try:
        begin, deadline = cd.steps, time.monotonic() + 60
        while cd.steps < begin + 20 and time.monotonic() < deadline:
            cd.method = "accelerated" if cd.method == "auto" else "auto"
            all_of_them = cd.dict()
            assert all_of_them["status"] in words and cd.status in words and cd.solvedBy in ("none", "accelerated", "newton", "nsgs")
            assert len(cd._loadsBeforeTrial) in (0, 501) and len(cd._referenceIds) % 2 == 0 and not cd.unsolvableContact
        assert cd.steps >= begin + 20
    finally:
        O.pause()
        O.wait()


@pytest.mark.parametrize("height", [0.01, 1e3], ids=["asleep", "falling"])
def test_gravity_that_a_thread_sets_acts_at_once(O, height):
    """In the middle of a run for whose end somebody waits, with publish='due': on a disk that sleeps on the floor, and on one that falls."""
    plane.floor()
    disk = plane.disk((0, height), 0.01)
    engine = plane.run(100, 1e-5, gravity=(0, -1, 0))
    O.trackEnergy = True

    def turn():
        before = engine.steps
        while engine.steps < before + 1000:
            time.sleep(1e-4)
        engine.gravity = (0, 10, 0)
        before = engine.steps
        while engine.steps < before + 20000:
            time.sleep(1e-4)
        O.pause()

    try:
        _thread.start_new_thread(turn, ())
        O.run(10**9, True)
    finally:
        O.trackEnergy = False
    assert O.bodies[disk].state.vel[1] > 1e-2
    energy = dict(O.energy.items())
    assert energy["kinetic"] + energy["gravWork"] == pytest.approx(5e-11 * (height > 1), abs=1e-3 * energy["kinetic"])


REPLACING = ("load('a.yade')", "loadTmp()", "reload()", "reset()", "resetAllScenes()", "resetCurrentScene()", "resetThisScene()",
             "stringToScene(scene)")
SCRIPT = """
from tests.plugin import plane
def build():
    O.reset()
    plane.columns(0, disks=1)
    plane.run(3, 1e-3, gravity=(0, -9.81, 0))
    O.save("a.yade")
build()
O.saveTmp()
scene = O.sceneToString()
"""


def printed(folder, text):
    """What a script prints, run by a YADE of its own, as it would crash or hang without what is tested."""
    done = programs.in_yade(folder, SCRIPT + text)
    return done.stdout + done.stderr


def test_a_scene_is_replaced_right_after_a_run_has_begun(tmp_path):
    """YADE itself would end, as the thread of the run has not begun yet. The run is paused first."""
    calls = "".join(f"    build(); O.run({steps}); O.{call}; assert not O.running\n" for call in REPLACING for steps in (-1, 1))
    text = printed(tmp_path, f"for _ in range(10):\n{calls}print('all replaced')\n")
    assert "all replaced" in text, text


def test_an_engine_of_the_run_neither_waits_for_it_nor_replaces_its_scene(tmp_path):
    text = printed(tmp_path, f"""
for call in {("run(2, True)", "wait()", *REPLACING)!r}:
    build()
    O.engines = O.engines + [PyRunner(command="O." + call, iterPeriod=1)]
    try:
        O.run(3, True)
    except RuntimeError as error:
        print("refused:", str(error).split("ERROR:")[1])
""")
    assert text.count("refused: \nO.") == 2 + len(REPLACING), text
