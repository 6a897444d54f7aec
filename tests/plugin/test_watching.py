"""cd_engine.watch: what it finds, what it leaves alone, and the limit of springs that it compares the step with."""
import math
import time

import pytest
from yade import utils, wrapper as w

import cd_engine
from cd_engine import springs, watching

from . import plane

K, R, M, OVERLAP = 1e5, 0.01, 0.5, 1e-3


def held(O, share, friction=0.0, speed=0.1, **options):
    """A disk of mass M between two held ones, which its springs K always touch; O.dt is a share of the limit 2/sqrt(2 K/M)."""
    O.materials.append(w.FrictMat(frictionAngle=friction, label="springs"))
    for x in (-2 * R + OVERLAP, 0, 2 * R - OVERLAP):
        O.bodies.append(utils.sphere((x, 0, 0), R, material="springs", fixed=bool(x)))
    state = O.bodies[1].state
    state.mass, state.inertia, state.vel = M, (0.4 * M * R**2,) * 3, (speed, 0, 0)
    O.engines = spring_engines() + [cd_engine.watch(**options)]
    O.dt = share * 2 / math.sqrt(2 * K / M)
    return state


def spring_engines(gravity=(0, 0, 0)):
    value = lambda number: w.MatchMaker(algo="val", val=number)
    return [w.ForceResetter(), w.InsertionSortCollider([w.Bo1_Sphere_Aabb(), w.Bo1_Box_Aabb()]),
            w.InteractionLoop([w.Ig2_Sphere_Sphere_ScGeom(), w.Ig2_Box_Sphere_ScGeom()],
                              [w.Ip2_FrictMat_FrictMat_FrictPhys(kn=value(K), ks=value(K / 2))], [w.Law2_ScGeom_FrictPhys_CundallStrack()]),
            w.NewtonIntegrator(damping=0, gravity=gravity)]


def thrown(O, gravity=0.0, speed=1.0):
    """A disk above a floor; without gravity it has the speed downwards."""
    O.materials.append(w.FrictMat(frictionAngle=0, label="springs"))
    O.bodies.append(utils.box((0, -R, 0), (1, R, 1), fixed=True, material="springs"))
    O.bodies.append(utils.sphere((0, 3.3 * R, 0), R, material="springs"))
    state = O.bodies[1].state
    state.mass, state.inertia, state.vel, state.blockedDOFs = M, (M * R**2 / 2,) * 3, (0, -speed, 0), "zXY"
    O.engines = spring_engines((0, -gravity, 0))
    return state


@pytest.mark.parametrize("friction, stiffness", [(0.0, 2 * K), (0.5, 5 * K / 2 * (1 - OVERLAP / (2 * R))**2)])
def test_limit_of_a_sphere_in_space(O, friction, stiffness):
    """Along the line w^2 = 2 k_n/m; with friction it turns with w^2 = 2 k_t a^2/I at the lever a = R - overlap/2, k_t = k_n/2 and I = 2/5 m R^2."""
    held(O, 0.1, friction)
    O.run(2, True)
    assert springs.limit() == pytest.approx(2 / math.sqrt(stiffness / M), rel=2e-4)  # what it bisects to
    assert springs.safe_bound() == pytest.approx(springs.limit() / math.sqrt(2), rel=2e-4)


def test_an_oscillator_just_below_its_limit_passes(O):
    held(O, 0.99, speed=1e-3)
    O.run(30000, True)
    assert O.iter == 30000


def test_an_oscillator_just_above_its_limit_ends_with_a_step_that_would_do(O):
    held(O, 1.01, speed=1e-9)
    with pytest.raises(cd_engine.Unstable, match="kinetic energy of 1 bodies alternates.*body #1 with 2 contacts.*use at most") as ended:
        O.run(30000, True)
    assert O.iter < 5000 and 0.1 * O.dt < ended.value.step < O.dt / 1.01


