"""Tangential springs as an exact differential: paths, energy, momenta, slip, memory."""
import math
import random

import numpy as np
import pytest
from yade import utils, wrapper as w

import cd_engine
from yade_scripts.running import hooks

from . import plane

KN, KS = 1e6, 5e5  # N/m
R1, R2 = 0.01, 0.012  # m


def engines(O, law="path_independent", dt=1e-5, gravity=0.0, motion=None):
    """Undamped linear springs with the tangential law; motion(): called between the forces and NewtonIntegrator."""

    def constant(value):
        return w.MatchMaker(algo="val", val=value)
    O.engines = [
        w.ForceResetter(),
        w.InsertionSortCollider([w.Bo1_Sphere_Aabb(), w.Bo1_Box_Aabb()], verletDist=1e-3),
        w.InteractionLoop([w.Ig2_Sphere_Sphere_ScGeom(avoidGranularRatcheting=law == "avoid_ratcheting"), w.Ig2_Box_Sphere_ScGeom()],
                          [w.Ip2_FrictMat_FrictMat_FrictPhys(kn=constant(KN), ks=constant(KS))], [w.Law2_ScGeom_FrictPhys_CundallStrack()]),
        *([cd_engine.PathIndependentShear(label="shear")] if law == "path_independent" else []),
        *([hooks.runner(motion, iterPeriod=1, initRun=True)] if motion else []),
        w.NewtonIntegrator(damping=0, gravity=(0, -gravity, 0)),
    ]
    O.dt = dt
    return O.engines[3]


def pair(O, overlap, mu=1e3, blocked="xyzXYZ", angle=0.0):
    """Two disks in contact, the line of centres at `angle`."""
    mat, d = plane.material(mu), R1 + R2 - overlap
    plane.disk((0, 0), R1, blocked=blocked, mat=mat)
    plane.disk((d * math.cos(angle), d * math.sin(angle)), R2, blocked=blocked, mat=mat)


def shear(O):
    """S [N]: of the spring on the second disk along the normal turned by +90 degrees."""
    i = O.interactions[0, 1]
    n, f = i.geom.normal, i.phys.shearForce
    return n[0] * f[1] - n[1] * f[0]


class Walk:
    """Leads the pair through placements (x, y of disk 2 and both turns), one a step, each set off from where the disks are."""

    def __init__(self, O, places):
        self.O, self.places, self.turns, self.work, self.before = O, iter(places), [0.0, 0.0], 0.0, None

    def __call__(self):
        O, dt = self.O, self.O.dt
        one, two = (O.bodies[k].state for k in (0, 1))
        loads = [np.array(O.forces.f(1, True)), *(O.forces.t(k, True)[2] for k in (0, 1))]
        if self.before is not None:  # work of the step done, by the mean of the loads at its ends
            ways = [np.array(two.vel), one.angVel[2], two.angVel[2]]
            self.work -= sum(0.5 * dt * np.dot(a + b, way) for a, b, way in zip(loads, self.before, ways))
        self.before = loads
        place = next(self.places, None)
        if place is None:
            two.vel = one.angVel = two.angVel = (0, 0, 0)
            return
        x, y, *turns = place
        two.vel = ((x - two.pos[0]) / dt, (y - two.pos[1]) / dt, 0)
        for k, state in enumerate((one, two)):
            state.angVel = (0, 0, (turns[k] - self.turns[k]) / dt)
        self.turns = turns


def loop(steps, overlap, seed):
    """Placements of a smooth closed path of distance, angle and both turns, with random amplitudes."""
    r = random.Random(seed)
    amplitude, phase = [[r.uniform(0.3, 1) for _ in range(4)] for _ in range(2)]
    for k in range(1, steps + 1):
        s = 2 * math.pi * k / steps
        d, theta, phi1, phi2 = (a * (math.sin(s + 6 * p) - math.sin(6 * p)) for a, p in zip(amplitude, phase))
        d = R1 + R2 - overlap - 0.2 * overlap * d
        yield d * math.cos(0.1 * theta), d * math.sin(0.1 * theta), 0.1 * phi1, 0.1 * phi2


