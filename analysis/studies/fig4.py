"""Fig. 4: stress against gamma over one loading and unloading, MD and CD from the same packings."""
import numpy as np
import pandas

from analysis import limits, observables, slip, style, summary
from analysis.style import plt
from yade_scripts.tables import product

TITLE = "One cycle: how far do springs and rigid grains strain?"
QUESTION = "Fig. 4 of the paper on 10 packings of each kind and both stress paths, from the same starting states."
ORDER = 1  # in the report
# The kinks of the triangle change MD's remanent strain by 1 % with this period of 4 s, compared with slower loading, and by 4 % with 1 s.
# The servo's goals are updated in every step, so that the work of its walls is summed as finely as what friction and dashpots dissipate.
LOADING = dict(loading="triangle", delta_sigma=0.2, period=4.0, md_load_every=1)
# With the mean stress held most packings yield. Strains are then of the order of 1e-3, and at 1e-7 every step can be solved.
YIELDING = dict(tolerance=1e-7)
# Walls that forces push: a servo would lag behind where a packing yields.
FREE = dict(md_walls="force", wall_mass_ratio=1.0)
LOOSE = dict(preparation_friction=0.1)  # the paper's friction while they are compacted, too; dense packings are compacted without
FINER = (0.1, 0.05)  # of the default md_dt_factor a half and a quarter, on the packing where the energies balance worst
ROWS = {"quick": product(seed=1, method=("MD", "CD"), **LOADING),
        "full": product(seed=range(1, 11), method=("MD", "CD"), **LOADING)
        + [row for more in (dict(stress_path="mean"), LOOSE) for method in (dict(method="MD"), dict(method="CD") | YIELDING)
           for row in product(seed=range(1, 11), **LOADING | FREE | more | method)]
        + product(method="MD", seed=10, md_dt_factor=FINER, **LOADING | FREE | LOOSE)}


@summary.each
def summarize(run):
    """Return the row of a run: the loop, the energies in units of P0 V0, and how well they balance."""
    gamma, snapshot = run.values("gamma"), observables.snapshot_at_load_maximum(run)[0]
    scale, (slipped, shared) = observables.work_scale(run), slip.of(run)
    return summary.columns(run, "method", "stress path", "preparation friction", "seed", "static limit", "outcome", "largest |gamma|") | {
        "md_dt_factor": run.parameters["md_dt_factor"] if run.method == "MD" else "",
        "remanent gamma": observables.change(run, "gamma"), "loop width": observables.loop_width(gamma, run.values("sigma2")),
        "dissipated/P0V0": observables.change(run, "dissipated_energy") / scale, "work/P0V0": observables.change(run, "wall_work") / scale,
        "balance error": observables.balance_error(run), "work by stress and strain, error": observables.work_error(run),
        "at Coulomb's limit at the maximum": observables.sliding(snapshot).sum(), "slip of a contact/R": slipped,
        "contacts that slip": shared if run.method == "MD" else "", "coordination at the maximum": observables.coordination(snapshot),
        **summary.columns(run, "stress error/P0", "unsolved steps")}


# Sizes that can still be read where the figure is as wide as a phone.
LARGE = {"axes.labelsize": 12, "axes.titlesize": 13, "xtick.labelsize": 11, "ytick.labelsize": 11, "legend.fontsize": 10.5}


def draw(runs, rows, path):
    """Draw the loops of one packing, a panel a method as in the paper, and the largest strain of all packings against the load over the limit."""
    first = {run.method: run for run in reversed(runs) if run.parameters["preparation_friction"] == 0 and run.parameters["stress_path"] == "constant"}
    shown = [first[method] for method in style.WORDS if method in first]
    with plt.rc_context(LARGE):
        fig, axes = plt.subplots(1, len(shown) + 1, figsize=(3.2 * len(shown) + 5.2, 4.3), width_ratios=[3.2] * len(shown) + [5.2])
        widest = max(shown, key=lambda run: np.abs(run.values("gamma")).max())
        exponent = style.power_of_ten(widest.values("gamma"))
        for axis, run in zip(axes, shown):
            _loop(axis, run, exponent)
            axis.sharex(axes[0])
        axes[0].set_ylabel(r"stress $\sigma_2/P_0$")
        _strains(axes[-1], pandas.DataFrame(rows))
        style.finish(fig, path, "Left and middle: one packing, loaded to 1.2 P0 and unloaded, in one scale. Right: each point is a packing. Rigid "
                     "packings at rest show the error of the solver: the lower band of steps solved to 1e-8 (dense packings, sigma1 held), "
                     "the upper one of steps solved to 1e-7.", runs)


