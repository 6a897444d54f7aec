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


LOOK = dict(zip(LAWS, (("#1A1A1A", "o"), ("#009E73", "s"), ("#CC79A7", "D"))))


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
    left.axvline(1, color="#444444", lw=0.8, ls="--")
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


ANSWER = """
The energy that tangential springs create on closed paths does not cause ratcheting. Under dSigma = 0.4 each of 6 packings strains as far with the
path-independent law, whose closed paths leave neither force nor energy, as with the standard law: 0.994 to 0.999 times in the first cycle, 0.995 to
1.000 times after 40 cycles, and its rate over the last 20 cycles is 0.93 to 1.02 times the standard one (median 1.01). The same holds in cycles of 2
s, which are as slow for springs of k_n as 0.63 s for springs of 10 k_n, where slower cycles change little (study of ratcheting): the ratio is 0.993
to 1.001 in the first cycle and 0.88 to 1.01 for the late rate (median 0.99). These late rates are 4.5e-6 a cycle at least; for smaller ones see the
study of a thousand cycles. YADE's avoidGranularRatcheting gives 1.000 to 1.006 times the strain after 40 cycles of 0.5 s. Under 0.5, at or above the
limit of most of these packings, the packings rearrange. The strains after 40 cycles are still 0.94 to 1.05 times those with the standard law, but the
late rates scatter, because they come from single rearrangements: with the path-independent law they are 0.39 to 1.27 times the standard ones on 5
packings and -0.91 times on the sixth, whose strain decreases, by 6.5e-5 a cycle.

McNamara, Garcia-Rojo and Herrmann (2008) conclude the opposite: that the energy stored on closed paths is the reason for ratcheting, and that the
path-independent law removes it. In these packings it does not, although it does remove the energy (study of two grains on a closed path). Their
abstract gives no load and no rate, so we cannot tell whether they mean the much smaller rates far below the limit, where closed paths may matter.

At ten times the pressure and dSigma = 0.3 (4 packings), where the standard spring does more work along closed paths, packings strain 0.98 to 1.00
times as far with the path-independent law in the first cycle and after 30 cycles. The remaining rates, 2.0e-6 a cycle at most, are too small to
compare: with the path-independent law they are 0.36 to 1.60 times the standard ones. A strain that remains with the path-independent law is no
artefact of the spring.

avoidGranularRatcheting creates energy, as two disks on a closed path show: the error of its energy balance is 4e-4 to 1.7e-3 of the work, that of the
standard law at most 2.7e-4, that of the path-independent one 1.5e-4.
"""
GIVEN = ("0.3", "0.4", "0.5", "0.63", "2", "10", "20", "30", "40")


def numbers(table):
    parts = (table[(table["P0/k_n"] < 1e-3) & (table.period < SLOW)], table[table["P0/k_n"] > 1e-3], table[table.period == SLOW])
    usual, soft, slow = (dict(list(part.groupby("law"))) for part in parts)
    avoids, free, near = (rows[rows.dSigma == load] for rows, load in ((usual[LAWS[1]], 0.4), (usual[LAWS[2]], 0.4), (usual[LAWS[2]], 0.5)))
    first, strain, late = (f"{name} over standard" for name in ("first cycle", "strain", "late rate"))
    rates_above = [own[own.law.isin(LAWS[::2]) & (own.dSigma == 0.4)]["late rate"].abs() for own in parts[::2]]
    both = table[(table.dSigma == 0.5) & (table.law != LAWS[0])][strain]
    errors = table["balance error"].abs().groupby(table.law).agg(["min", "max"])
    pressed, rates = soft[LAWS[2]][[first, strain]].stack(), pandas.concat(soft)["late rate"].abs()
    return {"6": [len(free), len(avoids), len(near), len(slow[LAWS[2]])], **summary.stated("0.994 0.999", free[first]), "0.995": free[strain].min(),
            "1.000": [free[strain].max(), avoids[strain].min()], **summary.stated("0.93 1.02", free[late]),
            "1.01": [free[late].median(), slow[LAWS[2]][late].max()], **summary.stated("0.993 1.001", slow[LAWS[2]][first]),
            **summary.stated("0.88 0.99", slow[LAWS[2]][late], "min median"),
            "4.5e-6": pandas.concat(rates_above).min(), "1.006": avoids[strain].max(), **summary.stated("0.94 1.05", both),
            **summary.stated("0.39 1.27", near[late][near[late] > 0]),
            "5": (near[late] > 0).sum(), "-0.91": near[late].min(), "6.5e-5": near["late rate"].max(), "4": soft[LAWS[2]].seed.nunique(),
            **summary.stated("0.98 1.00", pressed), "2.0e-6": rates.max(),
            **summary.stated("0.36 1.60", soft[LAWS[2]][late]), "4e-4": errors["min"][LAWS[1]],
            "1.7e-3": errors["max"][LAWS[1]], "2.7e-4": errors["max"][LAWS[0]], "1.5e-4": errors["max"][LAWS[2]]}
