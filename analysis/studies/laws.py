"""Fig. 3 under three tangential laws: does the strain a cycle come from the energy that the standard spring creates along closed paths?"""
import numpy as np
import pandas

from analysis import style, summary
from analysis.studies.fig3 import SPRINGS
from analysis.style import plt
from yade_scripts.tables import product

TITLE = "Does the tangential law matter?"
QUESTION = "The standard law, YADE's avoidGranularRatcheting, and the path-independent law of McNamara, Garcia-Rojo and Herrmann (2008)."
ORDER = 3.6  # in the report
LAWS = ("standard", "avoid_ratcheting", "path_independent")
# The dense packings of fig3; some at ten times the pressure, where the work that the standard spring makes along closed paths, of the order of
# (dSigma P0/k_n)^2 a cycle, is some fifty times larger.
SLOW = 2.0  # s: cycles of 0.5 s are short for springs of k_n (study of later cycles)
ROWS = {"quick": product(tangential_law=LAWS, cycles=10, delta_sigma=0.4, **SPRINGS),
        "full": product(tangential_law=LAWS, cycles=40, delta_sigma=(0.4, 0.5), seed=range(1, 7), **SPRINGS)
        + product(tangential_law=LAWS[::2], cycles=20, delta_sigma=0.4, seed=range(1, 7), **SPRINGS | dict(period=SLOW))
        + product(tangential_law=LAWS, cycles=30, pressure_ratio=6e-3, seed=range(1, 5), delta_sigma=0.3, **SPRINGS)}
OVER = {"strain over standard": "gamma at the end", "first cycle over standard": "first cycle", "late rate over standard": "late rate"}


def summarize(runs):
    """Return one row a run, with its strain and rates over those of the standard law on the same packing under the same load and as many cycles."""
    rows = []
    for same in summary.by(runs, "P0/k_n", "period", "asked", "dSigma", "seed").values():
        usual = None
        for run in sorted(same, key=lambda run: LAWS.index(run.parameters["tangential_law"])):
            row = summary.columns(run, "law", "P0/k_n", "period", "dSigma", "seed", "cycles", "gamma at the end", "first cycle", "late rate", "asked",
                                  "last quarter's rate over the one before", "balance error", "outcome")
            usual = row if row["law"] == LAWS[0] else usual
            if usual:
                row |= {name: row[what] / usual[what] if usual[what] else np.nan for name, what in OVER.items()}
            rows.append(row)
    return rows


LOOK = dict(zip(LAWS[1:], ((style.GREEN, "avoidGranularRatcheting"), (style.PINK, "path-independent law"))))


def draw(runs, rows, path):
    """Draw the strain and the late rate against those under the standard law on the same packing."""
    fig, axes = plt.subplots(1, 2, figsize=(9.5, 4.4))
    table = pandas.DataFrame(rows, columns=["law", "P0/k_n", "period", "dSigma", *OVER, *OVER.values()])
    table = table.assign(case=[rf"$\Delta\sigma$ = {load:g}, " + ("$10\\,P_0$" if pressure > 1e-3 else f"{period:g} s")
                               for load, pressure, period in zip(table.dSigma, table["P0/k_n"], table.period)])
    markers = dict(zip(table.case.unique(), "osDv"))
    for axis, (name, words) in zip(axes, (("strain over standard", "strain after all cycles"),
                                          ("late rate over standard", "strain of a late cycle"))):
        other = table[table.law != LAWS[0]]
        other = other.assign(ratio=other[name], standard=(other[OVER[name]] / other[name]).abs(), own=other[OVER[name]].abs())
        for (law, case), part in other.groupby(["law", "case"]):
            for same, face in ((part.ratio > 0, LOOK[law][0]), (part.ratio < 0, "none")):
                axis.plot(part.standard[same], part.own[same], ls="", marker=markers[case], ms=5, color=LOOK[law][0], mfc=face, alpha=0.8)
        if len(ends := other[["standard", "own"]].stack()):
            axis.plot([ends.min(), ends.max()], [ends.min(), ends.max()], color=style.GREY["88"], lw=0.8, ls=":")
        axis.set(xscale="log", yscale="log", xlabel="standard law", ylabel="another law", title=words)
    style.legend(axes[0], [dict(color=colour, lw=4, label=words) for colour, words in LOOK.values()]
                 + [dict(color=style.GREY["55"], ls="", marker=marker, label=case) for case, marker in markers.items()], loc="upper left", fontsize=7)
    style.finish(fig, path, "Each point is a packing; dotted: equal values. Open: the strain of this packing goes the other way.", runs)


def quantities(table):
    usual, pressed, slow = (dict(list(part.groupby("law"))) for part in (
        table[(table["P0/k_n"] < 1e-3) & (table.period < SLOW)], table[table["P0/k_n"] > 1e-3], table[table.period == SLOW]))
    free = usual[LAWS[2]][usual[LAWS[2]].dSigma == 0.4]
    first, strain, late = (f"{name} over standard" for name in ("first cycle", "strain", "late rate"))
    slowly, soft = slow[LAWS[2]], pressed[LAWS[2]]
    beyond = table[(table.dSigma == 0.5) & (table.law != LAWS[0])][strain]
    far, whole = soft[[first, strain]].stack(), pandas.concat(pressed)["late rate"].abs()
    return locals()
