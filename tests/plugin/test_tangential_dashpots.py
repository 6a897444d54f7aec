"""TangentialDashpots: eq. 6's dashpot, against the damped oscillator, Coulomb's limit, and the energy that is lost."""
import math

import pytest
from yade import wrapper as w

import cd_engine
from cd_engine import springs

from . import plane

RADIUS, STIFFNESS, RATIO = 0.01, 1e6, 0.5  # m, N/m, k_t/k_n
PRESSED = 1e-3  # overlap over the radius


def pair(O, mu, damping, ratio):
    """Two disks that overlap, the first fixed, the second held at its height; the normal dashpots have the damping ratio `damping`."""
    plane.disk((0, 0), RADIUS)
    plane.disk((0, (2 - PRESSED) * RADIUS), RADIUS)
    O.bodies[0].state.blockedDOFs = "xyzXYZ"
    O.bodies[1].state.blockedDOFs = "yzXYZ"
    O.engines = plane.viscous_springs(STIFFNESS, RATIO, damping, mu) + [cd_engine.TangentialDashpots(ratio=ratio), w.NewtonIntegrator(damping=0)]
    mass = O.bodies[1].state.mass
    omega = math.sqrt(RATIO * STIFFNESS / mass)
    O.dt = 1e-3 / omega
    O.step()  # the contact is there
    return mass, omega, O.interactions[0, 1].phys.cn


@pytest.mark.parametrize("damping, ratio", [(0.1, 1.0), (0.1, 3.0), (0.3, 0.5), (0.1, 0.0)])
def test_a_contact_that_sticks_swings_as_a_damped_oscillator(O, damping, ratio):
    """Of the mass m, the spring k_t and the dashpot ratio c_n: x = v0 exp(-z w t) sin(w' t)/w'. Steps of 1e-3/w; the normal turns by x/2R = 1e-7."""
    mass, omega, cn = pair(O, 2.0, damping, ratio)
    z, speed = ratio * cn / (2 * mass * omega), 1e-9 * omega
    O.bodies[1].state.vel = (speed, 0, 0)
    turning, start = omega * math.sqrt(1 - z**2), O.bodies[1].state.pos[0]
    for _ in range(5):
        O.run(1000, True)
        t = (O.iter - 1) * O.dt
        exact = speed * math.exp(-z * omega * t) * math.sin(turning * t) / turning
        assert O.bodies[1].state.pos[0] - start == pytest.approx(exact, abs=2e-3 * speed / omega)  # dashpots see the speed of half a step before


def test_the_energy_that_is_lost(O):
    """Of a swing that has died away: the kinetic energy that it began with."""
    mass, omega, cn = pair(O, 2.0, 0.3, 1.0)
    speed = 1e-9 * omega
    O.bodies[1].state.vel = (speed, 0, 0)
    O.run(40000, True)
    assert O.engines[3].work == pytest.approx(mass * speed**2 / 2, rel=2e-3)  # first order in steps of 1e-3/w


def test_a_contact_that_slides_is_at_the_limit(O):
    """The dashpot alone would be stronger than Coulomb's limit; sliding steadily, the total is mu times the normal force."""
    mass, omega, cn = pair(O, 0.1, 0.1, 10.0)
    limit = 0.1 * STIFFNESS * PRESSED * RADIUS
    speed = 3 * limit / (10 * cn)
    O.bodies[1].state.vel = (speed, 0, 0)
    for _ in range(3):
        O.step()
        assert O.forces.f(1)[0] == pytest.approx(-limit, rel=1e-4)  # from the first step on; the normal has turned by some 1e-5
        assert abs(O.interactions[0, 1].phys.shearForce[0]) <= limit * (1 + 1e-9)
    assert O.forces.t(1)[2] == pytest.approx(-limit * (1 - PRESSED / 2) * RADIUS, rel=1e-4)  # the contact lies below its centre: it turns clockwise
    assert O.forces.f(0)[0] == pytest.approx(limit, rel=1e-4)


def test_a_step_of_no_time_only_makes_contacts(O):
    """O.dt = 0 makes contacts without motion, as scripts do before the first step."""
    mass, omega, cn = pair(O, 2.0, 0.1, 1.0)
    O.dt = 0
    O.step()
    assert O.forces.f(1)[0] == 0 and O.forces.f(1)[1] == pytest.approx(STIFFNESS * PRESSED * RADIUS) and O.engines[3].work == 0


def test_a_time_stepper_before_it_is_refused(O):
    """The slip that it reads belongs to the step before the change."""
    pair(O, 2.0, 0.1, 1.0)
    O.engines = O.engines[:3] + [w.GlobalStiffnessTimeStepper()] + O.engines[3:]
    with pytest.raises(RuntimeError, match="GlobalStiffnessTimeStepper between.*right behind InteractionLoop"):
        O.step()


def test_the_stable_step_counts_them(O):
    """s = w dt < 2 (sqrt(1 + z^2) - z) (springs.py), w and z of the tangential swing, which is the only free one."""
    mass, omega, cn = pair(O, 2.0, 0.1, 0.0)
    for ratio in (0.0, 10.0):
        O.engines[3].ratio = ratio
        z = ratio * cn / (2 * mass * omega)
        assert springs.limit() == pytest.approx(2 * (math.sqrt(1 + z**2) - z) / omega, rel=1e-3)  # found by bisection to 1e-4


def test_it_survives_saving(O, tmp_path):
    O.engines = [cd_engine.TangentialDashpots(ratio=0.5, work=0.25)]
    O.save(str(tmp_path / "scene.yade.gz"))
    O.reset()
    O.load(str(tmp_path / "scene.yade.gz"))
    assert (O.engines[0].ratio, O.engines[0].work) == (0.5, 0.25)


@pytest.mark.parametrize("ratio", [-1.0, math.inf, math.nan])
def test_refused(O, ratio):
    with pytest.raises(ValueError, match="ratio=.* is out of range: it must be at least 0"):
        cd_engine.TangentialDashpots(ratio=ratio)
