"""A prepared packing with free walls, sigma2 5 % up at once."""
from yade import O

from yade_scripts import bodies, cd, hooks, parameters, prepare, results, scenes, walls
from yade_scripts.maps import INACCURATE, NOT_SOLVED, STABLE, UNSTABLE, Outcome
from yade_scripts.maps.probes import rigid

DISKS, STEPS, RISE = 100, 50, 0.05
STRAIN, LARGE_STRAIN = 1e-6, 1e-3
FOLDER = results.FOLDER  # of prepared packings


def probe(case):
    """See the map of this name."""
    full = parameters.complete({"disks": DISKS, "method": "CD", "tolerance": case["tolerance"]})
    path, _ = prepare.ensure(parameters.complete({"disks": DISKS}), FOLDER)
    O.load(str(path))
    O.dt = case["dt"]
    before = walls.sides()
    p0 = parameters.pressure(full)
    walls.set_free(full["wall_mass_ratio"] * bodies.mean_mass())
    scene = scenes.Scene(every=STEPS, samples=1)
    cd.set_engines(full, scene, lambda t: (p0, (1 + RISE) * p0))
    hooks.simulate(STEPS)
    engine = scene.watch.engine
    strain = [now / length - 1 for now, length in zip(walls.sides(), before)]
    measures = {"gamma": strain[1] - strain[0], "unconverged": engine.unconvergedSteps / STEPS, "sweeps": engine.totalIterations / STEPS}
    told = rigid.told(engine, min(body.shape.radius for body in bodies.disks()))
    if abs(measures["gamma"]) > LARGE_STRAIN:
        return Outcome(UNSTABLE, "false motion", told, measures)
    if engine.unconvergedSteps:
        return Outcome(NOT_SOLVED, "non-convergence", told, measures)
    if abs(measures["gamma"]) > STRAIN:
        return Outcome(INACCURATE, "false motion", told, measures)
    return Outcome(STABLE, measures=measures)
