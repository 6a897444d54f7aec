"""The collider rests while displacements stay within its margin; that changes cost and nothing else."""

import pytest

from . import plane
from .test_invariants import cloud, digest, heap


def run(O, margin, steps, **settings):
    """Engines with bounds larger by a tenth in either case; margin 0: the collider runs in every step. The collider."""
    import cd_engine
    engines = cd_engine.engines(tolerance=1e-9, maxIterations=100000, **settings)
    engines[-1].colliderMargin = margin
    O.engines = engines
    O.dt = 1e-3
    O.run(steps, True)
    return engines[1]


@pytest.mark.parametrize("scene, settings", [
    (lambda O: heap(O, mu=0.3), dict(gravity=(0, -9.81, 0))),
    (lambda O: cloud(O, 40, seed=6, speed=3), {}),
], ids=["falling heap", "fast cloud"])
def test_results_are_the_same_to_the_last_bit(O, scene, settings):
    """Over motions of many radii, so that the collider is woken many times."""
    hashes = []
    for margin in (0, 0.1):
        O.reset()
        scene(O)
        run(O, margin, 400, **settings)
        hashes.append(digest(O))
    assert hashes[0] == hashes[1]


def test_it_rests_within_a_run_and_is_awake_after_it(O):
    heap(O, mu=0.3)
    O.timingEnabled = True
    try:
        collider = run(O, 0.1, 1500, gravity=(0, -9.81, 0))  # at rest at the end
        before = collider.execCount
        O.run(200, True)
        assert collider.execCount - before == 1  # the first step of a run
        assert not collider.dead
    finally:
        O.timingEnabled = False


@pytest.mark.parametrize("change", ["move a disk by hand", "append a disk", "grow a disk"])
def test_what_the_user_changes_between_or_within_runs_is_noticed(O, change):
    """A new contact that only a run of the collider can find."""
    import yade
    mat = plane.material()
    plane.floor(mat)
    low = plane.disk((0, 0.1), 0.1, mat=mat)
    far = plane.disk((1, 0.1), 0.1, mass=2.0, mat=mat)

    def act():
        if yade.O.iter != 20:
            return
        if change == "move a disk by hand":
            O.bodies[far].state.pos = (0, 0.3, 0)
        elif change == "append a disk":
            plane.disk((0, 0.3), 0.1, mass=2.0, mat=mat)
        else:
            O.bodies[far].shape.radius = 0.9

    yade.runtime.act = act
    import cd_engine
    reset, collider, cd = cd_engine.engines(gravity=(0, -9.81, 0), tolerance=1e-12)
    O.engines = [reset, yade.PyRunner(command="import yade; yade.runtime.act()", iterPeriod=1, initRun=True), collider, cd]
    O.dt = 1e-3
    O.run(40, True)
    if change == "grow a disk":
        assert O.interactions.has(low, far)  # known to the engine; nothing presses them together
    else:
        top = far if change == "move a disk by hand" else len(O.bodies) - 1
        assert O.interactions[low, top].phys.normalForce.norm() == pytest.approx(2 * 9.81)