def test_springs_that_bodies_were_pressed_into_may_let_go(O):
    """Half a radius of overlap, undamped, at 0.9 of the limit: nothing is there at the start but elastic energy."""
    state = held(O, 0.9, speed=0)
    O.bodies.erase(2)
    state.pos = (-R, 0, 0)
    O.run(5000, True)
    assert state.vel[0] > 0


def test_a_contact_of_one_step_that_throws_back_creates_energy(O):
    """No check sees the contact, since it lasts for a step."""
    thrown(O, speed=0.02)
    O.engines += [cd_engine.watch()]
    O.dt = 1.2 * 2 / math.sqrt(K / M)
    with pytest.raises(cd_engine.Unstable, match="J of kinetic energy and height appeared, beside 0.0001 J that were there"):
        O.run(5000, True)


def test_bodies_that_pass_into_each_other(O):
    thrown(O, speed=20.0)
    O.engines += [cd_engine.watch(every=1)]
    O.engines[-1].iterPeriod = 1
    O.dt = 0.02 * 2 / math.sqrt(K / M)
    with pytest.raises(cd_engine.Unstable, match="body #0 and body #1 overlap by 0.7.* of the smaller radius.*or stiffer springs"):
        O.run(5000, True)


def test_a_watch_may_have_any_label(O):
    """Two of them keep their own periods."""
    thrown(O)
    O.engines += [cd_engine.watch(), cd_engine.watch(every=300)]
    O.engines[-1].label = O.engines[-2].label = ""
    O.dt = 0.02 * 2 / math.sqrt(K / M)
    O.run(1000, True)
    assert (O.engines[-2].iterPeriod, O.engines[-1].iterPeriod) == (800, 300)


@pytest.mark.parametrize("loses", [True, False])
def test_speed_without_a_reason(O, loses):
    """A disk may fall as far and as fast as it likes, but not gain speed from nothing."""
    state = thrown(O, gravity=9.81, speed=0)
    O.bodies.erase(0)
    def push():
        state.vel = (0, -1e4, 0)
    if not loses:
        plane.every_step = push
        O.engines = O.engines[:-1] + [w.PyRunner(command="from tests.plugin import plane; plane.every_step()", iterPeriod=900)] + O.engines[-1:]
    O.engines += [cd_engine.watch(every=500)]
    O.dt = 1e-2
    if loses:
        O.run(3000, True)
        assert -state.vel[1] * O.dt > 100 * R
    else:
        with pytest.raises(cd_engine.Unstable, match="body #1 moves by 1e.04 of its radius in a step, at 1e.04 m/s"):
            O.run(3000, True)


def test_numbers_that_are_none(O):
    state = held(O, 0.5)
    O.run(10, True)
    state.vel = (math.nan, 0, 0)
    with pytest.raises(cd_engine.Unstable, match="position or velocity of body #1 is not finite; this arose after step 0"):
        O.run(1000, True)


def test_a_shaken_floor_may_give_energy(O):
    state = thrown(O, gravity=9.81, speed=0)
    O.engines = O.engines[:-1] + [w.HarmonicMotionEngine(ids=[0], A=(0, R, 0), f=(0, 20, 0), fi=(0, 0, 0))] + O.engines[-1:] + [cd_engine.watch()]
    O.dt = 0.1 * 2 / math.sqrt(K / M)
    O.run(20000, True)
    assert 0 < state.pos[1]


def test_a_runner_may_push(O):
    """What others do to bodies is unknown, so their energy proves nothing."""
    state = thrown(O, speed=-1)
    def push():
        state.vel = 2 * state.vel
    plane.every_step = push
    O.engines += [w.PyRunner(command="from tests.plugin import plane; plane.every_step()", iterPeriod=1000), cd_engine.watch()]
    O.dt = 1e-5
    O.run(3000, True)
    O.engines[-2].label = "observer"
    O.engines = O.engines[:-1] + [cd_engine.watch(observers=["observer"])]
    with pytest.raises(cd_engine.Unstable, match="appeared"):
        O.run(3000, True)


