"""What a mean of a flow costs by either method, with 5000 disks."""
import numpy as np

from analysis import flow_costs
from analysis.flow_costs import COARSE, COARSER, FINE, LIGHT, MD, QUANTITY, draw, rows_of, summarize

__all__ = ["draw", "summarize"]

TITLE = "Flows of 5000 disks"
QUESTION = "Does what holds for 500 disks hold for ten times as many?"
ORDER = 30  # in the report
PART = "engine"
MANY = 5000
FINER = FINE | {"cd_dt": 5e-4}
SEEDS = (1, 2, 3)
# Springs of 2e6 N/m are left out: their disks overlap by more than a tenth of a radius.
COMPARED = [FINER, FINE, COARSER, COARSE, *(FINE | {"fixed_iterations": sweeps} for sweeps in (10, 20)),
            *(LIGHT | {"kn": kn} for kn in (5e6, 1e7, 2e7))]
ROWS = {"quick": rows_of("filling", 1000, [COARSER, COARSE, LIGHT | {"kn": 5e6}], 1),
        "full": [row for seed in SEEDS for scene in QUANTITY for row in rows_of(scene, MANY, COMPARED, seed)]}


def quantities(table):
    table = flow_costs.measured(table)
    rows, md = table.to_dict("records"), table[table.method == "MD"].set_index("scene")
    gain = flow_costs.gains(rows, MANY)
    low, _, high, _ = flow_costs.spread(flow_costs.drawn_gains(rows, MANY))
    fine, coarser, coarse = (flow_costs.of_setting(table, setting) for setting in (FINE, COARSER, COARSE))
    falling = md.loc["collapse"]
    assert [scene for scene in QUANTITY if not flow_costs.reaching(rows, scene, MANY, MD)] == ["collapse"]
    assert flow_costs.cheapest(rows, "collapse", MANY, flow_costs.RIGID)["step"] == FINE["cd_dt"] and coarser.error.abs().idxmax() == "collapse"
    assert np.isinf(high[["hopper", "drum", "filling"]]).all()
    return locals()
