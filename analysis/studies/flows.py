"""What a mean of a flow costs by either method, with 500 disks."""
import numpy as np
import pandas

from analysis import flow_costs
from analysis.flow_costs import (COARSE, COARSER, COARSEST, DEFAULT, FINE, PROPOSED, QUANTITY, SMALL, SOFT, STRICT, draw, rows_of, small,
                                 summarize)

__all__ = ["draw", "summarize"]

TITLE = "What does a flow cost by each method?"
QUESTION = ("Silo, drum, filling and collapse of 500 disks: cost of a mean within 2 % of the rigid answer, which is that of the finest CD runs.")
ORDER = 11  # in the report

ROWS = {"quick": rows_of("filling", SMALL, [COARSE, SOFT], 1),
        "full": [row for scene in QUANTITY for row in small(scene) + rows_of(scene, SMALL, [STRICT], (1, 2))]}


def quantities(table):
    table = flow_costs.measured(table)
    rows = table.to_dict("records")
    gain = flow_costs.gains(rows, SMALL)
    low, middle, high, _ = flow_costs.spread(flow_costs.drawn_gains(rows, SMALL))
    springs = pandas.DataFrame({scene: flow_costs.cheapest(rows, scene, SMALL, flow_costs.MD) for scene in QUANTITY}).T
    fine, coarser, coarsest, coarse, proposed, strict, default = (
        flow_costs.of_setting(table, setting) for setting in (FINE, COARSER, COARSEST, COARSE, PROPOSED, STRICT, DEFAULT))
    corrected, others = flow_costs.of_setting(table, COARSE, 0.1), [scene for scene in QUANTITY if scene != "collapse"]
    beside_default = (default.seconds / springs.seconds)[others].astype(float)
    judged = table[~table.is_rigid_answer & table.apply(flow_costs.is_judged, axis=1)]
    assert np.isinf(high[["hopper", "drum"]]).all()
    assert [scene for scene in QUANTITY if not flow_costs.reaching(rows, scene, SMALL, flow_costs.MD)] == ["collapse"]
    assert all(flow_costs.reaching(rows, scene, SMALL, flow_costs.RIGID) for scene in QUANTITY) and springs.setting["collapse"] == 1e8
    assert all(own.error.abs().idxmax() == "collapse" for own in (fine, coarser, coarsest))
    assert strict.unsolved.idxmax() == "drum" and set(strict.seeds) == {2}
    return locals()