def test_contact_dynamics_is_watched(O):
    """Disks fall into a heap; then a speed that comes from nowhere ends the run."""
    plane.floor()
    disks = [plane.disk((0.021 * (k % 3), 0.02 + 0.021 * (k // 3)), 0.01) for k in range(9)]
    O.engines = cd_engine.engines(gravity=(0, -9.81, 0)) + [cd_engine.watch()]
    O.dt = 1e-3
    O.run(2500, True)
    state = O.bodies[disks[0]].state
    state.vel = (0, 30, 0)
    with pytest.raises(cd_engine.Unstable, match="use a shorter time step than O.dt = 0.001 s$"):
        O.run(1500, True)


def test_a_run_in_the_background_stops_and_prints_why(O, capfd):
    held(O, 1.01)
    O.run(100000)
    while O.running:
        time.sleep(0.01)
    assert O.iter < 5000 and "cd_engine.watch: step " in capfd.readouterr().err


def test_a_step_raises(O):
    held(O, 0.5)
    O.step()
    O.bodies[1].state.vel = (math.inf, 0, 0)
    O.engines[-1].iterPeriod = 1
    with pytest.raises(cd_engine.Unstable):
        O.step()


@pytest.mark.parametrize("rigid", [False, True])
def test_no_bit_of_the_motion_changes(O, rigid):
    def end(watched):
        O.reset()
        plane.floor()
        for k in range(9):
            plane.disk((0.021 * (k % 3) + 1e-3 * k, 0.02 + 0.021 * (k // 3)), 0.01)
        O.engines = cd_engine.engines(gravity=(0, -9.81, 0)) if rigid else spring_engines((0, -9.81, 0))
        O.engines += [cd_engine.watch(every=7)] * watched
        O.dt = 1e-3 if rigid else 1e-5
        O.run(700 if rigid else 30000, True)
        return [(tuple(b.state.pos), tuple(b.state.vel), tuple(b.state.angVel)) for b in O.bodies]
    assert end(True) == end(False)


@pytest.mark.parametrize("every", [0, -1, 2.5, "7"])
def test_what_is_no_number_of_steps_is_refused(O, every):
    with pytest.raises(ValueError, match="every=.* is out of range"):
        cd_engine.watch(every=every)


@pytest.mark.parametrize("observers", ["sampling", None, 3, [3]])
def test_observers_are_labels(O, observers):
    with pytest.raises(ValueError, match="observers=.* is no list of labels"):
        cd_engine.watch(observers=observers)


def test_a_wait_after_the_end_raises(O):
    """The run has ended, with a line, before anybody waits for it."""
    plane.floor()
    plane.disk((0, 0.01), 0.01)
    O.engines = spring_engines((0, -9.81, 0)) + [cd_engine.watch()]
    O.dt = 1e-5
    O.bodies[1].state.vel = (math.nan, 0, 0)
    O.run(5000)
    while O.running:
        time.sleep(0.01)
    with pytest.raises(cd_engine.Unstable, match="is not finite, since the first check"):
        O.wait()
    O.wait()  # told once


def test_it_does_not_stand_in_a_parallel_engine(O):
    """There an error would end YADE."""
    plane.floor()
    plane.disk((0, 0.01), 0.01)
    O.engines = spring_engines((0, -9.81, 0)) + [w.ParallelEngine([cd_engine.watch()])]
    with pytest.raises(RuntimeError, match="watch.. stands in a ParallelEngine"):
        O.run(1, True)


def test_what_was_seen_counts_after_a_checkpoint(O, tmp_path):
    """A run that goes through O.save and O.load is the same run: its energy is compared with what there was at its start."""
    held(O, 0.5)
    O.run(100, True)
    seen = watching.of_scene()
    O.save(str(tmp_path / "scene.yade.gz"))
    with watching.kept():
        O.load(str(tmp_path / "scene.yade.gz"))
    assert seen.start is not None and watching.of_scene() is seen
    O.load(str(tmp_path / "scene.yade.gz"))
    assert watching.of_scene() is not seen
