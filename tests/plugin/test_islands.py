"""Islands of contacts solved separately (`reduce`): what they are, that motion does not depend on it, and how much work it saves."""
import math

import pytest
from yade.wrapper import FrictPhys

import cd_engine
from yade_scripts.running.hooks import runner

from . import plane

GRAVITY = (0, -9.81, 0)


def pile(left, rows, mat, gap=0.0):
    """A pile of disks of 1 cm on the floor, `rows` in its lowest row, whose left end is at `left`; ids."""
    return [plane.disk((left + 0.01 * (2 * i + j + 1) + gap * i, 0.01 + 0.0173 * j), 0.01, mat=mat) for j in range(rows) for i in range(rows - j)]


def scene(O, piles=3):
    """Piles apart on one floor, a disk that slides and one that flies."""
    mat = plane.ground(0.5)
    for k in range(piles):
        pile(0.2 * k, 3, mat)
    plane.disk((-0.3, 0.01), 0.01, velocity=(0.1, 0), mat=mat)
    plane.disk((-0.5, 3), 0.01, mat=mat)


def motion(O):
    return [x for b in O.bodies for x in (*b.state.pos, *b.state.vel, *b.state.angVel)]


def seen(O):
    """All visible results of a step: motion, contacts, total forces on bodies, counts and error of the engine."""
    cd = O.engines[-1]
    names = ("contacts", "unknowns", "islands", "resting", "sleeping", "loadedContacts", "slidingContacts", "maxPenetration", "residual",
             "residualMax")
    return plane.digest(), [getattr(cd, name) for name in names]


def test_counts(O):
    """Three unknowns a disk that touches something; without `reduce` a disk that flies has them, too."""
    scene(O)
    cd = plane.run(1, 1e-4, gravity=GRAVITY, tolerance=1e-8)
    assert (cd.islands, cd.unknowns) == (4, 3 * (3 * 6 + 1))
    cd.reduce = False
    O.run(1, True)
    assert (cd.islands, cd.unknowns) == (1, 3 * (3 * 6 + 2))


@pytest.mark.parametrize("free, islands", [("xyzXYZ", 2), ("yzXYZ", 1)])
def test_a_boundary_that_can_move_joins_what_touches_it(O, free, islands):
    """Two disks on either side of a plate: fixed, or free along x and pushed by nothing."""
    mat = plane.material(0)
    for side in (-1, 1):
        plane.disk((side * 0.11, 0), 0.1, velocity=(-side, 0), mat=mat)
    plate = plane.box((0, 0), (0.01, 0.5), blocked=free, mat=mat)
    cd = plane.run(1, 1e-3, tolerance=1e-12)
    assert (cd.contacts, cd.islands) == (2, islands)
    assert [O.bodies[i].state.vel[0] for i in (0, 1, plate)] == pytest.approx([0, 0, 0], abs=1e-13)


def test_motion_does_not_depend_on_it(O):
    """Bodies falling on each other and coming to rest. Errors of 1e-11 of the impulses, m g dt = 1e-3 N s, on 1 kg over 300 steps of 1e-4 s."""
    moved = []
    for reduce in (True, False):
        O.reset()
        mat = plane.ground(0.5)
        for k in range(3):
            pile(0.2 * k, 3, mat, gap=1e-3)
        plane.disk((-0.3, 0.012), 0.01, velocity=(0.1, 0), mat=mat)
        cd = plane.run(300, 1e-4, gravity=GRAVITY, tolerance=1e-11, maxIterations=100000, reduce=reduce)
        assert cd.unconvergedSteps == 0
        moved.append(motion(O))
    assert moved[0] == pytest.approx(moved[1], abs=1e-8)


def test_a_single_island_is_the_same_to_the_last_bit(O):
    hashes = []
    for reduce in (True, False):
        O.reset()
        mat = plane.ground(0.5)
        pile(0, 6, mat)
        cd = plane.run(100, 1e-3, gravity=GRAVITY, tolerance=1e-6, reduce=reduce)
        assert cd.islands == 1
        hashes.append(plane.digest())
    assert hashes[0] == hashes[1]


def test_a_search_for_pairs_names_the_body_that_has_moved_far(O):
    """A disk falls beside a column that sleeps. When it has used up its margin, pairs are searched anew, and this wakes the column."""
    plane.columns(-0.3)
    falls = plane.disk((0.3, 5), 0.01)
    cd = plane.run(200, 1e-3, gravity=GRAVITY, tolerance=1e-6)
    while not cd.woken and O.iter < 600:
        O.run(1, True)
    assert cd.woken.endswith(f"near pairs were searched anew, since a body has moved far (body #{falls})")


