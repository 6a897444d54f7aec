"""Do verdicts on load cycles stand when a run is continued to twice its length, and how far do contacts slip in an early and in a late cycle?"""
import numpy as np
import pandas

from analysis import cycles, observables, slip, style, summary
from analysis.studies import fig3
from analysis.style import plt
from yade_scripts.tables import product

TITLE = "Fig. 3 continued to twice as many cycles"
QUESTION = ("Most runs of Fig. 3 have 40 cycles. Would another verdict follow from 80? Those of the first dense and the first loose packing, a "
            "fifth of all, are continued. In them slip is measured, too, because a contact at Coulomb's limit need not slip.")
ORDER = 2.2  # in the report
ROWS = {"quick": fig3.ROWS["quick"],
        "full": [row for setting in (fig3.SPRINGS, fig3.RIGID) for path, loads in fig3.LOADS.items()
                 for row in product(stress_path=path, delta_sigma=loads, preparation_friction=(0.0, 0.1), cycles=80, seed=1, **setting)]}
# |strain a cycle| below which a packing counts as at rest: rates of MD below about 1e-7 are noise, those of CD the error of its solver.
REST = 1e-7
STRAINS, RESTS, COLLAPSES = "strains", "rests", "collapses"


def verdict(run, count):
    """Return what the first `count` cycles of a run say: whether it collapses in them, or rests or strains in the second half of them."""
    found = cycles.of(run)
    if len(found.number) < count:
        return COLLAPSES
    return STRAINS if abs(found.rates([(count // 2 + 1, count)])[0]) > REST else RESTS


@summary.each
def summarize(run):
    """Return the row of a run: verdict and rate at half of its cycles and at all, and the contacts that slip in its first loading and last unloading.

    rate: mean change of gamma a cycle in the second half of the cycles counted. contacts that slip: (sum s)^2 / sum s^2 over their slips s.
    first to last peak: net slip between these two states, not the sum of all slips between them. work of slip: sum of mu N s over the contacts, N
    the mean of their normal forces at both ends.
    """
    found, whole = cycles.of(run), run.parameters["cycles"]
    row = summary.columns(run, "method", "stress path", "preparation friction", "dSigma", "seed", "load over limit", "collapses after")
    for name, count in (("half", whole // 2), ("all", whole)):
        row[f"verdict of {name}"] = verdict(run, count)
        row[f"rate of {name}"] = found.rates([(count // 2 + 1, count)])[0] if len(found.number) >= count else np.nan
    stands = len(found.number) == whole
    for name, ends in (("first loading", (0, 1)), ("last unloading", (-2, -1))):
        first, second = (run.snapshots[end] for end in ends)
        slipped, shared = slip.over(run, [(first, second)]) if stands else (np.nan, np.nan)
        row |= {f"slip of a contact/R, {name}": slipped, f"contacts that slip, {name}": shared,
                f"at Coulomb's limit, {name}": observables.sliding(second).sum() if stands else np.nan}
    row["slip of a contact/R, first to last peak"] = slip.over(run, [(run.snapshots[1], run.snapshots[-2])])[0] if stands else np.nan
    if stands and run.method == "MD":
        # An independent check of the slip: the dissipation of friction that the engine sums in every step.
        times, friction = run.values("time"), run.values("friction_dissipation")
        before, after = (friction[np.abs(times - snapshot["time"]).argmin()] for snapshot in (first, second))
        row["work of slip over friction's, last unloading"] = slip.work(run, first, second) / (after - before) if after > before else np.nan
    return row | summary.columns(run, "unsolved steps")


def draw(runs, rows, path):
    """Draw the rate after all cycles against that after half of them, and the slip of a contact in the last unloading against that in the first
    loading."""
    fig, axes = plt.subplots(1, 2, figsize=(8.5, 4.2))
    table = pandas.DataFrame(rows)
    panels = (("rate of half", "rate of all", r"$|\Delta\gamma|$ a cycle, ", ("after half of the cycles", "after all cycles")),
              ("slip of a contact/R, first loading", "slip of a contact/R, last unloading", "slip of a contact / R, ",
               ("first loading", "last unloading")))
    for axis, (before, after, words, ends) in zip(axes, panels):
        for (method, friction), own in table.groupby(["method", "preparation friction"]):
            size = 5 if friction == 0 else 2.5
            style.points(axis, own.assign(**{name: own[name].abs() for name in (before, after)}), before, after, method, ms=size,
                         label=f"{method}, {'dense' if friction == 0 else 'loose'}")
        known = table[[before, after]].abs().dropna().to_numpy().ravel()
        if len(known := known[known > 0]):
            axis.plot([known.min(), known.max()], [known.min(), known.max()], color="0.4", lw=0.8, ls=":")
        axis.set(xscale="log", yscale="log", xlabel=words + ends[0], ylabel=words + ends[1])
    axes[0].axhline(REST, color="0.7", lw=0.8)
    axes[0].legend(fontsize=7)
    style.finish(fig, path, "A point a run that does not collapse; dotted: no change. Left: means over the second half of the cycles counted; "
                 "below the grey line a packing counts as at rest.", runs)


ANSWER = """
Of 56 runs 5 get another verdict after 80 cycles than after 40. Three loose packings that strained after 40 cycles collapse before 54 (2 of springs
and 1 of rigid grains), and 2 of rigid grains come to rest. With stress ratios up to 1.5 all 28 runs stand 80 cycles, too. A rate is less certain than
a verdict. In the 13 runs of springs that strain after both, the rate of cycles 41 to 80 is 0.60 times that of cycles 21 to 40 (median), but it lies
between 0.07 and 7.96 times, and 5 of the 13 strain faster. "Strains" means more than 1e-7 a cycle in the second half of the cycles.

With springs, contacts go on slipping where the packing has come to rest. In the 3 runs of springs at rest, all of the dense packing, a contact slips
by 9.8e-6 to 9.2e-5 R in the last unloading (mean over the contacts). This is 0.32 to 0.35 times as far as in the first loading, and 18 to 40 contacts
share it. The strain is 2.0e-8 a cycle at most, because contacts slip to and fro: between the first and the last peak of the load, 79 cycles later, a
contact has slipped by 4.3 to 15.2 times as much as in one unloading, not by 158 times. Times mu and the mean normal force these slips are 0.97 to
1.06 times the friction's dissipation that the engine sums in every step. In all 8 runs of this packing that stand, contacts slip 0.28 to 0.49 times
as far in the last unloading as in the first loading; on the loose packing 0.02 to 0.06 times.

With rigid grains, slip ends. In the 17 runs at rest a contact slips by 1.6e-7 R at most in the last unloading, which is the error of the solver,
while it slipped by up to 0.041 R in the first loading. Still, 18 to 164 contacts are at Coulomb's limit there. A rigid contact at Coulomb's limit
need not slip.
"""
GIVEN = ("1e-7", "21", "41", "79", "80", "158", "1.5", "54")


def numbers(table):
    half, whole, slips = "verdict of half", "verdict of all", [f"slip of a contact/R, {name}" for name in ("first loading", "last unloading")]
    other = table[table[half] != table[whole]].groupby(["method", whole]).size()
    falls = table[(table[half] == STRAINS) & (table[whole] == COLLAPSES)]
    low = table[table.dSigma <= table["stress path"].map({"mean": 0.2, "constant": 0.5})]
    springs, rigid = (table[table.method == method] for method in ("MD", "CD"))
    moving = springs[(springs[half] == STRAINS) & (springs[whole] == STRAINS)]
    change = (moving["rate of all"] / moving["rate of half"]).abs()
    quiet, rests = (rows[rows[whole] == RESTS] for rows in (springs, rigid))
    over = lambda rows: rows[slips[1]] / rows[slips[0]]
    dense, loose = (springs[(springs["preparation friction"] > 0) == which].dropna(subset=slips) for which in (False, True))
    shared, limit = quiet["contacts that slip, last unloading"], rests["at Coulomb's limit, last unloading"]
    assert (falls["preparation friction"] > 0).all() and len(falls) == 3 and falls["collapses after"].between(40, 54).all()
    assert (low[whole] != COLLAPSES).all() and (quiet["preparation friction"] == 0).all() and len(loose) == len(dense)
    return {"56": len(table), "5": [other.sum(), (change > 1).sum()], "40": shared.max(), "2": [other["MD", COLLAPSES], other["CD", RESTS]],
            "1": other["CD", COLLAPSES], "28": len(low), "13": len(moving), **summary.stated("0.60 0.07 7.96", change, "median min max"),
            "3": len(quiet), **summary.stated("9.8e-6 9.2e-5", quiet[slips[1]]), **summary.stated("0.32 0.35", over(quiet)),
            "18": [shared.min(), limit.min()], "2.0e-8": quiet["rate of all"].abs().max(),
            **summary.stated("4.3 15.2", quiet["slip of a contact/R, first to last peak"] / quiet[slips[1]]),
            **summary.stated("0.97 1.06", quiet["work of slip over friction's, last unloading"]),
            "8": len(dense), **summary.stated("0.28 0.49", over(dense)), **summary.stated("0.02 0.06", over(loose)),
            "17": len(rests), "1.6e-7": rests[slips[1]].max(), "0.041": rests[slips[0]].max(), "164": limit.max()}
