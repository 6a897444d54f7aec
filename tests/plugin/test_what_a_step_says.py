"""The reported forces of a step are those that moved its bodies, also when a body comes to rest; a problem solved to the last digit is solved."""
import math

import numpy as np
import pytest
import yade

from cd_engine import engine_methods

from . import plane

G = 9.81


@pytest.mark.parametrize("height", (0.0102, 0.0121, 0.0139, 0.0157))
def test_forces_move_the_bodies_when_an_island_is_stopped(O, height):
    """A disk dropped beside one at rest: in every step m (v' - v) = dt F, F the total in O.forces. Round-off is 1e-15 of m g dt and of the momentum;
    an island that is stopped keeps a hundredth of the tolerance of what its contacts' impulses make."""
    plane.columns(0, disks=1)
    falling = plane.disk((0.1, height), 0.01)
    engine = plane.run(1, 1e-3, gravity=(0, -G, 0))
    for step in range(100):
        before = np.array(O.bodies[falling].state.vel)
        O.step()
        after = np.array(O.bodies[falling].state.vel)
        force = np.array(O.forces.f(falling))
        assert np.abs(after - before - O.dt * force).max() <= 1e-14 + 0.01 * engine.tolerance * max(abs(before[1]), G * O.dt), step
    assert engine.sleeping == 2


@pytest.mark.parametrize("seed", range(3))
def test_touching_disks_that_spin_in_free_fall_are_solved(O, seed):
    """They fall and turn alike, so that the contact carries nothing but round-off, which is no violation."""
    draw = np.random.default_rng(seed)
    angle, speed, spin = draw.uniform(0, 2 * math.pi), draw.uniform(-3, 3, 2), draw.uniform(-50, 50)
    mat = plane.material(draw.uniform(0, 1))
    for side in (-1, 1):
        plane.disk((side * 0.01 * math.cos(angle), side * 0.01 * math.sin(angle)), 0.01, mat=mat, velocity=speed, spin=spin * side)
    engine = plane.run(1, 1e-3, gravity=(0, -G, 0))
    for _ in range(40):
        yade.O.step()
        assert engine.converged and engine.residual < 1, (engine.status, engine.residual)
    assert engine.unconvergedSteps == 0


def test_a_summary_of_given_sweeps_claims_no_tolerance(O):
    plane.columns(1, disks=30)
    engine = plane.run(20, 1e-3, gravity=(0, -G, 0), fixedIterations=2)
    said = engine_methods.text(engine)
    assert "All 20 steps: no tolerance is asked for" in said and "missed" not in said