def go_around(O, law, steps=1000, overlap=2e-3, seed=1):
    pair(O, overlap)
    walk = Walk(O, loop(steps, overlap, seed))
    engines(O, law, motion=walk)
    largest = 0
    hooks.simulate(steps // 3)
    largest = abs(shear(O))
    hooks.simulate(steps + 2 - steps // 3)
    return shear(O), walk.work, largest


@pytest.mark.parametrize("seed", range(3))
def test_closed_path_leaves_no_force_and_takes_no_work(O, seed):
    """Round-off of 1000 steps, 1e-16 each; the work is a sum by trapezia, off by the square of the step's angle (6e-4 of 0.1 rad)."""
    left, work, far = go_around(O, "path_independent", seed=seed)
    assert far > 10 and abs(left) < 1e-13 * far * math.sqrt(1000)
    assert abs(work) < 1e-5 * far**2 / (2 * KS)


@pytest.mark.parametrize("law", ["standard", "avoid_ratcheting"])
def test_other_laws_do_leave_something(O, law):
    """So that the test above could fail: force or work of parts in a thousand at these overlaps, a fifth of the radius."""
    left, work, far = go_around(O, law)
    assert max(abs(left) / far, abs(work) / (far**2 / (2 * KS))) > 3e-3


def test_pair_turning_as_a_rigid_body_has_no_shear(O):
    """Three turns with the disks fixed to the line of centres: d xi = (R1 + R2 - R1 - R2) d theta = 0, to round-off of forces 2R K_S."""
    d, steps = R1 + R2 - 1e-3, 3000
    angles = [6 * math.pi * k / steps for k in range(1, steps + 1)]
    pair(O, 1e-3)
    walk = Walk(O, [(d * math.cos(a), d * math.sin(a), a, a) for a in angles])
    engines(O, motion=walk)
    hooks.simulate(steps + 1)
    assert O.bodies[1].state.pos[0] == pytest.approx(d, rel=1e-12)
    assert abs(shear(O)) < 1e-14 * (R1 + R2) * KS * steps


def test_stretch_is_the_formula(O):
    """xi of one step of each motion alone; relative 1e-9: differences of angles of 1e-6 rad, each good to 1e-16."""
    d, small = R1 + R2 - 1e-3, 1e-6
    for place, stretch in (((d * math.cos(small), d * math.sin(small), 0, 0), (R1 + R2) * small), ((d, 0, small, 0), -R1 * small),
                           ((d, 0, 0, small), -R2 * small), ((d - 1e-5, 0, 0, 0), 0)):
        O.reset()
        pair(O, 1e-3)
        engines(O, motion=Walk(O, [place]))
        hooks.simulate(2)
        assert shear(O) == pytest.approx(-KS * stretch, rel=1e-9, abs=1e-20)


@pytest.mark.parametrize("order", [False, True])
def test_forces_on_the_disks_are_those_of_virtual_work(O, order):
    """O.forces holds k_n delta n + alpha S t and the torques -R_i S, and nothing of the functor's; order: ids against the direction."""
    overlap, small = 1e-3, 1e-4
    d = R1 + R2 - overlap
    pair(O, overlap, angle=math.pi * order)
    turn = math.pi * order + small
    engines(O, motion=Walk(O, [(d * math.cos(turn), d * math.sin(turn), 0.3 * small, -0.2 * small)]))
    hooks.simulate(2)
    s = -KS * ((R1 + R2) * small - 0.3 * R1 * small + 0.2 * R2 * small)
    n, t = np.array([math.cos(turn), math.sin(turn), 0]), np.array([-math.sin(turn), math.cos(turn), 0])
    force = KN * overlap * n + (R1 + R2) / d * s * t
    # Relative 1e-11: the small angle, 1e-4, comes from positions good to 1e-16.
    assert np.array(O.forces.f(1, True)) == pytest.approx(force, rel=1e-11, abs=1e-9)
    assert np.array(O.forces.f(0, True)) == pytest.approx(-force, rel=1e-11, abs=1e-9)
    assert [O.forces.t(k, True)[2] for k in (0, 1)] == pytest.approx([-R1 * s, -R2 * s], rel=1e-11)


def swing_in_pocket(O, law, dt, time=0.04):
    """A disk under its weight between two fixed ones, set swinging: energies at whole steps [J]; nothing slips (mu = 1000)."""
    mat, mass = plane.material(1e3), 0.8
    for x in (-0.0075, 0.0075):
        plane.disk((x, 0), R1, blocked="xyzXYZ", mat=mat)
    plane.disk((0, 0.0188), R2, mass=mass, velocity=(0.15, 0), spin=20.0, mat=mat)
    weight = 2e3
    engines(O, law, dt, gravity=weight / mass)
    state, energies = O.bodies[2].state, []
    before = None
    for _ in range(round(time / dt)):
        height, slow = state.pos[1], (np.array(state.vel), state.angVel[2])
        O.step()
        if before:  # velocities stand half a step off the forces: the mean of two is of their time, to second order
            v, w = ((a + b) / 2 for a, b in zip(slow, (np.array(state.vel), state.angVel[2])))
            elastic = sum(KN * i.geom.penetrationDepth**2 / 2 + i.phys.shearForce.squaredNorm() / (2 * KS) for i in O.interactions if i.isReal)
            energies.append(0.5 * mass * v @ v + 0.5 * state.inertia[2] * w**2 + elastic + weight * height)
        before = True
    assert all(O.interactions[k, 2].isReal for k in (0, 1))
    return np.array(energies)


def test_energy_is_kept_to_the_second_order_of_the_step(O):
    """Half the step, a quarter of the error (leapfrog), through 20 swings; another law gains or loses energy whatever the step."""
    errors = []
    for dt in (1e-5, 5e-6):
        O.reset()
        energy = swing_in_pocket(O, "path_independent", dt)
        errors.append(np.ptp(energy))
    assert 3.5 < errors[0] / errors[1] < 4.5
    O.reset()
    other = swing_in_pocket(O, "avoid_ratcheting", 5e-6)
    assert np.ptp(other) > 20 * errors[1]


def cloud(O, count, seed, mu):
    """Disks of mixed sizes thrown at their common centre."""
    r, mat, columns = random.Random(seed), plane.material(mu), math.ceil(math.sqrt(count))
    for k in range(count):
        x, y = (0.025 * (j - (columns - 1) / 2) + r.uniform(-1e-3, 1e-3) for j in divmod(k, columns))
        plane.disk((x, y), r.uniform(0.008, 0.012), mass=r.uniform(0.5, 1.5), velocity=(-30 * x + r.uniform(-.2, .2), -30 * y),
                   spin=r.uniform(-30, 30),
                   mat=mat)


@pytest.mark.parametrize("mu", [0, 0.3, 10])
def test_momentum_and_angular_momentum_are_kept(O, mu):
    """25 colliding disks, contacts made, slipping and lost: to the round-off of 3000 steps, as a sum of random signs."""
    cloud(O, 25, 1, mu)
    before, size = plane.momenta(), sum(b.state.mass * b.state.vel.norm() for b in O.bodies)
    engine, touched, slid = engines(O), 0, 0
    for _ in range(30):
        O.run(100, True)
        touched, slid = touched + engine.contacts, slid + engine.slidingContacts
    assert touched > 100 and (slid > 0 or mu != 0.3) and (slid == 0 or mu > 0)
    assert plane.momenta() == pytest.approx(before, abs=1e-15 * size * math.sqrt(3000) * 10)


def test_slip_is_clipped_at_the_coulomb_limit(O):
    """|S| = mu k_n delta to the last bit but one, the memory holds the clipped force, and going back unloads from there."""
    overlap, d = 1e-3, R1 + R2 - 1e-3
    pair(O, overlap, mu=0.5)
    turn = 1e-2  # a stretch of 2.2e-4 m, 110 N against the limit of 0.5 1000 N... beyond it after five such turns
    places = [(d * math.cos(k * turn), d * math.sin(k * turn), 0, 0) for k in range(1, 11)]
    engine = engines(O, motion=Walk(O, places + [places[-2]]))
    hooks.simulate(11)
    normal = O.interactions[0, 1].phys.normalForce.norm()
    assert normal == pytest.approx(KN * overlap, rel=1e-12)
    assert -shear(O) == pytest.approx(0.5 * normal, rel=1e-15) and engine.slidingContacts == 1
    hooks.simulate(1)
    assert engine.slidingContacts == 0
    assert shear(O) == pytest.approx(-0.5 * normal + KS * (R1 + R2) * turn, rel=1e-12)


def test_without_friction_there_is_no_shear_and_no_slip(O):
    pair(O, 1e-3, mu=0)
    d = R1 + R2 - 1e-3
    engine = engines(O, motion=Walk(O, [(d * math.cos(0.1), d * math.sin(0.1), 0, 0)]))
    hooks.simulate(2)
    assert engine.contacts == 1 and engine.slidingContacts == 0 and shear(O) == 0


def test_a_contact_that_ends_is_forgotten(O):
    """Loaded, parted, closed again: the spring begins anew, without what it had."""
    d, apart = R1 + R2 - 1e-3, R1 + R2 + 1e-4
    pair(O, 1e-3)
    back = [(d * math.cos(0.01), d * math.sin(0.01), 0, 0)]
    engine = engines(O, motion=Walk(O, back + [(apart * math.cos(0.01), apart * math.sin(0.01), 0, 0)] * 2 + back))
    hooks.simulate(2)
    assert abs(shear(O)) > 1 and engine._pairIds == [0, 1]
    assert engine._pairForces == pytest.approx([shear(O)], rel=1e-15)  # here by way of n.n, which is 1 to round-off
    hooks.simulate(2)
    assert engine.contacts == 0 and engine._pairIds == []
    hooks.simulate(1)
    assert engine.contacts == 1 and abs(shear(O)) < 1e-9  # radial return: the functor finds no way aside


def test_a_contact_made_anew_is_new_whatever_its_pair_had_before(O):
    """Erased by hand it is back in the next step, unloaded. A clock that is set back afterwards makes no contact new."""
    d = R1 + R2 - 1e-3
    pair(O, 1e-3)
    turned = [(d * math.cos(0.01 * k), d * math.sin(0.01 * k), 0, 0) for k in (1, 1, 1, 2)]
    engines(O, motion=Walk(O, turned))
    hooks.simulate(2)
    assert abs(shear(O)) > 1
    O.interactions.erase(0, 1)
    hooks.simulate(1)
    assert abs(shear(O)) < 1e-9
    O.resetTime()
    assert O.interactions[0, 1].iterMadeReal > O.iter
    hooks.simulate(3)
    assert shear(O) == pytest.approx(-KS * (R1 + R2) * 0.01, rel=1e-3)


def box_of_disks(O, gravity):
    """25 equal disks in a triangular pile between walls, with friction, at rest but for their weight."""
    mat, radius = plane.material(0.5), 0.01
    for position, half in (((0, -0.01), (0.2, 0.01)), ((-0.06, 0.05), (0.01, 0.1)), ((0.06, 0.05), (0.01, 0.1))):
        O.bodies.append(utils.box((*position, 0), (*half, 0.5), fixed=True, material=mat))
    r = random.Random(3)
    for row in range(5):
        for k in range(5 - row % 2):
            plane.disk(((2 * k - 4 + row % 2) * radius + r.uniform(-1e-6, 1e-6), radius * (1 + 1.732 * row)), radius, mat=mat, spin=r.uniform(-1, 1))
    return gravity


def states(O):
    return [(tuple(b.state.pos), tuple(b.state.vel), tuple(b.state.angVel)) for b in O.bodies]


def reloaded(O, path, steps):
    """States after `steps` of the scene as it stands, and of the scene saved and loaded."""
    before = plane.everything_in(O.engines[3])
    assert any(before["_pairForces"])
    O.save(path)
    O.run(steps, True)
    whole = states(O)
    O.load(path)
    assert plane.everything_in(O.engines[3]) == before
    O.run(steps, True)
    return np.array(whole), np.array(states(O))


def test_loaded_scene_continues_bitwise(O, tmp_path):
    swing_in_pocket(O, "path_independent", 1e-5, time=0.01)
    whole, again = reloaded(O, str(tmp_path / "half.yade.gz"), 1000)
    assert (whole == again).all()


def test_loaded_pile_continues(O, tmp_path):
    """To round-off: after loading YADE's collider begins anew and lists the contacts in another order, in which forces are then summed."""
    gravity = box_of_disks(O, 9.81)
    engine = engines(O, dt=5e-5, gravity=gravity)
    O.run(400, True)
    assert engine.contacts > 30
    whole, again = reloaded(O, str(tmp_path / "half.yade.gz"), 20)
    assert again == pytest.approx(whole, abs=1e-14)


@pytest.mark.parametrize("place", [3, 4])
def test_forces_summed_up_on_the_way_are_not_counted_twice(O, place):
    """Whoever reads O.forces between the engines makes YADE sum up what is pending; the motion stays the same to the bit."""
    found = []
    for reading in (False, True):
        O.reset()
        gravity = box_of_disks(O, 9.81)
        engines(O, dt=5e-5, gravity=gravity)
        if reading:
            O.engines = O.engines[:place] + [hooks.runner(lambda: O.forces.f(3, True), iterPeriod=1, initRun=True)] + O.engines[place:]
        hooks.simulate(200)
        found.append(states(O))
    assert found[0] == found[1]


def test_equals_the_standard_law_to_the_first_order_of_the_overlap(O):
    """The pile settling: spring forces differ by delta/R relative to the largest, and with a tenth of the weight by a tenth of that."""
    differences = []
    for gravity in (9.81, 0.981):
        found = []
        for law in ("standard", "path_independent"):
            O.reset()
            box_of_disks(O, gravity)
            for b in O.bodies:
                b.state.angVel = (0, 0, 0)
            engines(O, law, dt=5e-5, gravity=gravity)
            O.run(300, True)
            found.append({(i.id1, i.id2): np.array(i.phys.shearForce) for i in O.interactions if i.isReal and i.id1 > 2})
        assert found[0].keys() == found[1].keys() and len(found[0]) > 20
        largest = max(np.linalg.norm(f) for f in found[0].values())
        differences.append(max(np.linalg.norm(found[0][k] - found[1][k]) for k in found[0]) / largest)
    overlap = max(i.geom.penetrationDepth for i in O.interactions if i.isReal) / 0.01
    assert 0 < differences[1] < 10 * overlap
    assert differences[0] < 0.1


def test_a_packing_goes_on_from_the_forces_it_has(O):
    """Switched on in a loaded contact, the engine takes its shear force over; after a pause it does so again."""
    d = R1 + R2 - 1e-3
    pair(O, 1e-3)
    places = [(d * math.cos(1e-3 * k), d * math.sin(1e-3 * k), 0, 0) for k in range(1, 9)]
    engine = engines(O, motion=Walk(O, places))
    engine.dead = True
    hooks.simulate(4)
    usual = shear(O)
    engine.dead = False
    hooks.simulate(1)  # the functor's fourth step, taken over
    step = KS * d * math.sin(1e-3)
    assert shear(O) == pytest.approx(usual - step, rel=1e-6)
    hooks.simulate(1)
    assert shear(O) == pytest.approx(usual - step - KS * (R1 + R2) * 1e-3, rel=1e-6)
    engine.dead = True
    hooks.simulate(2)
    engine.dead = False
    hooks.simulate(1)
    assert engine._lastStep == O.iter - 1
    # The functor turns the old force by a first-order rotation, which lengthens it by 5e-7 in each of these steps.
    assert shear(O) == pytest.approx(usual - 4 * step - KS * (R1 + R2) * 1e-3, rel=4e-6)


def test_walls_keep_the_usual_force(O):
    """A disk on a box: no contact of this engine's, and the functor's shear force is on the disk."""
    mat = plane.material(10)
    plane.box((0, -0.1), (1, 0.1), mat=mat)
    plane.disk((0, 0.0099), 0.01, velocity=(1e-3, 0), blocked="yzXYZ", mat=mat)
    engine = engines(O)
    O.run(3, True)
    contact = O.interactions[0, 1]
    assert engine.contacts == 0 and contact.phys.shearForce[0] != 0
    assert O.forces.f(1, True)[0] == pytest.approx(contact.phys.shearForce[0], rel=1e-12)
