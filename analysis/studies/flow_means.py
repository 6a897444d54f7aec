"""What a mean of a flow costs by springs of any damping, by springs in Contact Dynamics, and by rigid contacts with few sweeps, with 500 disks."""
from analysis.flow_costs import (COARSE, COARSER, DAMPED, DEFAULT, FINE, FINEST, MIDDLE, PROPOSED, QUANTITY, SMALL, STIFF, STRICT, draw, rows_of,
                                 summarize)

__all__ = ["draw", "summarize"]

TITLE = "Which accuracy does a mean of a flow need?"
QUESTION = ("Silo, drum, filling and collapse of 500 disks: MD's springs with two dampings, springs in Contact Dynamics, and rigid contacts solved to a"
            " tolerance or with a given small number of sweeps a step.")
ORDER = 11.5  # in the report
LIGHT = DAMPED | dict(md_dt_factor=0.6, beta_n=0.2)  # less damping, so that the stable step is longer
IMPLICIT = dict(method="CD", cd_contacts="springs", cd_dt=1e-3)
COMPARED = [FINEST, FINE, COARSER, COARSE, *(FINE | {"fixed_iterations": sweeps} for sweeps in (2, 5, 10, 20)),
            *(IMPLICIT | {"kn": kn, "beta_n": beta} for kn, beta in ((5e6, 0.2), (2e7, 0.2), (2e7, 0.9))),
            *(LIGHT | {"kn": kn} for kn in (2e6, 5e6, 2e7)), MIDDLE, STIFF]
# What the defaults cost; the error of the step of springs; springs ten times as stiff, from which the rigid answer can be extrapolated.
OTHERS = [COARSE | {"gap_correction": 0.1}, PROPOSED, DEFAULT, IMPLICIT | {"kn": 2e7, "beta_n": 0.2, "cd_dt": 2.5e-4}, LIGHT | {"kn": 2e8}]
SEEDS, FEW = {"hopper": 32, "drum": 16, "filling": 8, "collapse": 16}, 0.25  # numbers of seeds, and the share of them that OTHERS get
# All settings of a seed follow each other, and the scenes keep step, so that a run that is cut short has the same seeds in all settings.
ORDERED = sorted(((seed, scene) for scene in QUANTITY for seed in range(1, SEEDS[scene] + 1)), key=lambda one: (one[0] - 0.5) / SEEDS[one[1]])
ROWS = {"quick": rows_of("filling", SMALL, [FINE, FINE | {"fixed_iterations": 10}, LIGHT | {"kn": 5e6}], 1),
        "full": [row for seed, scene in ORDERED for row in rows_of(scene, SMALL, COMPARED + (OTHERS if seed <= FEW * SEEDS[scene] else []), seed)]
        + [row for scene in QUANTITY for row in rows_of(scene, SMALL, [STRICT], (1, 2))]}
