"""Do verdicts on load cycles stand when a run is continued to twice its length, and how many contacts slip in an early and in a late cycle?"""
import numpy as np
import pandas

from analysis import cycles, observables, slip, style, summary
from analysis.studies import fig3
from analysis.style import plt
from yade_scripts.tables import product

TITLE = "Fig. 3 continued to twice as many cycles"
QUESTION = ("Most runs of Fig. 3 have 40 cycles. Would another verdict follow from 80? Those of the first dense and the first loose packing, a "
            "fifth of all, are continued. In them slip is measured, too, which is more than being at Coulomb's limit.")
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
