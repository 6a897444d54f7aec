"""Do verdicts on load cycles stand when a run is continued to twice its length, and how far do contacts slip in an early and in a late cycle?"""
import numpy as np
import pandas

from analysis import cycles, observables, slip, style, summary
from analysis.studies import fig3
from analysis.style import plt
from yade_scripts.tables import product

TITLE = "Does slip stop where the strain does?"
QUESTION = "Fig. 3 continued to 80 cycles for one dense and one loose packing, with the slip of every contact."
ORDER = 3.4  # in the report
ROWS = {"quick": fig3.ROWS["quick"],
        "full": [row for setting in (fig3.SPRINGS, fig3.RIGID) for path, loads in fig3.LOADS.items()
                 for row in product(stress_path=path, delta_sigma=loads, preparation_friction=(0.0, 0.1), cycles=80, seed=1, **setting)]}
# |strain a cycle| below which a packing counts as at rest: MD's rates below about 1e-7 are noise, and CD's are not far above its solver's error.
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
        # An independent measure of slip: the dissipation of friction, which the engine sums in every step.
        friction = np.diff(np.interp(np.arange(2 * whole + 1) / 2, run.values("cycle"), run.values("friction_dissipation")))  # of half cycles
        row |= {"work of slip over friction's, last unloading": slip.work(run, first, second) / friction[-1],
                "friction's, last over first unloading": friction[-1] / friction[1],
                "friction's, last loading over last unloading": friction[-2] / friction[-1]}
    return row | summary.columns(run, "unsolved steps")


def draw(runs, rows, path):
    """Draw the rate after all cycles against that after half of them, and the slip of a contact in the last unloading against that in the first
    loading."""
    fig, axes = plt.subplots(1, 2, figsize=(8.5, 4.2))
    table = pandas.DataFrame(rows)
    panels = (("rate of half", "rate of all", r"$|\Delta\gamma|$ a cycle, ", ("second quarter of the run", "second half of the run")),
              ("slip of a contact/R, first loading", "slip of a contact/R, last unloading", "mean slip of a contact / R, ",
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
    axes[0].axvline(REST, color="0.7", lw=0.8)
    axes[0].legend(fontsize=7)
    standing = [run for run, row in zip(runs, rows) if row["verdict of all"] != COLLAPSES]
    style.finish(fig, path, "Each point is a run that does not collapse; dotted: equal values. Left: below a grey line the packing counts as at "
                 "rest.", standing or runs)


POINTS = (
    (21, "This behavior is associated to a quasi-periodic response of the sliding contacts", "section 3", "agrees in part"),
)


def quantities(table):
    half, whole = "verdict of half", "verdict of all"
    first, last = (f"slip of a contact/R, {name}" for name in ("first loading", "last unloading"))
    stands, other = table[table[half] != COLLAPSES], table[table[half] != table[whole]]
    falls, rest = other[other[whole] == COLLAPSES], other[other[whole] == RESTS]
    low = table[table.dSigma <= table["stress path"].map({"mean": 0.2, "constant": 0.5})]
    springs, rigid = (table[table.method == method] for method in ("MD", "CD"))
    quiet, rests = (rows[rows[whole] == RESTS] for rows in (springs, rigid))
    never, slipped = rests[rests[first] < 1e-6], rests[rests[first] >= 1e-6]
    assert (other["preparation friction"] > 0).all() and (rest.method == "CD").all() and falls["collapses after"].between(40, 54).all()
    assert (low[whole] != COLLAPSES).all() and (quiet["preparation friction"] == 0).all() and len(falls) == len(quiet) == 3
    return locals()
