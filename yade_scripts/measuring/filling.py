"""What the maps of flows share: the mean height of fillings of a box, judged by that of rigid grains with short steps. `judge` runs inside YADE."""
import functools
import math
import statistics

from yade_scripts.measuring.maps import INACCURATE, NOT_SOLVED, Outcome, UNSTABLE, judged

FLOW = dict(scene="filling", disks=200, period=0.8, records_per_cycle=20)
SEEDS = 1, 2, 3
TRUTH = dict(method="CD", cd_dt=2.5e-4, tolerance=1e-4)
OFF, FAR_OFF = 0.03, 0.2  # of the height. Means of three seeds differ by 1 % by chance
DEEP = 0.1  # largest overlap over the mean radius
CRITERION = ("200 disks fall into a box; means of three seeds. Inaccurate: the height of the filling differs by more than 3 % from that of rigid "
             "grains with steps of 0.25 ms and a tolerance of 1e-4, or disks overlap by more than a tenth of the radius. Unstable: by more than "
             "20 %, or a run ends as unstable.")
MEASURES = {"height": "mean height of the filling over that of disks without pores", "overlap": "largest overlap over the mean radius"}


def fill(seed, **row):
    """Return (height, largest overlap over the mean radius, of MD at samples, steps that were not solved, what the program tells) of a filling."""
    from cd_engine import watching
    from yade_scripts import parameters, run, scenes
    from yade_scripts.measuring import rigid
    from yade_scripts.running import bodies, hooks
    row = FLOW | dict(seed=seed) | row
    scene, deepest, radius = run.start(**row), [], parameters.complete(row)["radius_mean"]
    if row["method"] == "MD":
        scene.observer = lambda: deepest.append(max((contact.geom.penetrationDepth for contact in bodies.contacts()), default=0.0))
    scenes.method(row).run(scene)
    watching.of_scene(hooks.OBSERVERS).check()
    height = scene.extra["height"][2]()
    if row["method"] == "MD":
        return height, max(deepest) / radius, 0, ""
    engine = hooks.engine("ContactDynamics")
    told = rigid.told(engine, min(body.shape.radius for body in bodies.disks()))
    return height, engine.deepestPenetration / radius, engine.unconvergedSteps, told


@functools.cache
def true_height():
    return statistics.fmean(fill(seed, **TRUTH)[0] for seed in SEEDS)


def judge(**row):
    """Return the Outcome of a setting."""
    from cd_engine import watching
    try:
        heights, overlaps, missed, told = zip(*(fill(seed, **row) for seed in SEEDS))
    except watching.Unstable as error:
        return Outcome(UNSTABLE, "penetration" if "overlap" in str(error) else "energy growth", str(error), dict.fromkeys(MEASURES, math.nan))
    measures = {"height": statistics.fmean(heights), "overlap": max(overlaps)}
    error = abs(measures["height"] / true_height() - 1)
    return judged(measures, next(filter(None, told), ""), (UNSTABLE, "wrong motion", not error <= FAR_OFF),
                  (NOT_SOLVED, "non-convergence", any(missed)), (INACCURATE, "penetration", measures["overlap"] > DEEP),
                  (INACCURATE, "wrong motion", error > OFF))
