"""Fig. 3 under three tangential laws: does ratcheting come from the energy that the standard spring creates along closed paths?"""
import numpy as np
import pandas

from analysis import cycles, style, summary
from analysis.studies.fig3 import SPRINGS
from analysis.style import plt
from yade_scripts.tables import product

TITLE = "Fig. 3 under three tangential laws"
QUESTION = ("Does the strain per cycle vanish if the tangential spring does no work along closed paths? Three laws are compared: the standard law, "
            "YADE's avoidGranularRatcheting, and the path-independent law of McNamara, Garcia-Rojo and Herrmann (2008).")
ORDER = 9  # in the report
LAWS = ("standard", "avoid_ratcheting", "path_independent")
# The dense packings of fig3; some at ten times the pressure, where the work that the standard spring makes along closed paths, of the order of
# (dSigma P0/k_n)^2 a cycle, is some fifty times larger.
SLOW = 2.0  # s: cycles of 0.5 s are short for springs of k_n (study of ratcheting)
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


LOOK = dict(zip(LAWS, ((style.INK, "o"), (style.GREEN, "s"), (style.PINK, "D"))))


def draw(runs, rows, path):
    """Draw strain and late rate over those of the standard law, packing by packing; beside them the longest runs of the first load."""
    fig, (left, right) = plt.subplots(1, 2, figsize=(10, 4.2))
    table, labels = pandas.DataFrame(rows, columns=["law", "P0/k_n", "period", "dSigma", *OVER]), []
    for (pressure, period, load), own in table[table.law != LAWS[0]].groupby(["P0/k_n", "period", "dSigma"]):
        for name in ("first cycle over standard", "strain over standard", "late rate over standard"):
            for law, shift, face in ((LAWS[1], -0.12, "none"), (LAWS[2], 0.12, None)):
                values = own[own.law == law][name].abs()
                left.plot(values, np.full(len(values), len(labels) + shift), LOOK[law][1], color=LOOK[law][0], ms=4, mfc=face)
            labels.append(f"{name.split(' over')[0]}\n" + rf"$\Delta\sigma$ = {load:g}" + (r", $10 P_0$" if pressure > 1e-3 else f", {period:g} s"))
    left.axvline(1, color=style.GREY["44"], lw=0.8, ls="--")
    left.set_yticks(range(len(labels)), labels, fontsize=7)
    left.invert_yaxis()
    left.set(xscale="log", xlabel="value over that with the standard law, same packing")
    length = lambda run: (-run.parameters["cycles"], run.parameters["delta_sigma"], run.parameters["seed"])
    for run in summary.groups(runs, length)[min(map(length, runs))]:
        found, (colour, marker) = cycles.of(run), LOOK[run.parameters["tangential_law"]]
        windows = cycles.windows(len(found.number))
        right.plot([last for _, last in windows], np.abs(found.rates(windows)), color=colour, marker=marker, ms=3, lw=0.8)
    right.set(xscale="log", yscale="log", xlabel="cycle", ylabel=r"strain a cycle $|\Delta\gamma|$")
    style.legend(right, [dict(color=colour, marker=marker, ms=4, label=law.replace("_", " ")) for law, (colour, marker) in LOOK.items()
                         if law in set(table.law)])
    style.finish(fig, path, "Left: a point a packing, absolute values. Right: one packing, means over windows that grow with the cycle.", runs)


def quantities(table):
    usual, pressed, slow = (dict(list(part.groupby("law"))) for part in (
        table[(table["P0/k_n"] < 1e-3) & (table.period < SLOW)], table[table["P0/k_n"] > 1e-3], table[table.period == SLOW]))
    avoids, free, near = (usual[law][usual[law].dSigma == load] for law, load in ((LAWS[1], 0.4), (LAWS[2], 0.4), (LAWS[2], 0.5)))
    first, strain, late = (f"{name} over standard" for name in ("first cycle", "strain", "late rate"))
    slowly, soft = slow[LAWS[2]], pressed[LAWS[2]]
    rates = table[(table["P0/k_n"] < 1e-3) & table.law.isin(LAWS[::2]) & (table.dSigma == 0.4)]["late rate"].abs()
    beyond = table[(table.dSigma == 0.5) & (table.law != LAWS[0])][strain]
    errors = table["balance error"].abs().groupby(table.law).agg(["min", "max"])
    far, whole = soft[[first, strain]].stack(), pandas.concat(pressed)["late rate"].abs()
    return locals()
