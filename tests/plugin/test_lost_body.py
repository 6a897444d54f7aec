"""A body that is fast and far from all others makes only its own search more expensive; the first that leaves the scene for ever is named."""
import pytest

import cd_engine

from . import plane


def bed(disks, settings, **moving):
    mat = plane.material()
    plane.box((0.2, -0.01), (0.3, 0.01), mat=mat)
    plane.grid(disks, 20, (0, 0.01), (0.021, 0.02), mat)
    return plane.disk(radius=0.01, mat=mat, **moving), cd_engine.engines(gravity=(0, -9.81, 0), **settings)


def test_a_lost_body_is_named_once_and_widens_nothing(O, capfd):
    lost, O.engines = bed(60, {}, position=(0.7, 0))
    O.dt = 1e-3
    O.run(2000, True)
    lines = [line for line in capfd.readouterr().err.splitlines() if line.startswith("ContactDynamics: ")]
    assert len(lines) == 1 and f"body #{lost} has left the scene" in lines[0] and f"O.bodies.erase({lost})" in lines[0]
    assert O.bodies[lost].state.pos[1] < -15
    O.bodies.erase(lost)
    O.run(100, True)
    assert O.engines[2].converged


@pytest.mark.parametrize("settings", [{}, dict(restitution=0.5)], ids=["plain", "bouncing"])
def test_it_hits_what_it_comes_to(O, capfd, settings):
    """A fast disk hits a bed: the motion has the same bits as with bounds that are always wide."""
    found = []
    for margin in (0.1, 10):
        O.reset()
        bullet, O.engines = bed(60, dict(settings, searchMargin=margin, tolerance=1e-6), position=(0.2, 3), velocity=(0.5, -20))
        O.dt = 1e-3
        O.run(100, True)
        O.run(200, True)
        assert O.bodies[bullet].state.pos[1] > 0 and O.engines[2].deepestPenetration < (0.02 if settings else 1e-4)
        found.append(plane.digest())
    assert "left the scene" not in capfd.readouterr().err  # it flies up high and comes back
    assert found[0] == found[1]


@pytest.mark.parametrize("settings", [{}, dict(tolerance=1e-16), dict(fixedIterations=5)], ids=["converges", "stagnates", "fixed"])
@pytest.mark.parametrize("presses", [False, True])
def test_an_impact_is_passed_on_whatever_the_margin(O, settings, presses):
    """A fast heavy disk hits a light one, which in the same step reaches a third that lies beyond its margin. In half of the cases another disk, far
    away, is pressed flat, so that no step has a solution."""
    found = []
    for margin in (0.1, 10):
        O.reset()
        mat = plane.material(0.3)
        for x, radius, mass in ((0, 0.05, 10), (0.081, 0.005, 0.01), (0.097, 0.005, 1000)):
            plane.disk((x, 0), radius, mass=mass, mat=mat)
        if presses:
            plane.disk((0, -5), 0.01, mass=1, mat=mat)
            for side in (-1, 1):
                O.bodies[plane.box((0, -5 + 0.011 * side), (0.1, 0.001), mat=mat)].state.vel = (0, -side, 0)
        plane.run(2, 1e-3, searchMargin=margin, **{"tolerance": 1e-6, **settings})
        O.bodies[0].state.vel = (50, 0, 0)
        O.run(3, True)
        assert O.bodies[1].state.pos[0] + 0.0099 < O.bodies[2].state.pos[0]
        found.append(plane.digest())
    assert found[0] == found[1]
