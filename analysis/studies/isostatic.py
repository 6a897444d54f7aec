"""Do rigid grains whose contact forces are unique (isostatic packings) strain as stiff springs do?

Rigid disks without friction that strain in steps: G. Combe and J.-N. Roux, Phys. Rev. Lett. 85, 3628 (2000).
"""
import numpy as np
import pandas

from analysis import style, summary
from analysis.style import plt
from yade_scripts.tables import product
from yade_scripts.theory import statics

TITLE = "The isostatic limit: rigid grains whose contact forces are nearly unique"
QUESTION = ("Do rigid grains rest under a changed load because many force networks can balance it? As P0/k_n goes to zero, a packing without "
            "friction has only one network left. Do rigid grains then strain as far as very stiff springs, and do they still rest with friction?")
ORDER = 8  # in the report
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
        axis.vlines(own[x], own[names["CD"]], own[names["MD"]], color="#BBBBBB", lw=0.7, zorder=1)
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
    style.finish(fig, path, r"A cycle of 0.02 $P_0$ from the same packings; grey lines join both methods on one packing.",
                 [run for run in runs if run.parameters["delta_sigma"] == LOAD] or runs)


ANSWER = """
Without friction rigid grains rest if their contacts can carry the load, and strain if they cannot. Just beyond the limit they strain under the load
about as far as very stiff springs do. The contact forces become unique as P0/k_n falls: the set of admissible forces has 0.037 to 0.069 dimensions a
disk at 6e-4, and at most 0.0027, which is one for the whole packing, at 1e-6. The static limit falls as well, from 1.06 to 1.14 P0 down to 1.01 to
1.04 P0. The load is 1.02 P0 on 5 packings at four stiffnesses. In 12 of 12 cases whose limit is above it CD rests (|gamma| of 8.8e-9 at most). In the
8 others, 4 packings at 6e-6 and at 1e-6, CD strains by 6.6e-6 to 5.1e-4. That is 0.67 to 0.93 times the strain of MD at 6e-6 and 0.75 to 0.98 times
at 1e-6. After the unloading one packing keeps 4.5e-4 to 4.7e-4 with both methods and both stiffnesses. On the 3 others MD keeps 1e-5 at most and CD
1.5e-6.

Rigid grains do not need undetermined forces to rest. A load of 1.005 P0 at 1e-6 is below all limits, and CD rests on 5 of 5 packings, although the
set of their admissible forces has at most one dimension. But the largest load under which they rest is only a little above that of their preparation.
Nor does the number of dimensions alone determine the limit: what matters is how far the forces can vary, which depends on friction, pressure and
geometry. With friction 0.81 to 0.98 dimensions a disk are left at all pressures, the limit stays at 1.40 to 1.60 P0, far above this load, CD rests in
20 of 20 cases (1.3e-9 at most), and MD's strain goes as P0/k_n to the power 0.99 (0.97 to 1.01). Packings with friction were not loaded beyond their
limit here: see the studies of the ramp and of ratcheting. No step of CD missed its tolerance of 1e-9. All packings have 400 disks. Combe and Roux
(2000) found that rigid disks without friction strain in steps, each under a load that is the smaller the more disks there are; so a limit of 1.01 to
1.04 P0 belongs to this size.
"""
GIVEN = ("1.02", "1.005", "6e-4", "6e-6", "1e-6", "1e-9", "400")


def numbers(table):
    cd, md = "largest |gamma|, CD", "largest |gamma|, MD"
    small, table = table[table.dSigma == SMALLER], table[table.dSigma == LOAD]
    smooth, rough = table[table.friction == 0], table[table.friction > 0]
    soft, hard = (smooth[smooth["P0/k_n"] == end] for end in (smooth["P0/k_n"].max(), smooth["P0/k_n"].min()))
    carried = smooth["static limit"] > 1 + LOAD
    rests, strains = smooth[carried], smooth[~carried]
    ratio = (strains[cd] / strains[md]).groupby(strains["P0/k_n"]).agg(["min", "max"])
    kept = strains[[f"remaining |gamma|, {method}" for method in ("CD", "MD")]].groupby(strains.seed.rename("packing"))
    most = kept.max().max(axis=1)
    keeps, others = kept.get_group(most.idxmax()).stack(), strains[strains.seed != most.idxmax()]
    power = [np.polyfit(np.log(part["P0/k_n"]), np.log(part[md]), 1)[0] for _, part in rough.groupby("seed")]
    assert (small["static limit"] > 1 + SMALLER).all() and not table["unsolved steps"].any()
    assert strains["P0/k_n"].nunique() == 2 and smooth["P0/k_n"].nunique() == 4
    return {**summary.stated("0.037 0.069", soft.freedom), "0.0027": hard.freedom.max(), **summary.stated("1.06 1.14", soft["static limit"]),
            "1.01": [hard["static limit"].min(), max(power)], "1.04": hard["static limit"].max(),
            "5": [len(small), (small[cd] < 1e-7).sum(), smooth.seed.nunique()], "12": [len(rests), (rests[cd] < 1e-8).sum()],
            "8.8e-9": rests[cd].max(), "8": [len(strains), (strains[cd] > 1e-6).sum()], "4": strains.seed.nunique(),
            **summary.stated("6.6e-6 5.1e-4", strains[cd]), "0.67": ratio["min"].iloc[1], "0.93": ratio["max"].iloc[1], "0.75": ratio["min"].iloc[0],
            "0.98": [ratio["max"].iloc[0], rough.freedom.max()], **summary.stated("4.5e-4 4.7e-4", keeps), "3": others.seed.nunique(),
            "1e-5": others["remaining |gamma|, MD"].max(), "1.5e-6": others["remaining |gamma|, CD"].max(),
            "0.81": rough.freedom.min(), **summary.stated("1.40 1.60", rough["static limit"]), "20": len(rough),
            "1.3e-9": rough[cd].max(), **summary.stated("0.99 0.97", power, "median min")}
