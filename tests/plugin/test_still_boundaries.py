"""Steps pass over boundaries that nothing moves: what they leave out is seen again as soon as somebody may have changed it."""
import pytest
import yade
from yade import utils, wrapper

from . import plane
from .test_publish import both


def boxes(O):
    """A floor of five boxes, #0 to #4, and disks that fall onto it."""
    mat = plane.material()
    for k in range(5):
        plane.box((0.1 * k, -0.02), (0.05, 0.02), mat=mat)
    plane.grid(40, 10, (0.02, 0.012), (0.041, 0.022), mat)


def facets(O):
    """The same floor of facets, two a square, and spheres that fall onto it."""
    mat = plane.material()
    for k in range(5):
        corner = [yade.Vector3(0.1 * (k + x) - 0.05, 0, z) for x, z in ((0, -0.2), (1, -0.2), (1, 0.2), (0, 0.2))]
        O.bodies.append([utils.facet([corner[i] for i in of], material=mat) for of in ((0, 1, 2), (0, 2, 3))])
    for k in range(40):
        O.bodies.append(utils.sphere((0.02 + 0.041 * (k % 10), 0.012 + 0.022 * (k // 10), 0.003 * (k % 3)), 0.01, material=mat))


@pytest.mark.parametrize("build", [boxes, facets])
def test_boundaries_that_begin_to_move_and_stop(O, build):
    """What a step has found of boundaries at rest it does not look at again, until somebody may have changed them: by an engine that moves them (its
    velocity is 0 in its first step) within a run, and by hand between two runs."""
    def run(engine):
        shaker = wrapper.HarmonicMotionEngine(ids=[1], A=(0, 0.005, 0), f=(0, 8, 0), fi=(0, 0, 0))
        slide = wrapper.TranslationEngine(ids=[2], translationAxis=(0, -1, 0), velocity=0.05, dead=True)
        O.engines = [*O.engines[:2], shaker, slide, engine]
        floor, found = O.bodies, []

        def after(steps):
            O.run(steps, True)
            found.append((plane.digest(), engine.contacts, engine.totalIterations))

        after(40)
        assert O.bodies[1].state.pos[1] != -0.02
        slide.dead = False
        after(30)
        slide.dead = True
        floor[2].state.vel = (0, 0, 0)
        after(20)
        floor[3].state.pos -= (0, 0.003, 0)
        after(30)
        floor[0].state.vel = (0.1, 0.02, 0)
        after(30)
        floor[0].state.vel = (0, 0, 0)
        floor[4].groupMask = 2
        after(60)
        O.bodies.erase(3)
        after(60)
        return found

    found = both(O, run, build=build)
    assert len({digest for digest, *_ in found}) == len(found) and all(contacts for _, contacts, _ in found)
