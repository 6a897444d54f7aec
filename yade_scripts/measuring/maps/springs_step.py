"""Map of springs in Contact Dynamics: time step against load, for a load cycle of packings of three stiffnesses."""
from yade_scripts.measuring.maps import Axis, INACCURATE, Map, NOT_SOLVED, UNSTABLE, judged, lines, logarithmic, product

FINEST, STRICT = 1e-4, 1e-3  # step [s] and tolerance of the truth
OFF, FAR_OFF = 0.01, 0.5
# Of the full and of the quick map.
STIFFER, LOADS, TOLERANCES = {True: (1.0, 100.0, 10000.0), False: (1.0,)}, {True: (0.05, 0.1, 0.2, 0.3, 0.4), False: (0.1, 0.4)}, (0.1, 1.0)

MAP = Map(
    order=11,
    title="Springs in Contact Dynamics: the step of a load cycle",
    question="How long a step does the strain of a load cycle allow, at which stiffness and load?",
    criterion="100 disks, one cycle of 1 s, tolerance 0.1; lines: also 1. Inaccurate: the strain at the peak of the load or the one that remains "
              "differs from that with steps of 0.1 ms and a tolerance of 1e-3 by more than 1 % of the strain at the peak. Unstable: by more than "
              "50 %. Not solved: steps missed the tolerance.",
    remedy="Long steps damp motion, without a warning: halve the step and compare. Far from the static limit a cycle needs few steps, near "
           "it many. Very stiff springs strain so little that the least tolerance of the solver shows: they need short steps, too.",
    x=Axis("dt", "step dt [s] of a cycle of 1 s"), y=Axis("delta_sigma", r"load $\Delta\sigma$"), panels="stiffening",
    measures={"peak_error": "strain at the peak, less the true one, over the latter",
              "rest_error": "the same of the strain that remains, over the peak's",
              "sweeps": "mean number of sweeps a step", "unconverged": "share of the steps that missed the tolerance"},
    grid=lambda full: product(stiffening=STIFFER[full], delta_sigma=LOADS[full], dt=logarithmic(2e-4, 0.25, 10 if full else 4),
                              tolerance=TOLERANCES[0]),
    searches=lambda full: lines("dt", 2e-4, 0.5, 1.1 if full else 2.0, stiffening=STIFFER[full], delta_sigma=LOADS[full],
                                tolerance=TOLERANCES if full else TOLERANCES[:1]),
    marks={"default": 1e-3})


def probe(case):
    from yade_scripts.measuring import packing_cycle, rigid
    from yade_scripts.running import bodies, hooks
    row = {"method": "CD", "cd_contacts": "springs"} | {name: case[name] for name in ("delta_sigma", "stiffening")}
    found = packing_cycle.cycle(cd_dt=case["dt"], tolerance=case["tolerance"], **row)
    engine = hooks.engine("ContactDynamics")
    told = rigid.told(engine, min(body.shape.radius for body in bodies.disks()))
    sweeps, missed = engine.totalIterations / engine.steps, engine.unconvergedSteps / engine.steps
    errors = packing_cycle.errors(found, cd_dt=FINEST, tolerance=STRICT, **row)
    worst = max(map(abs, errors))
    measures = {"peak_error": errors[0], "rest_error": errors[1], "sweeps": sweeps, "unconverged": missed}
    return judged(measures, told, (UNSTABLE, "wrong motion", not worst <= FAR_OFF), (NOT_SOLVED, "non-convergence", missed),
                  (INACCURATE, "wrong motion", worst > OFF))