def test_what_is_at_rest_sleeps_until_something_changes(O):
    """Three columns apart; then one is pushed, and later gravity grows by a thousandth."""
    columns = plane.columns(-0.3, -0.2, -0.1)
    cd = plane.run(600, 1e-3, gravity=GRAVITY, tolerance=1e-6)
    assert (cd.islands, cd.sleeping, cd.resting, cd.iterations) == (3, 3, 3, 0)
    assert all(b.state.vel.norm() == 0 for b in O.bodies)
    assert cd.residual <= 1e-6
    assert cd.woken == ""
    O.bodies[columns[0][2]].state.vel = (0.01, 0, 0)
    O.run(1, True)
    assert (cd.islands, cd.sleeping) == (3, 2)
    assert cd.woken == f"step 600: a body was moved or changed, or another force acts on it (body #{columns[0][2]})"
    cd.gravity = (0, -9.81 * (1 + 1e-3), 0)
    O.run(1, True)
    assert cd.sleeping == 0
    O.run(200, True)
    assert cd.sleeping == 2
    assert all(O.bodies[i].state.vel.norm() == 0 for i in columns[1])


def test_sleep_leaves_the_motion_within_the_tolerance(O):
    """A disk falls on the second of two sleeping columns. What is stopped in one run and not in the other, velocities of 1e-5 g dt and less for
    300 steps of 1e-3 s, is 3e-8 m, and the errors of 1e-6 g dt^2 a step add up to 1e-8 m at most; the impact multiplies them."""
    moved = []
    for reduce in (True, False):
        O.reset()
        plane.columns(0, 0.2)
        cd = plane.run(300, 1e-3, gravity=GRAVITY, tolerance=1e-6, reduce=reduce)
        assert cd.sleeping == (2 if reduce else 0)
        plane.disk((0.2, 0.08), 0.01)
        O.run(200, True)
        assert (cd.sleeping >= 1) == reduce and cd.unconvergedSteps == 0
        moved.append([x for b in O.bodies for x in b.state.pos])
    assert moved[0] == pytest.approx(moved[1], abs=1e-5)


@pytest.mark.parametrize("excess", [1e-4, 1e-3])
def test_no_false_rest(O, excess):
    """Two disks that cannot turn, one on the other, on a floor at an angle of tan(theta) = mu (1 + excess): the upper one rests on the lower, and
    both begin to slide with g (sin - mu cos), though for a hundred steps all velocities are of the tolerance's size. Solved to a tenth of it."""
    mu, g = 0.5, 9.81
    theta = math.atan(mu * (1 + excess))
    plane.columns(0, disks=2, mu=mu, blocked="zXYZ")
    cd = plane.run(400, 1e-3, gravity=(g * math.sin(theta), -g * math.cos(theta), 0), tolerance=1e-4)
    assert cd.sleeping == 0 and O.bodies[1].state.vel[0] == pytest.approx(0.4 * g * (math.sin(theta) - mu * math.cos(theta)), rel=0.1)


@pytest.mark.parametrize("load, speed, tolerance", [(1e5, 1e-3, 1e-6), (1e4, 1e-2, 1e-4), (1e4, 0.1, 1e-3)])
def test_what_rolls_among_heavily_loaded_bodies_is_not_stopped(O, load, speed, tolerance):
    """A light disk rolls on two in a press, more slowly than the tolerance of the press's forces can resolve. 1 % for errors on the way."""
    plane.columns(-0.1, 0.1, disks=1)
    press = plane.box((0, 0.025), (0.5, 0.005), blocked="xzXYZ")
    roller = plane.disk((0, 0.035), 0.005, velocity=(speed, 0), spin=-speed / 0.005)
    plane.engine(gravity=GRAVITY, tolerance=tolerance)
    O.forces.setPermF(press, (0, -load, 0))
    O.run(400, True)
    assert O.bodies[roller].state.pos[0] == pytest.approx(0.4 * speed, rel=0.01)


def test_what_drifts_is_not_stopped(O):
    """Three disks pressed together in free space, by forces that need impulses of 100 N s a step."""
    row = [plane.disk((0.02 * k, 0), 0.01, velocity=(0, 1e-3)) for k in range(3)]
    plane.engine(tolerance=1e-6)
    O.forces.setPermF(row[0], (1e5, 0, 0))
    O.forces.setPermF(row[2], (-1e5, 0, 0))
    O.run(300, True)
    assert [O.bodies[i].state.vel[1] for i in row] == pytest.approx([1e-3] * 3, rel=1e-6)


