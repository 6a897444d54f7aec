"""A thousand cycles: does the strain of springs go on, does it end, and does the energy balance hold so long?"""
import numpy as np
import pandas

from analysis import cycles, observables, style, summary
from analysis.studies.fig3 import SPRINGS
from analysis.style import plt
from yade_scripts.tables import product

TITLE = "Do tangential laws agree over a thousand cycles?"
QUESTION = "Three packings under dSigma = 0.4, under two tangential laws and with two periods."
ORDER, PART = 3.2, "appendix"  # in the report
EDGES = (0, 1, 2, 5, 10, 20, 50, 100, 200, 500, 625, 750, 875, 1000)  # last cycles of the windows
BASE = SPRINGS | dict(delta_sigma=0.4)
SLOW = dict(period=2.0)  # 0.5 s is short for springs of k_n (study of later cycles)
LINES = "-", "--", ":"  # of the packings
LOOK = {("standard", SPRINGS["period"]): (style.INK, "standard law"),  # colours of the laws as in their study
        ("path_independent", SPRINGS["period"]): (style.PINK, "path-independent law"),
        ("standard", SLOW["period"]): (style.BROWN, "standard law, cycles of 2 s")}
ROWS = {"quick": product(cycles=20, **BASE),
        "full": product(tangential_law="standard", seed=(1, 2, 3), cycles=1000, **BASE)
        + product(tangential_law="path_independent", seed=(1, 2, 3), cycles=1000, **BASE)
        + product(tangential_law="standard", seed=(1, 2, 3), cycles=100, **BASE | SLOW)}


def summarize(runs):
    """Return one row a run and window of cycles: strain and rate there, and the error of the energy balance up to its end.

    rate error: standard error of the mean rate, from the means of ten blocks of cycles. balance error: over the work of the walls up to there.
    """
    rows = []
    for run in runs:
        found, ends, same = cycles.of(run), cycles.ends(run), summary.columns(run, "law", "period", "seed", "load over limit")
        edges = [cycle for cycle in EDGES if cycle < len(found.number)] + [len(found.number)]
        for first, last in zip(edges[:-1], edges[1:]):
            rate = found.rate[first:last]
            rows.append(same | {
                "from cycle": first + 1, "to cycle": last, "|gamma|": abs(found.gamma[last]), "rate": found.rates([(first + 1, last)])[0],
                "rate error": cycles.error_of_mean(rate), "largest cycle": np.abs(rate).max(), "median cycle": np.median(np.abs(rate)),
                "dissipated/P0V0 a cycle": found.dissipated[first:last].mean(), "sliding at most": found.sliding_max[first:last].max(),
                "2M/N": found.contacts[last - 1], "balance error": observables.balance_error(run, slice(0, ends[last] + 1)), "outcome": run.outcome})
    return rows


def draw(runs, rows, path):
    """Draw the strain, and the strain of each cycle, against the number of the cycle."""
    fig, (left, right) = plt.subplots(1, 2, figsize=(9, 3.9))
    table = pandas.DataFrame(rows)
    for law, period, seed in sorted(set(zip(table.law, table.period, table.seed)), key=lambda one: (list(LOOK).index(one[:2]), one[2])):
        (colour, words), line = LOOK[law, period], LINES[(seed - 1) % len(LINES)]
        means = table[(table.law == law) & (table.period == period) & (table.seed == seed)]
        wide = 2.5 if (law, period) == next(iter(LOOK)) else 1.0  # seen below another line
        left.plot(means["to cycle"], means["|gamma|"], color=colour, ls=line, lw=wide, label=words if seed == 1 else None)
        middle, known = np.sqrt(means["from cycle"] * means["to cycle"]), (means.rate.abs() > 2 * means["rate error"]) | (means["to cycle"] <= 10)
        right.plot(middle, means.rate.abs(), color=colour, ls=line, lw=wide)
        for part, face in ((known, colour), (~known, "w")):
            right.plot(middle[part], means.rate.abs()[part], ls="", marker="o", ms=3, color=colour, mfc=face)
    for axis, label in ((left, r"accumulated strain $|\gamma|$"), (right, r"strain of a cycle $|\Delta\gamma|$")):
        axis.set(xscale="log", yscale="log", xlabel="cycle", ylabel=label)
    left.legend(loc="lower right")
    style.finish(fig, path, "Springs of k_n, cycles of 0.5 s unless named; a packing has one kind of line. "
                 "Right: means over the cycles 1, 2, 3 to 5, 6 to 10 and so on; open dots, from cycle 11 on: not different from zero (less "
                 "than two standard errors).", runs)


LATE = 100  # cycles: what follows them is compared alone, since much of the strain comes before


def _late(own, usual):
    """Return of one packing: the strain after LATE cycles under another law over that under the usual one, the relative standard error of the latter,
    and its share of the whole strain."""
    strain, usual_strain = (part["|gamma|"].iloc[-1] - part["|gamma|"][LATE] for part in (own, usual))
    rest = usual[usual.index > LATE]
    error = np.sqrt(np.sum((rest["rate error"] * (rest.index - rest["from cycle"] + 1))**2))
    return {"ratio": strain / usual_strain, "error": error / usual_strain, "share": usual_strain / usual["|gamma|"].iloc[-1]}


def quantities(table):
    packing = {key: own.set_index("to cycle") for key, own in table.groupby(["law", "period", "seed"])}
    fast, free = ([packing[law, SPRINGS["period"], seed] for seed in (1, 2, 3)] for law in ("standard", "path_independent"))
    late = [_late(own, usual) for own, usual in zip(free, fast)]
    alike = pandas.concat([own["|gamma|"] / usual["|gamma|"] for own, usual in zip(free, fast)])
    return locals()
