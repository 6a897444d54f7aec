"""Three thousand cycles by springs in Contact Dynamics and by rigid contacts, checked against MD on a part: regimes, and sudden compactions."""
import numpy as np
import pandas

from analysis import cycles, limits, style, summary
from analysis.studies import fig3
from analysis.studies.implicit import COLOUR, MD, RIGID, SPRINGS, kind
from analysis.style import plt
from yade_scripts.tables import product

TITLE = "What happens in three thousand cycles?"
QUESTION = "Three packings under dSigma = 0.4, sigma1 held; springs in Contact Dynamics with periods of 0.5, 2 and 8 s, rigid contacts, and MD for a part."
ORDER = 3.3  # in the report
LOAD = dict(delta_sigma=0.4)
SHARE = 400  # steps of springs in a cycle
PERIODS, COUNT, FEWER = (0.5, 2.0), 3000, 1000
SLOWEST = dict(period=8.0, cd_dt=1e-2, cycles=500)
SEEDS = 1, 2, 3
SOFT = {name: value for name, value in fig3.LOADING.items()} | dict(method="CD", cd_contacts="springs") | LOAD
# Three times MD's default step; one cycle's strain changes by 0.1 %.
MOLECULAR = fig3.SPRINGS | LOAD | dict(md_dt_factor=0.6)
RIGID_ROW = fig3.RIGID | LOAD
PART = {0.5: 300, 2.0: 100}  # cycles of MD by period
ROWS = {"quick": [SOFT | dict(cd_dt=PERIODS[0] / SHARE, cycles=40, seed=1), RIGID_ROW | dict(cycles=10, seed=1), MOLECULAR | dict(cycles=10, seed=1)],
        "full": [row for period in PERIODS
                 for row in product(**SOFT | dict(period=period, cd_dt=period / SHARE, cycles=COUNT, seed=SEEDS))]
        + product(**SOFT | SLOWEST | dict(seed=SEEDS)) + product(**RIGID_ROW, cycles=FEWER, seed=SEEDS)
        + [row for period, count in PART.items() for row in product(**MOLECULAR | dict(period=period, cycles=count, seed=SEEDS))]
        + product(**MOLECULAR | dict(md_walls="servo"), cycles=PART[0.5], seed=SEEDS)}
EDGES = (0, 1, 2, 5, 10, 20, 50, 100, 200, 300, 500, 750, 1000, 1500, 2000, 2500, 3000)  # last cycles of the windows


def medium(run):
    """Return which grains a run has, with its walls where a servo moves them."""
    return kind(run) + (", servo" if run.method == "MD" and run.parameters["md_walls"] == "servo" else "")


def summarize(runs):
    """Return one row a run and window of cycles. rate: mean strain a cycle, positive where the sample goes on shortening along axis 2; rate error: its
    standard error, from ten blocks of cycles. largest cycle: the largest strain of one cycle, and in which cycle. compaction: change of the volume
    over the window."""
    rows = []
    for run in runs:
        found = cycles.of(run)
        volume = ((1 + run.values("strain1")) * (1 + run.values("strain2")))[found.ends]
        same = {"medium": medium(run), "period": run.parameters["period"], "packing": run.parameters["seed"],
                "step_s": run.parameters["cd_dt"] if run.method == "CD" else np.nan, "load over limit": limits.load_over_limit(run)}
        edges = [cycle for cycle in EDGES if cycle < len(found.number)] + [len(found.number)]
        for first, last in zip(edges[:-1], edges[1:]):
            rate = -found.rate[first:last]
            largest = int(np.argmax(np.abs(rate)))
            rows.append(same | {
                "from cycle": first + 1, "to cycle": last, "|gamma|": abs(found.gamma[last]), "rate": rate.mean(),
                "rate error": cycles.error_of_mean(rate), "largest cycle": abs(rate[largest]), "in cycle": int(found.number[first + largest]),
                "compaction": volume[first] - volume[last], "sliding at most": found.sliding_max[first:last].max(), "2M/N": found.contacts[last - 1],
                "seconds": float(run.values("processor_time")[found.ends[last]]), "outcome": run.outcome})
    return rows


def draw(runs, rows, path):
    """Draw the strain, and the strain of each cycle, against the number of the cycle."""
    fig, (left, right) = plt.subplots(1, 2, figsize=(9, 3.9))
    for run in runs:
        found = cycles.of(run)
        left.plot(found.number, np.abs(found.permanent), color=COLOUR[kind(run)])
    style.finish(fig, path, "Cycles", runs)
