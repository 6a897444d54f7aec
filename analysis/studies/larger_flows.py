"""What a mean of a flow costs by either method, with 5000 disks."""
import numpy as np

from analysis import summary
from analysis.studies import flows
from analysis.studies.flows import COARSE, COARSER, FINE, HARDER, MIDDLE, QUANTITY, STIFF, draw, rows_of, summarize

__all__ = ["draw", "summarize"]

TITLE = "Flows of 5000 disks"
QUESTION = "Does what holds for flows of 500 disks hold for ten times as many: the settings that suffice, and the cost of each method?"
ORDER = 21.5  # in the report
MANY = 5000
FINER = FINE | {"cd_dt": 5e-4}
SEEDS = (1, 2, 3)
# Springs of 2e6 N/m are left out: their disks overlap by more than a tenth of a radius.
ROWS = {"quick": rows_of("filling", 1000, [COARSER, COARSE, MIDDLE], 1),
        "full": [row for seed in SEEDS for scene in QUANTITY
                 for row in rows_of(scene, MANY, [FINER, FINE, COARSER, COARSE, MIDDLE, HARDER, STIFF], seed)]}

ANSWER = """
The cheapest springs that count cost 4.6, 14.4 and 21.7 times as much as the cheapest rigid contacts that count in the silo, the drum and the filling.
As with 500 disks (study of flows) a setting counts if its mean, and that of all finer settings, lies within 2 % of the result of the finest rigid
contacts (here steps of 0.5 ms; tolerance 1e-3, only 1.3 decades below the 2 %, see there) and no disks overlap by more than 0.1 radii. The means of 3
seeds have standard errors of up to 1.5 %. If they are drawn again with these errors, as with 500 disks, the medians of the factors are 4.6, 7.5 and
21.7, and in 97.5 % of the draws the factors are at least 2.1, 4.0 and 13.3. They have no upper limit: in 32, 10 and 4 % of the draws no springs
count. So only in the filling rigid contacts very probably gain more than with 500 disks, where the median is 9.0.

In the collapse no springs count: those of 5e6 to 2e7 N/m are off by 4.5 to 4.9 %, whatever their stiffness (see the study of flows), and cost 4.0 to
4.6 times as much as rigid contacts in steps of 1 ms, the cheapest that count.

Which settings suffice? With a tolerance of 1e-3 steps of 1 ms give errors of 0.1 to 1.8 % and steps of 2 ms 0.6 to 3.3 %, largest in the collapse,
with 27 to 278 sweeps a step. A tolerance of 1e-2 is too large: disks overlap by 0.15 to 0.36 radii, and the filling is 5.7 % too low. Springs of 5e6
N/m, with which disks overlap by up to 0.21 radii in the silo, are too soft.

Times are processor times without samples and measurements, and without sums of the springs' energies, on one of two cores, while other runs used the
other.
"""
GIVEN = ("500", "2", "0.5", "1e-3", "3", "97.5", "9.0", "5e6", "2e7", "1", "1e-2", "1.3")


def numbers(table):
    table = flows.measured(table)
    rows, cd, md = table.to_dict("records"), table[table.method == "CD"], table[table.method == "MD"].set_index("scene")
    gain = flows.gains(rows, MANY)
    low, middle, high, open_above = flows.spread(flows.drawn_gains(rows, MANY))

    def of(setting):
        return cd[(cd.step == setting["cd_dt"]) & (cd.setting == setting["tolerance"])].set_index("scene")

    fine, coarser, coarse = map(of, (FINE, COARSER, COARSE))
    counts = {scene: flows.reaching(rows, scene, MANY, "MD") for scene in QUANTITY}
    assert [scene for scene in QUANTITY if not counts[scene]] == ["collapse"] and set(table.seeds) == {len(SEEDS)}
    assert flows.cheapest(rows, "collapse", MANY, "CD")["step"] == FINE["cd_dt"] and coarser.error.abs().idxmax() == "collapse"
    soft, falling = md[md.setting == MIDDLE["kn"]], md.loc["collapse"]
    dearer = falling.seconds / fine.seconds["collapse"]
    assert np.isinf(high[["hopper", "drum", "filling"]]).all()
    return {"4.6": [gain["hopper"], middle["hopper"], dearer.max()], "14.4": gain["drum"], "21.7": [gain["filling"], middle["filling"]],
            "0.1": [flows.OVERLAP, 100 * fine.error.abs().min()], "1.5": 100 * table[~table.is_rigid_answer].error_deviation.max(),
            "7.5": middle["drum"], "2.1": low["hopper"], "4.0": [low["drum"], dearer.min()], "13.3": low["filling"],
            "32": open_above["hopper"], "10": open_above["drum"], "4": open_above["filling"], **summary.stated("4.5 4.9", 100 * falling.error),
            "1.8": 100 * fine.error.abs().max(), **summary.stated("0.6 3.3", 100 * coarser.error.abs()), **summary.stated("27 278", coarser.sweeps),
            **summary.stated("0.15 0.36", coarse.overlap), "5.7": -100 * coarse.error["filling"], "0.21": soft.overlap["hopper"]}
