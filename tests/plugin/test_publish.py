"""publish='due' writes to the scene only what somebody reads, and this equals publish='always' to the last bit."""
import threading
import time

import numpy as np
import pytest
from yade import utils, wrapper

import cd_engine
from yade_scripts.running.hooks import runner

from . import plane


def scene(O):
    """Disks falling on a floor between walls, one of which turns; a free box on top would be refused, so a paddle stirs them."""
    plane.heap(0.3)
    paddle = plane.box((0.15, 0.02), (0.05, 0.002))
    O.bodies[paddle].state.angVel = (0, 0, 3)


def both(O, run, build=scene, **settings):
    """Return the results of `run(engine)` for both values of publish, with the scene built anew for each."""
    results = []
    for publish in ("always", "due"):
        O.reset()
        build(O)
        plane.engine(gravity=(0, -9.81, 0), tolerance=1e-6, publish=publish, **settings)
        results.append(run(O.engines[-1]))
    assert results[0] == results[1]
    return results[0]


def test_at_the_end_of_every_run(O):
    sums = []

    def run(engine):
        found = []
        for steps in (1, 2, 50, 150, 300):
            O.run(steps, True)
            found.append((plane.digest(), engine.totalIterations, engine.dissipatedEnergy, engine.sleeping))
        O.step()
        sums.append([*(s for row in utils.getStress(1.0) for s in row), utils.unbalancedForce()])
        return found + [plane.digest()]

    both(O, run)
    # YADE sums over its list of interactions, which stand in the order in which they came: the same but for round-off.
    assert sums[0] == pytest.approx(sums[1], rel=1e-13, abs=1e-12)


@pytest.mark.parametrize("place", ["before", "after"])
@pytest.mark.parametrize("period", [dict(iterPeriod=1), dict(iterPeriod=7), dict(iterPeriod=7, initRun=True), dict(virtPeriod=0.013),
                                    dict(virtPeriod=0.001),
                                    dict(virtPeriod=0.0125, initRun=True), dict(iterPeriod=5, nDo=4), dict(iterPeriod=30, virtPeriod=0.02)])
def test_before_an_engine_that_looks(O, place, period):
    """Recorders see every step's state when their period is over, wherever they stand."""
    def run(engine):
        found = []
        look = runner(lambda: found.append((O.iter, plane.digest())), **period)
        O.engines = [look, *O.engines] if place == "before" else [*O.engines, look]
        O.run(60, True)
        O.run(41, True)
        return found + [plane.digest()]

    assert len(both(O, run)) > 3


