"""Do rigid grains whose contact forces are unique (isostatic packings) strain as stiff springs do?

Rigid disks without friction that strain in steps: G. Combe and J.-N. Roux, Phys. Rev. Lett. 85, 3628 (2000).
"""
import numpy as np
import pandas

from analysis import style, summary
from analysis.style import plt
from yade_scripts.tables import product
from yade_scripts.theory import statics

TITLE = "Do rigid grains rest because their forces are undetermined?"
QUESTION = "Packings without friction, whose forces become unique as P0/k_n goes to zero, against packings with friction."
ORDER = 6.5  # in the report
LOADING = dict(loading="triangle", period=1.0, wall_mass_ratio=1.0)
LOAD, SMALLER = 0.02, 0.005  # over P0; the smaller one is below the static limits of all packings
METHODS = (dict(method="MD", md_dt_factor=0.3, md_walls="force", **LOADING), dict(method="CD", tolerance=1e-9, **LOADING))
ROWS = {"quick": [row for method in METHODS for row in product(stiffening=(1, 100), friction=0.0, delta_sigma=LOAD, **method)],
        "full": [row for method in METHODS for packings in (dict(stiffening=(1, 10, 100, 600), friction=(0.0, 0.1), delta_sigma=LOAD),
                                                            dict(stiffening=600, friction=0.0, delta_sigma=SMALLER))
                 for row in product(**packings, seed=range(1, 6), **method)]}


def summarize(runs):
    """Return one row a packing and load: the freedom of its forces, its limit, and the strain of both methods.

    freedom: dimension of the set of force networks that balance the walls, over the number of disks that carry.
    """
    rows = []
    for several in summary.by(runs, "friction", "k_n over the usual", "dSigma", "seed").values():
        pair, last = {run.method: run for run in several}, several[-1]  # of CD, if there is one
        loaded = last.snapshots[0]["force_normal"] > 0
        contacts, disks, _ = statics.degrees_of_freedom(last.snapshots[0], loaded)
        rows.append(summary.columns(last, "friction", "P0/k_n", "dSigma", "seed") | {
            "contacts": contacts, "disks": disks, "freedom": statics.dimension(last.snapshots[0], loaded) / disks,
            **summary.columns(last, "static limit")})
        for method in style.MARKER:
            run = pair.get(method)
            gamma = run.values("gamma") if run else np.array([np.nan])
            rows[-1] |= {f"largest |gamma|, {method}": np.abs(gamma).max(), f"remaining |gamma|, {method}": abs(gamma[-1]),
                         f"outcome, {method}": run.outcome if run else ""}
        rows[-1] |= summary.columns(last, "unsolved steps")
    return rows


def draw(runs, rows, path):
    """Draw packing by packing the largest strain of both methods, and the freedom of the forces.

    The strain is drawn against the load over the limit without friction, against P0/k_n with friction.
    """
    table = pandas.DataFrame(rows).query("dSigma == @LOAD").assign(load=lambda rows: (1 + LOAD) / rows["static limit"])
    groups, names = dict(list(table.groupby("friction"))), {method: f"largest |gamma|, {method}" for method in style.MARKER}
    fig, axes = plt.subplots(1, len(groups) + 1, figsize=(3.7 * (len(groups) + 1), 3.9), squeeze=False)
    axes = axes[0]
    for axis, (friction, own) in zip(axes, groups.items()):
        x = "P0/k_n" if friction else "load"
        axis.vlines(own[x], own[names["CD"]], own[names["MD"]], color=style.GREY["BB"], lw=0.7, zorder=1)
        for method, face in (("MD", None), ("CD", "none")):
            style.points(axis, own, x, names[method], method, mfc=face, label=style.WORDS[method])
        if friction:
            axis.set(xscale="log", xlabel="$P_0/k_n$", title=rf"with friction, $\mu$ = {friction:g}")
        else:
            axis.set(xlabel="load over the static limit", title="without friction")
            axis.axvline(1, color="k", lw=0.7, ls=":")
        axis.set_yscale("log")
    everywhere = table[names.values()].stack().loc[lambda strains: strains > 0]  # without the NaN of missing runs
    if len(everywhere):
        plt.setp(axes[:-1], ylim=(everywhere.min() / 2, everywhere.max() * 2))
    axes[0].set_ylabel(r"largest $|\gamma|$ in the cycle")
    axes[0].legend()
    for friction, own in groups.items():
        style.points(axes[-1], own, "P0/k_n", "freedom", "CD", marker="o" if friction else "D", color="k", mfc="k" if friction else "none",
                     label=rf"$\mu$ = {friction:g}")
    axes[-1].set(xscale="log", xlabel="$P_0/k_n$", ylabel="degree of force indeterminacy per disk", ylim=(0, None))
    axes[-1].legend()
    style.finish(fig, path, "A cycle of 0.02 P0 from the same packings; grey lines join both methods on one packing.",
                 [run for run in runs if run.parameters["delta_sigma"] == LOAD] or runs)


def quantities(table):
    cd, md = (f"largest |gamma|, {method}" for method in ("CD", "MD"))
    small, table = table[table.dSigma == SMALLER], table[table.dSigma == LOAD]
    smooth, rough = table[table.friction == 0], table[table.friction > 0]
    soft, hard = (smooth[smooth["P0/k_n"] == end] for end in (smooth["P0/k_n"].max(), smooth["P0/k_n"].min()))
    carried = smooth["static limit"] > 1 + LOAD
    rests, strains = smooth[carried], smooth[~carried]
    hardest = strains[strains["P0/k_n"] == strains["P0/k_n"].min()]
    harder = hardest[cd] / hardest[md]
    power = [np.polyfit(np.log(part["P0/k_n"]), np.log(part[md]), 1)[0] for _, part in rough.groupby("seed")]
    assert (small["static limit"] > 1 + SMALLER).all() and not table["unsolved steps"].any() and smooth["P0/k_n"].nunique() == 4
    return locals() | {"power": pandas.Series(power)}
