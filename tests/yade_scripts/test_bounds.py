"""Runs watch themselves: what leaves its bounds ends the run, with the reason and the step."""
import math

import pytest

from yade_scripts import parameters
from cd_engine import Unstable
from yade_scripts.running.bounds import BALANCE, Bounds, CREATED, OutOfBounds

FULL = {method: parameters.complete({"method": method}) for method in ("MD", "CD")}
SCALE = Bounds(FULL["MD"], True).scale
SOUND = dict(time=0.5, gamma=-1e-4, sigma1=1200.0, sigma2=1300.0, kinetic_energy=0.2, dissipated_energy=0.2, stored_energy=0.1, wall_work=0.5,
             max_penetration=1e-4,
             unbalanced_force=math.nan, friction_dissipation=0.3, residual_max=1e-6)


def look(method, loaded=True, fixed=0, **changed):
    bounds = Bounds(FULL[method] | {"fixed_iterations": fixed}, loaded)
    bounds.look(SOUND | dict(kinetic_energy=0.0, dissipated_energy=0.0, stored_energy=0.0, wall_work=0.0), 0)
    bounds.look(SOUND | changed, 70)


@pytest.mark.parametrize("method", ["MD", "CD"])
def test_a_sound_run_passes(method):
    look(method)
    look(method, loaded=False, gamma=math.nan, wall_work=0.0)


@pytest.mark.parametrize("method, changed, words", [
    ("MD", {"kinetic_energy": math.nan}, "kinetic_energy is nan"), ("CD", {"gamma": math.inf}, "gamma is inf"),
    ("CD", {"residual_max": math.inf}, "residual_max is inf"), ("CD", {"residual_max": 1.01}, "no solution"),
    ("MD", {"wall_work": 0.3 - 1.01 * CREATED * SCALE}, "were created"), *[
        ("CD", {"wall_work": 0.5 + sign * 1.01 * BALANCE * SCALE}, "energy balance is off") for sign in (1, -1)]])
def test_what_leaves_its_bounds_is_named_with_its_step(method, changed, words):
    with pytest.raises((OutOfBounds, Unstable), match=f"^step 70, t = 0.5 s: .*{words}"):
        look(method, **changed)


def test_few_sweeps_may_be_far_off():
    look("CD", fixed=5, residual_max=2.0)


# A disk's speed becomes no number in step 50 of 2 x 100 and more; CD refuses that step, MD sees it at the next sample.
@pytest.mark.parametrize("method", ["MD", "CD"])
def test_a_run_ends_where_a_nan_comes_up(yade60, method):
    row = dict(method=method, disks=60, period=0.2, records_per_cycle=2, cd_dt=1e-3, delta_sigma=0.3)
    said = yade60.code(f"""
from yade import O
from yade_scripts import parameters, results, run, scenes
from yade_scripts.running import hooks
build = scenes.build
def spoiled(full, folder):
    scene = build(full, folder)
    def spoil():
        if O.iter == 50:
            O.bodies[20].state.vel = (float("nan"), 0, 0)
    O.engines = [hooks.runner(spoil, iterPeriod=1, initRun=True)] + O.engines
    return scene
scenes.build = spoiled
status = run.execute({row!r}, "results")
path = results.path_of(parameters.complete({row!r}), "results")
print(json.dumps([status, results.status(path), path.exists(), O.iter]))
""")
    assert said[0] == 1 and said[1].startswith("unstable: " if method == "MD" else "failed: ") and said[2]
    assert "step" in said[1]
    if method == "CD":
        assert said[3] <= 52
