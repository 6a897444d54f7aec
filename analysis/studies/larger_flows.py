"""What a mean of a flow costs by either method, with 5000 disks."""
from analysis import flow_costs
from analysis.flow_costs import COARSER, FEW, FINE, IMPLICIT, LIGHT, MD, QUANTITY, RIGID, SPRINGS, draw, rows_of, summarize

__all__ = ["draw", "summarize"]

TITLE = "Flows of 5000 disks"
QUESTION = "Does what holds for 500 disks hold for ten times as many?"
ORDER = 30  # in the report
PART = "engine"
MANY = 5000
FINER = FINE | {"cd_dt": 5e-4}
# Springs of 2e6 N/m are left out: their disks overlap by more than a tenth of a radius.
COMPARED = [FINER, FINE, COARSER, *(FINE | {"fixed_iterations": sweeps} for sweeps in (5, 10)), LIGHT | {"kn": 5e6}, LIGHT | {"kn": 2e7},
            IMPLICIT | {"kn": 2e7, "beta_n": 0.2}]
ROWS = {"quick": rows_of("filling", 1000, [FINE, COARSER, LIGHT | {"kn": 5e6}], 1),
        "full": [row for seed in (1, 2, 3) for scene in QUANTITY for row in rows_of(scene, MANY, COMPARED, seed)]}


def quantities(table):
    table = flow_costs.measured(table)
    rows = table.to_dict("records")
    counts = {kind: [scene for scene in QUANTITY if flow_costs.reaching(rows, scene, MANY, kind)] for kind in (RIGID, FEW, MD)}
    gain, few = flow_costs.gains(rows, MANY, RIGID), flow_costs.gains(rows, MANY, FEW)
    low = flow_costs.spread(flow_costs.drawn_gains(rows, MANY))[0]
    fine, coarser = (flow_costs.of_setting(table, setting) for setting in (FINE, COARSER))
    springs = table[table.kind == MD].set_index(["setting", "scene"]).sort_index()
    ten = table[(table.kind == FEW) & (table.setting == 10)].set_index("scene")
    implicit = table[table.kind == SPRINGS].set_index("scene")
    return locals() | {"QUANTITY": QUANTITY, "RIGID": RIGID, "FEW": FEW, "MD": MD}