def test_what_is_stopped_is_counted_as_dissipated(O):
    """Energy is kept to round-off though impulses are wrong by 1e-2: kinetic and potential energy, and dissipatedEnergy."""
    plane.columns(0, disks=5)
    total = lambda: plane.kinetic_energy() + sum(9.81 * b.state.mass * b.state.pos[1] for b in O.bodies if b.state.blockedDOFs != "xyzXYZ")
    before = total()
    cd = plane.run(400, 1e-3, gravity=GRAVITY, tolerance=1e-2)
    assert cd.sleeping == 1
    assert before - total() == pytest.approx(cd.dissipatedEnergy, abs=1e-13)  # of 2.5 J


def test_a_finer_tolerance_wakes(O):
    plane.columns(0, disks=4)
    cd = plane.run(200, 1e-3, gravity=GRAVITY, tolerance=1e-2)
    assert cd.sleeping == 1
    cd.tolerance = 1e-10
    O.run(1, True)
    assert cd.converged and cd.residual <= 1e-10 and "settings" in cd.woken
    assert O.interactions[0, 1].phys.normalForce.norm() == pytest.approx(4 * 9.81, rel=1e-8)


def test_sleeping_forces_stay(O):
    """At an angle at which the normal's length is not 1 to the last digit, looked at in every step (runs of one step) and not."""
    plane.floor()
    for x, y in ((0, 0.01), (0.0211, 0.01), (0.00937, 0.0273)):
        plane.disk((x, y), 0.01)
    cd = plane.run(2000, 1e-3, gravity=GRAVITY, tolerance=1e-8)
    assert cd.sleeping == 1
    before = seen(O)
    for _ in range(200):
        O.step()
    O.run(2000, True)
    assert cd.sleeping == 1 and seen(O) == before


def test_a_disk_alone_on_the_floor_sleeps(O):
    plane.columns(0, 0.1, 0.2, 0.3, 0.4, disks=1)
    cd = plane.run(100, 1e-3, gravity=GRAVITY, tolerance=1e-6)
    assert (cd.islands, cd.sleeping, cd.contacts, cd.loadedContacts, cd.unknowns) == (5, 5, 5, 5, 15)
    assert tuple(O.forces.f(0)) == pytest.approx((0, -5 * 9.81, 0), rel=1e-12)  # on the floor


def test_what_changes_elsewhere_wakes_nothing(O):
    """A disk is pushed by another force in every step, apart from a column at rest."""
    plane.columns(0)
    pushed = plane.disk((1, 0.01), 0.01)
    plane.engine(gravity=GRAVITY, tolerance=1e-6)
    O.forces.setPermF(pushed, (0, 0, 0))
    for k in range(60):
        O.forces.setPermF(pushed, (1e-3 * k, 0, 0))
        O.step()
    assert O.engines[-1].sleeping == 1 and O.bodies[pushed].state.vel[0] > 0


CHANGES = {
    "a kick": lambda O, ids: setattr(O.bodies[ids[1]].state, "vel", (1e-2, 0, 0)),
    "a place": lambda O, ids: setattr(O.bodies[ids[2]].state, "pos", O.bodies[ids[2]].state.pos + (0, 1e-3, 0)),
    "a freedom": lambda O, ids: setattr(O.bodies[ids[2]].state, "blockedDOFs", "xyzXYZ"),
    "a load": lambda O, ids: O.forces.setPermF(ids[2], (100, 0, 0)),
    "the floor's place": lambda O, ids: setattr(O.bodies[0].state, "pos", O.bodies[0].state.pos - (0, 1e-2, 0)),
    "the floor's speed": lambda O, ids: setattr(O.bodies[0].state, "vel", (0, -0.1, 0)),
    "no floor": lambda O, ids: O.bodies.erase(0),
    "friction": lambda O, ids: setattr(O.bodies[ids[1]].mat, "frictionAngle", 0.0),
    "gravity": lambda O, ids: setattr(O.engines[-2], "gravity", (0.1, -9.81, 0)),
    "the time step": lambda O, ids: setattr(O, "dt", 5e-4),
    "the tolerance": lambda O, ids: setattr(O.engines[-2], "tolerance", 1e-12),
    "no reduction": lambda O, ids: setattr(O.engines[-2], "reduce", False),
    "no first guess": lambda O, ids: setattr(O.engines[-2], "warmStart", False),
    "so many sweeps": lambda O, ids: setattr(O.engines[-2], "fixedIterations", 50),
}