@pytest.mark.parametrize("place", ["first", "middle", "last"])
def test_what_an_engine_changes_is_read(O, place):
    """Velocities, friction and forces set in the course of a run."""
    def run(engine):
        def change():
            disk = O.bodies[len(O.bodies) // 2]
            disk.state.vel = disk.state.vel + (0.3, 0.1, 0)
            O.materials[0].frictionAngle = 0.1 + 0.3 * (O.iter % 2)
            O.forces.setPermF(disk.id, (0, 2 * (O.iter % 3), 0))

        at = {"first": 0, "middle": 2, "last": 3}[place]
        O.engines = [*O.engines[:at], runner(change, iterPeriod=11), *O.engines[at:]]
        O.run(100, True)
        return plane.digest(), engine.totalIterations

    both(O, run)


@pytest.mark.parametrize("dies", [False, True])
def test_a_force_acts_in_the_step_it_was_added_in_and_no_longer(O, dies):
    """Nine pushes of 1 N for 1 ms on 1 kg; one where the engine that pushes dies in its step."""
    def build(O):
        plane.floor(plane.material())
        plane.disk((0, 1), 0.01)

    def run(engine):
        def push():
            O.forces.addF(1, (1, 9.81, 0))
            O.engines[2].dead = dies

        O.engines = [*O.engines[:2], runner(push, iterPeriod=11), engine]
        O.run(100, True)
        return O.bodies[1].state.vel[0], plane.digest()

    assert both(O, run, build=build)[0] == pytest.approx(1e-3 if dies else 9e-3, rel=1e-12)


@pytest.mark.parametrize("contacts", [False, True])
def test_what_lies_still_is_tried_and_ordered_as_if_somebody_looked(O, contacts):
    """Compares the plan of rest trials and the order of the bodies, which determine the last digits later."""
    def build(O):
        plane.grid(12, 12, (0, 0.01 if contacts else 1.0), (0.05, 0), plane.ground())

    def run(engine):
        engine.gravity = (0, -9.81, 0) if contacts else (0, 0, 0)
        O.engines = [*O.engines, runner(lambda: setattr(engine, "gravity", (0.1, -9.81, 0)) if O.iter == 150 else None, iterPeriod=50)]
        found = []
        for steps in (51, 50, 300):
            O.run(steps, True)
            found.append((engine._restTrialAt, engine._restTrialPause, list(engine._loadsBeforeTrial), plane.digest()))
        return found

    both(O, run, build=build)


def test_a_step_that_ends_in_no_number_leaves_the_forces_of_the_one_before(O):
    """The points of contact are found anew, so they are the same up to round-off only: 1e-15 of positions of 1 m, with some digits to spare."""
    def build(O):
        plane.floor()
        plane.disk((1, 0.01), 0.01, velocity=(0.3, 0))
        for x, v in ((-0.03, 0.5), (0.03, -0.5)):
            plane.disk((x, 1), 0.01, mass=1e157, velocity=(v, 0))

    touching = []

    def run(engine):
        with pytest.raises(RuntimeError, match="not finite"):
            O.run(200, True)
        touching.append((*O.interactions[0, 1].geom.contactPoint, O.interactions[0, 1].geom.penetrationDepth))
        return O.iter, [(*O.forces.f(b.id), *b.state.pos, *b.state.vel) for b in O.bodies], tuple(O.interactions[0, 1].phys.normalForce)

    iteration, bodies, force = both(O, run, build=build)
    assert iteration > 10 and np.isfinite(bodies).all() and force == pytest.approx((0, 9.81, 0))
    assert touching[1] == pytest.approx(touching[0], abs=1e-14)


def test_paused_by_another_thread_than_the_one_that_waits(O):
    """The other thread sees the last step, and what it sets is kept."""
    def build(O):
        plane.disk((0, 0), 0.01, velocity=(1, 0))

    for publish in ("always", "due"):
        O.reset()
        build(O)
        engine = plane.engine(publish=publish)
        waiter = threading.Thread(target=lambda: O.run(10**9, True))
        waiter.start()
        while engine.steps < 50:
            time.sleep(0.001)
        O.pause()
        while engine.steps != O.iter:
            time.sleep(0.001)
        assert O.bodies[0].state.pos[0] == pytest.approx(1e-3 * O.iter, rel=1e-9)
        O.bodies[0].state.vel = (0, 7, 0)
        waiter.join()
        assert tuple(O.bodies[0].state.vel) == (0, 7, 0)


@pytest.mark.parametrize("period", [dict(virtPeriod=1e6), dict(iterPeriod=10**9), dict(iterPeriod=1, nDo=3)])
def test_between_two_looks_the_scene_stays_as_it_was(O, period):
    """Else every step would cost what writing costs. Another thread reads a falling disk while the run goes on."""
    plane.disk((0, 0), 0.01, velocity=(1, 0))
    plane.box((0, -1), (0.05, 0.002))
    O.engines = [wrapper.TranslationEngine(ids=[1], translationAxis=(0, 1, 0), velocity=1e-3), *cd_engine.engines(), runner(lambda: None, **period)]
    O.dt = 1e-6
    O.run(10, True)
    found = set()

    def read():
        start = O.iter
        while O.iter < start + 100:
            found.add(O.bodies[0].state.pos[0])
        O.stopAtIter = O.iter + 10

    reader = threading.Thread(target=read)
    reader.start()
    O.run(10**9, True)
    reader.join()
    assert len(found) == 1
    assert O.bodies[0].state.pos[0] == pytest.approx(1e-6 * O.iter, rel=1e-9)


def test_an_engine_without_a_period_is_always_due(O):
    def run(engine):
        O.engines = [*O.engines[:2], wrapper.ForceEngine(ids=[len(O.bodies) - 5], force=(1, 2, 0)), engine]
        O.run(100, True)
        return plane.digest()

    both(O, run)


@pytest.mark.parametrize("place", [0, 2, 3])
@pytest.mark.parametrize("disk", [False, True])
def test_engines_that_drive_bodies(O, place, disk):
    """Their velocities are read in every step, also where nothing else of the scene is; a look on the way changes nothing."""
    def run(engine):
        last = len(O.bodies) - 1  # the paddle
        O.bodies[5].state.blockedDOFs = "xyzXYZ" if disk else "zXY"
        drive = [wrapper.RotationEngine(ids=[last], angularVelocity=4, rotationAxis=(0, 0, 1), rotateAroundZero=True, zeroPoint=(0.15, 0, 0)),
                 wrapper.HarmonicMotionEngine(ids=[5 if disk else 0], A=(0, 2e-3, 0), f=(0, 9, 0))]
        O.engines = [*O.engines[:place], *drive, *O.engines[place:], runner(lambda: found.append(plane.digest()), iterPeriod=40)]
        found = []
        O.run(90, True)
        drive[0].angularVelocity = 0
        O.run(110, True)
        return found + [plane.digest()]

    both(O, run)


def test_a_refused_driver_leaves_its_velocities(O):
    """It drives the floor out of the plane; what it has set stands in the scene."""
    def run(engine):
        O.engines = [*O.engines, wrapper.HarmonicMotionEngine(ids=[0], A=(1e-3, 1e-3, 1e-3), f=(3, 9, 9), fi=(0, 0, 0))]
        with pytest.raises(RuntimeError, match="#0 moves out of the x-y plane"):
            O.run(90, True)
        return O.iter, [(*b.state.pos, *b.state.vel) for b in O.bodies]

    _, bodies = both(O, run)
    assert bodies[0][3] != 0


def test_a_driver_wakes_what_rests(O):
    """A floor that begins to move after hundreds of steps at rest, in the course of a run."""
    def build(O):
        plane.columns(0)

    def run(engine):
        O.engines = [*O.engines, wrapper.HarmonicMotionEngine(ids=[0], A=(0, 0.01, 0), f=(0, 0.5, 0), fi=(0, 1.5707963, 0))]
        O.run(5, True)
        O.engines[-1].A = (0, 0, 0)
        O.run(300, True)
        asleep = engine.sleeping + engine.resting
        O.engines[-1].A = (0, 0.05, 0)
        O.run(50, True)
        return asleep, O.bodies[1].state.pos[1], plane.digest()

    asleep, height, _ = both(O, run, build=build)
    assert asleep > 0 and height < 0.008


def test_saved_by_an_engine_of_the_run_and_gone_on(O, tmp_path):
    """A scene saved in mid-run goes on as if it had not been saved."""
    def run(engine):
        path = str(tmp_path / f"{engine.publish}.yade.gz")
        O.engines = [*O.engines, runner(lambda: O.save(path) if O.iter == 99 else None, iterPeriod=1)]
        O.run(200, True)
        straight = plane.digest(born=False)
        O.load(path)
        O.engines = O.engines[:3]
        O.run(100, True)  # the hundredth step was over, though O.iter had not risen yet
        return straight, plane.digest(born=False)

    straight, gone_on = both(O, run)
    assert straight == gone_on


def test_after_a_pause_and_in_the_background(O):
    """A run in the background shows every step; a caller that waits for the end sees the last one."""
    all = 4000  # half a second

    def run(engine):
        O.run(all)
        while O.iter < 20:
            time.sleep(0.001)
        O.pause()
        while engine.steps != O.iter:  # the last step may still go on
            time.sleep(0.001)
        now = plane.digest()
        assert O.iter < all, "the machine was too busy to look in time"
        O.run(all - O.iter)
        O.wait()
        return now != plane.digest(), plane.digest()

    assert both(O, run)[0]


def test_a_run_stopped_by_an_engine(O):
    """By O.pause() and stopAtIter from within a step; the final state is visible although the end was not announced."""
    def run(engine):
        O.engines = [*O.engines, runner(lambda: setattr(O, "stopAtIter", O.iter + 3), iterPeriod=50)]
        O.run(500, True)
        stopped = O.iter
        return stopped, plane.digest()

    assert both(O, run)[0] < 500


def test_a_refusal_leaves_the_last_step(O):
    """A step that is refused leaves the scene as the step before it."""
    def run(engine):
        O.run(30, True)
        O.engines = [*O.engines[:2], runner(lambda: setattr(O.bodies[5].state, "mass", 0), iterPeriod=25), engine]
        with pytest.raises(RuntimeError, match="#5 is free to move but has the mass 0"):
            O.run(100, True)
        return O.iter, [(*b.state.pos, *b.state.vel) for b in O.bodies]

    both(O, run)


def test_the_collider_finds_what_is_new(O):
    """Disks thrown far, so that it has to search within the run: it sees them where they are."""
    def build(O):
        plane.cloud(60, seed=3, speed=3.0)

    def run(engine):
        O.run(300, True)
        return plane.digest(), engine.deepestPenetration

    both(O, run, build=build)


def test_springs_take_over(O):
    """They find the contacts of Contact Dynamics at their present places."""
    def run(engine):
        O.run(200, True)
        before = plane.digest()
        cd_engine.release()
        O.engines, O.dt = plane.springs(), 1e-5
        O.run(100, True)
        return before, plane.digest()

    both(O, run)


def test_forces_set_in_what_sleeps_are_seen_at_once(O):
    """Contacts whose forces somebody changes in mid-run are looked at in the next step."""
    def build(O):
        plane.columns(0, 0.1)

    def run(engine):
        O.run(100, True)
        asleep, found = engine.sleeping, []

        def push():
            O.interactions[0, 1].phys.normalForce = 1.5 * O.interactions[0, 1].phys.normalForce

        O.engines = [*O.engines, runner(push, iterPeriod=40), runner(lambda: found.append(engine.sleeping), iterPeriod=1)]
        O.run(45, True)
        return asleep, min(found), plane.digest()

    assert both(O, run, build=build)[:2] == (2, 1)
