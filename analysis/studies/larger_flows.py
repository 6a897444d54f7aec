"""What a mean of a flow costs by either method, with 5000 disks."""
from analysis import flow_costs
from analysis.flow_costs import COARSE, COARSER, FEW, FINE, LIGHT, MD, QUANTITY, RIGID, WORDS, draw, rows_of, settings, summarize

__all__ = ["draw", "summarize"]

TITLE = "Flows of 5000 disks"
QUESTION = "Does what holds for 500 disks hold for ten times as many?"
ORDER = 30  # in the report
PART = "engine"
MANY = 5000
FINER = FINE | {"cd_dt": 5e-4}
SEEDS = (1, 2, 3)
STIFFNESSES = (5e6, 1e7, 2e7)  # those of 2e6 N/m are left out: their disks overlap by more than a tenth of a radius
COMPARED = [FINER, FINE, COARSER, COARSE, *(FINE | {"fixed_iterations": sweeps} for sweeps in (10, 20)),
            *(LIGHT | {"kn": kn} for kn in STIFFNESSES)]
ROWS = {"quick": rows_of("filling", 1000, [COARSER, COARSE, LIGHT | {"kn": 5e6}], 1),
        "full": [row for seed in SEEDS for scene in QUANTITY for row in rows_of(scene, MANY, COMPARED, seed)]}


def quantities(table):
    table = flow_costs.measured(table)
    rows = table.to_dict("records")
    kinds = RIGID, FEW, MD
    counts = {kind: [scene for scene in QUANTITY if flow_costs.reaching(rows, scene, MANY, kind)] for kind in kinds}
    best = {kind: {scene: flow_costs.cheapest(rows, scene, MANY, kind) for scene in QUANTITY} for kind in kinds}
    gain = {kind: {scene: factor for scene, factor in flow_costs.gains(rows, MANY, kind).items() if scene in counts[kind] and scene in counts[MD]}
            for kind in (RIGID, FEW)}
    fine, coarser, coarse = (flow_costs.of_setting(table, setting) for setting in (FINE, COARSER, COARSE))
    stiffest = table[(table.kind == MD) & (table.setting == STIFFNESSES[-1])].set_index("scene")
    return locals() | {"QUANTITY": QUANTITY, "WORDS": WORDS, "settings": settings, "RIGID": RIGID, "FEW": FEW, "STIFFNESSES": STIFFNESSES}
