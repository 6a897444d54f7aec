"""Map of CD: tolerance against load over the static limit, for a load cycle of a packing, with three steps."""
from yade_scripts.measuring.maps import Axis, INACCURATE, Map, NOT_SOLVED, TOLERANCES, UNSTABLE, judged, lines, logarithmic, product

STRAIN, LARGE_STRAIN = 1e-6, 1e-4
STEPS = {True: (1e-3, 5e-3, 2e-2), False: (5e-3,)}  # [s], of the full and of the quick map
LOADS = {True: (0.5, 0.7, 0.8, 0.9, 0.95, 1.02, 1.05, 1.1), False: (0.5, 0.95, 1.1)}  # peak of sigma2 over its static limit, less 1 of both
BELOW = [load for load in LOADS[True] if load < 1]

MAP = Map(
    order=8,
    title="Rigid contacts: a load cycle near the static limit",
    question="At which tolerance and step does a packing of rigid grains stay at rest up to its static limit, and move beyond?",
    criterion="100 disks, one cycle of 1 s, lines also of 0.25 and 4 s; load: rise of sigma2 over that of the static limit. Below the limit: "
              "inaccurate if |gamma| at the peak or at the end is above 1e-6, unstable above 1e-4. Beyond it: inaccurate if |gamma| stays below "
              "1e-4. Not solved: steps missed the tolerance. Left out: loads just below the limit, which is an upper bound for sliding with "
              "friction; rigid packings begin to move at 0.976 to 0.991 of it (study critical_load).",
    remedy="Solver errors let a packing creep, mostly without a warning: the longer cycle and step and the nearer the limit, the more. 1e-8, "
           "the default of runs, suffices in all cycles tried; the engine's own 1e-6 only in short cycles with steps of 1 ms.",
    x=Axis("tolerance", "tolerance"), y=Axis("load", "rise of the load over that of the static limit"), panels="dt",
    measures={"peak": "gamma at the peak of the load", "end": "gamma at the end", "sweeps": "mean number of sweeps a step",
              "unconverged": "share of the steps that missed the tolerance"},
    grid=lambda full: product(dt=STEPS[full], load=LOADS[full], tolerance=logarithmic(1e-9, 1e-1, 9) if full else logarithmic(1e-8, 1e-2, 3),
                              period=1.0),
    searches=lambda full: lines("tolerance", 1e-9, 1.0, 1.2 if full else 3.0, dt=STEPS[full], load=BELOW if full else (0.5, 0.95),
                                period=(0.25, 1.0, 4.0) if full else (1.0,)),
    marks=TOLERANCES)


def probe(case):
    from yade_scripts.measuring import packing_cycle, rigid
    from yade_scripts.running import bodies, hooks
    found = packing_cycle.cycle(method="CD", cd_dt=case["dt"], tolerance=case["tolerance"], period=case["period"],
                                delta_sigma=case["load"] * packing_cycle.limit())
    engine = hooks.engine("ContactDynamics")
    measures = {"peak": found[0], "end": found[1], "sweeps": engine.totalIterations / engine.steps,
                "unconverged": engine.unconvergedSteps / engine.steps}
    told, strain, rests = rigid.told(engine, min(body.shape.radius for body in bodies.disks())), max(map(abs, found)), case["load"] < 1
    return judged(measures, told, (UNSTABLE, "false motion", rests and strain > LARGE_STRAIN),
                  (NOT_SOLVED, "non-convergence", engine.unconvergedSteps),
                  (INACCURATE, "false motion", rests and strain > STRAIN), (INACCURATE, "false rest", not rests and strain < LARGE_STRAIN))
