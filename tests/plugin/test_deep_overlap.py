"""Bodies that pass into each other are said, also where the solver believes its error."""
import pytest

from . import plane

G = 9.81


def pile(O, ratio, steps, **settings):
    """A disk of `ratio` times the mass on a disk of 1 kg on a floor, from rest and without forces; the engine."""
    mat = plane.material()
    plane.floor(mat)
    plane.disk((0, 0.01), 0.01, mass=1, mat=mat)
    plane.disk((0, 0.03), 0.01, mass=ratio, mat=mat)
    return plane.run(steps, 1e-3, gravity=(0, -G, 0), **settings)


def test_a_heavy_disk_that_falls_through_a_light_one_is_said_once(O, capfd):
    """e is over all impulses: 1e-4 of them is little until the light disk has been given 1e6 times its own weight. Every step counts as
    solved, and the heavy disk falls freely, 20 steps of g dt^2 each longer than the last (as overlaps count, at mid-step)."""
    engine = pile(O, 1e6, 20, tolerance=1e-4)
    assert engine.unconvergedSteps == 0 and engine.converged
    free = G * (20e-3)**2 / 2
    assert 0.8 * free < engine.deepestPenetration <= free * 1.01
    said = capfd.readouterr().err
    assert said.count("two bodies overlap by") == 1 and "of the smallest radius" in said


def test_few_fixed_sweeps_are_said_too(O, capfd):
    """One sweep a step asks for no error at all; a cold start hands the upper weight on in no step."""
    engine = pile(O, 100, 60, fixedIterations=1, warmStart=False)
    assert engine.deepestPenetration > 1e-4 and "two bodies overlap by" in capfd.readouterr().err


@pytest.mark.parametrize("ratio", [1, 100])
def test_what_is_solved_is_not_warned_of(O, capfd, ratio):
    engine = pile(O, ratio, 20, tolerance=1e-8)
    # What a tolerance of 1e-8 leaves of the free fall, times the ratio of the masses, with room for round-off.
    assert engine.deepestPenetration < 1e-7 and "overlap" not in capfd.readouterr().err


def test_the_deepest_overlap_is_kept_when_the_bodies_part(O):
    """maxPenetration is of the last step, deepestPenetration of all, through O.save as well."""
    import yade
    engine = pile(O, 1e6, 20, tolerance=1e-4)
    deepest = engine.deepestPenetration
    for body in list(O.bodies)[1:]:
        body.state.pos = (10.0 * body.id, 5, 0)
        body.state.vel = (0, 0, 0)
    O.run(2, True)
    assert engine.maxPenetration == 0 and engine.deepestPenetration == deepest
    O.saveTmp()
    O.loadTmp()
    assert yade.O.engines[-1].deepestPenetration == deepest
