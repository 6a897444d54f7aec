"""Map of CD: time step against tolerance, for a packing that must bear a small load without moving."""
from yade_scripts import parameters, scenes
from yade_scripts.measuring.maps import Axis, INACCURATE, Map, NOT_SOLVED, TOLERANCES, UNSTABLE, judged, lines, logarithmic, product

DISKS, STEPS, RISE = 100, 50, 0.05
STRAIN, LARGE_STRAIN = 1e-6, 1e-3
TRIED = {True: logarithmic(1e-5, 1e-2, 7), False: logarithmic(1e-4, 1e-2, 3)}  # steps of the full and of the quick map

MAP = Map(
    order=7,
    title="Rigid contacts: a small load on a packing",
    question="At which step and tolerance does a packing far below yield stay at rest, as rigid grains must?",
    criterion="100 disks at rest under P0 with free walls; sigma2 rises by 5 % at once and stays for 50 steps. Inaccurate: |gamma| above "
              "1e-6. Unstable: above 1e-3. Not solved: steps missed the tolerance.",
    remedy="Until the engine has proven that a packing rests, solver error strains it in proportion to the tolerance and to dt^2. The "
           "engine's own tolerance of 1e-6 reaches the boundary at 10 ms.",
    x=Axis("tolerance", "tolerance"), y=Axis("dt", "step dt [s]"),
    measures={"gamma": "strain2 - strain1 after the last step", "unconverged": "share of the steps that missed the tolerance",
              "sweeps": "mean number of sweeps a step"},
    grid=lambda full: product(tolerance=logarithmic(1e-9, 1e-1, 9) if full else logarithmic(1e-7, 1e-1, 4), dt=TRIED[full]),
    searches=lambda full: lines("tolerance", 1e-8, 1.0, 1.1 if full else 1.5, dt=TRIED[full]),
    marks=TOLERANCES)


def probe(case):
    from yade import O
    from yade_scripts.measuring import rigid
    from yade_scripts.preparing import prepare
    from yade_scripts.running import bodies, cd, hooks, walls
    full = parameters.complete({"disks": DISKS, "method": "CD", "tolerance": case["tolerance"]})
    prepare.load(parameters.complete({"disks": DISKS}))
    O.dt = case["dt"]
    before = walls.sides()
    p0 = parameters.pressure(full)
    walls.set_free(full["wall_mass_ratio"] * bodies.mean_mass())
    scene = scenes.Scene(every=STEPS, samples=1)
    cd.set_engines(full, scene, {"goals": (-p0, -(1 + RISE) * p0, 0)})
    hooks.simulate(STEPS)
    engine = hooks.engine("ContactDynamics")
    strain = [now / length - 1 for now, length in zip(walls.sides(), before)]
    measures = {"gamma": strain[1] - strain[0], "unconverged": engine.unconvergedSteps / STEPS, "sweeps": engine.totalIterations / STEPS}
    told = rigid.told(engine, min(body.shape.radius for body in bodies.disks()))
    return judged(measures, told, (UNSTABLE, "false motion", abs(measures["gamma"]) > LARGE_STRAIN),
                  (NOT_SOLVED, "non-convergence", engine.unconvergedSteps), (INACCURATE, "false motion", abs(measures["gamma"]) > STRAIN))