def _loop(axis, run, exponent):
    gamma, stress, top = run.values("gamma"), run.values("sigma2") / run.pressure, int(np.argmax(observables.load(run)))
    for part, line, words in ((slice(top + 1), "-", "loading"), (slice(top, None), (0, (4, 1.5)), "unloading")):
        axis.plot(-gamma[part] * 10.0**-exponent, stress[part], color=style.COLOUR[run.method], ls=line, lw=2, label=words)
    if run.method == "MD":
        axis.legend(loc="upper left")
    axis.set(title=style.WORDS[run.method], xlabel=rf"strain $-\gamma$  [$10^{{{exponent}}}$]", yticks=(1, 1.1, 1.2))
    if run.method == "CD":
        words = f"no motion: the strain\nof {np.abs(gamma).max():.0e} is the\nerror of the solver".replace("e-0", "e-")
        axis.text(0.55, 0.4, words, transform=axis.transAxes, ha="center", fontsize=11, color=style.GREY["55"])


def _strains(axis, table):
    """Draw the largest strain of the cycle against the load over the limit."""
    for (method, friction), own in table[~table.md_dt_factor.isin(FINER)].groupby(["method", "preparation friction"]):
        own = own.assign(over=load_over_limit(own))
        style.points(axis, own, "over", "largest |gamma|", method, ms=7 if friction == 0 else 4,
                     label=f"{style.WORDS[method]}, {'dense' if friction == 0 else 'loose'} packings")
    axis.axvline(1, color="k", lw=0.8, ls=":")
    axis.set(yscale="log", title="one cycle, all packings", xlabel=r"largest $\sigma_2/\sigma_1$ of the cycle over the static limit",
             ylabel=r"largest strain $|\gamma|$")
    axis.annotate("rigid packings rest", (0.03, 0.2), xycoords="axes fraction", fontsize=11, color=style.COLOUR["CD"])
    axis.text(0.995, 0.02, "static limit ", transform=axis.get_xaxis_transform(), ha="right", fontsize=11, color=style.GREY["55"])
    axis.legend(loc="center left", bbox_to_anchor=(0, 0.5))


def load_over_limit(table):
    """Return the largest sigma2/sigma1 of the cycle over that of the static limit."""
    ratio = lambda load: load.where(table["stress path"] == "constant", limits.stress_ratio(load, "mean"))
    return ratio(pandas.Series(1 + LOADING["delta_sigma"], table.index)) / ratio(table["static limit"])


POINTS = (
    (7, "The perturbation that the loading exerts on the system is much weaker in the CD simulation", "section 3", "agrees in part"),
    (9, "But note also that the energy dissipated is bigger in the MD cycle, and so is the remanent strain at the end of the process.",
     "section 3", "agrees in part"),
)


def quantities(table):
    largest, kept, lost = "largest |gamma|", "remanent gamma", "dissipated/P0V0"
    table = table[~table.md_dt_factor.isin(FINER)]
    loose, dense = (table[(table["preparation friction"] > 0) == which] for which in (True, False))
    rows = dict(list(dense.set_index("seed").groupby(["method", "stress path"])))
    md, cd, md_mean, cd_mean = (rows[method, path] for path in style.STRESS_PATH for method in style.WORDS)
    loose_md, loose_cd = (loose[loose.method == method].set_index("seed") for method in style.WORDS)
    both = [((one[lost] > other[lost]) & (one[kept].abs() > other[kept].abs())).sum()
            for one, other in ((md, cd), (md_mean, cd_mean), (loose_md, loose_cd))]  # pairs in which MD dissipates and keeps more
    stands, top = loose_cd[largest] < 1e-5, 1 + LOADING["delta_sigma"]
    yields, further, limit = loose_cd[~stands], (loose_md[largest] / loose_cd[largest])[~stands], loose_cd["static limit"]
    below = limit[~stands & (limit > top)]
    ratio = limits.stress_ratio(cd_mean["static limit"], "mean")
    rests, moves, times = cd_mean[ratio > 1.5], cd_mean[ratio < 1.5], (md_mean[largest] / cd_mean[largest])[ratio < 1.5]
    assert np.allclose(ratio, cd["static limit"], rtol=1e-6) and cd[largest].max() < 1e-7
    assert (rests[largest] < 1e-5).all() and (moves[largest] > 1e-4).all() and not dense["unsolved steps"].any()
    passed = pandas.concat([1 / times, 1 / further]) > 1  # of all packings on which rigid contacts strain
    assert both[0] == both[1] and len(below) == 1 and (yields[largest] > 1e-4).all() and limit[stands].min() > 1.27
    assert (loose_cd["unsolved steps"] > 0).sum() == 1
    return locals()