@pytest.mark.parametrize("change", CHANGES)
def test_nothing_shows_of_what_sleeps_on(O, change):
    """An engine changes something within a run while columns sleep. Runs of one step, in which everything is checked, give the same."""
    left = []
    for steps in (200, 1):
        O.reset()
        mats = [plane.material(0.5) for _ in range(4)]
        plane.floor(mats[0])
        columns = [plane.column(0.1 * k, mat=mats[k]) for k in range(3)]
        plane.disk((-0.5, 0.1), 0.01, velocity=(0.1, 0), mat=mats[3])
        O.dt = 1e-3
        O.engines = [*cd_engine.engines(gravity=GRAVITY, tolerance=1e-6),
                     runner(lambda: CHANGES[change](O, columns[1]), iterPeriod=1, firstIterRun=150, nDo=1)]
        O.run(148, True)
        assert O.engines[-2].sleeping == 3
        for _ in range(52 // min(steps, 52)):
            O.run(min(steps, 52), True)
        O.engines = O.engines[:-1]
        left.append(seen(O))
    assert O.iter == 200 and left[0] == left[1]


def within(O, step, change, **settings):
    """Engines with a change made within a run, after the step of that number; ContactDynamics."""
    O.engines = [*cd_engine.engines(gravity=GRAVITY, tolerance=1e-6, **settings), runner(change, iterPeriod=1, firstIterRun=step, nDo=1)]
    O.dt = 1e-3
    return O.engines[-2]


def test_forces_changed_in_what_sleeps_are_looked_at_in_the_next_step(O):
    """As they are changed by an engine of the run or between two runs."""
    plane.columns(0)
    cd = within(O, 50, lambda: setattr(O.interactions[0, 1].phys, "normalForce", (0, 1e3, 0)))
    O.run(52, True)
    assert O.interactions[0, 1].phys.normalForce[1] == pytest.approx(3 * 9.81, rel=1e-6)
    O.run(100, True)
    assert cd.sleeping == 1
    O.interactions[0, 1].phys.normalForce = (0, 1e3, 0)
    O.run(1, True)
    assert O.interactions[0, 1].phys.normalForce[1] == pytest.approx(3 * 9.81, rel=1e-6)


@pytest.mark.parametrize("change", [lambda O: setattr(O.interactions[0, 1], "phys", FrictPhys(normalForce=(0, 1e3, 0))),
                                    lambda O: O.interactions.erase(0, 1), lambda O: O.interactions.clear()], ids=["replaced", "erased", "all erased"])
@pytest.mark.parametrize("step", (17, 18, 19, 50))
def test_objects_taken_from_what_sleeps_are_missed_at_once(O, change, step):
    """Also while it falls asleep, in the trial of the 17th step."""
    plane.columns(0)
    cd = within(O, step, lambda: change(O))
    O.run(step + 4, True)
    assert O.interactions[0, 1].isReal and O.interactions[0, 1].phys.normalForce[1] == pytest.approx(3 * 9.81, rel=1e-5)
    assert cd.loadedContacts == 3


def test_contacts_that_cannot_push_are_counted_while_they_sleep(O):
    """A press that moves up and down only, and a fixed disk at its side."""
    left = []
    for run in (1, 60):
        O.reset()
        plane.columns(-0.1, 0.1, disks=1)
        plane.box((0, 0.025), (0.2, 0.005), blocked="xzXYZ")
        plane.disk((0.21, 0.025), 0.01, blocked="xyzXYZ")
        cd = plane.run(100, 1e-3, gravity=GRAVITY, tolerance=1e-6)
        for _ in range(60 // run):
            O.run(run, True)
        assert (cd.sleeping, cd.contacts) == (1, 5)
        left.append(seen(O))
    assert left[0] == left[1]


@pytest.mark.parametrize("margin", [0, 0.1])
def test_bodies_that_are_gone_are_no_contacts(O, margin):
    plane.columns(0, 0.1, 0.2)
    cd = within(O, 50, lambda: [O.bodies.erase(k) for k in (7, 8, 9)], searchMargin=margin)
    O.run(80, True)
    assert (cd.sleeping, cd.contacts) == (2, 6)


@pytest.mark.parametrize("before", [10, 60, 300])
def test_a_saved_scene_goes_on_bitwise(O, tmp_path, before):
    """The engine remembers what rested and slept, to save time; that must not change results."""
    plane.cloud(40, seed=3, speed=2)
    plane.floor()
    plane.column(5, 4)
    for b in O.bodies:
        if b.state.blockedDOFs == "zXY":
            b.state.pos += (0, 0.3 if b.state.pos[0] < 4 else 0, 0)
    plane.run(before, 1e-3, gravity=GRAVITY, tolerance=1e-6)
    plane.goes_on(tmp_path / "half.yade.gz", 300, lambda: seen(O))
    assert O.engines[-1].sleeping > 0
