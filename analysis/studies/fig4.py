"""Fig. 4: stress against gamma over one loading and unloading, MD and CD from the same packings."""
import numpy as np

from analysis import limits, observables, slip, style, summary
from analysis.style import plt
from yade_scripts.tables import product

TITLE = "Fig. 4: one cycle of loading and unloading"
QUESTION = ("From the same packing, how far do the loops of stress against strain of springs (MD) and rigid contacts (CD) differ, "
            "how much do they dissipate and what strain do they keep - and is that so for every packing?")
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


def draw(runs, rows, path):
    """Draw the loops of dense packings; those of loose ones in a figure of their own."""
    usual = [run for run in runs if run.method == "CD" or run.parameters["md_dt_factor"] not in FINER]
    for friction, own in summary.by(usual, "preparation friction").items():
        _draw_loops(own, path if friction == 0 else path.with_name(f"{path.stem}-loose.png"), "dense" if friction == 0 else "loose")


# Sizes that can still be read where the figure is 390 pixels wide.
LARGE = {"axes.labelsize": 12, "xtick.labelsize": 11, "ytick.labelsize": 11, "legend.fontsize": 11}


def _draw_loops(runs, path, words):
    """Draw both methods on the same axes, a line a packing, the first one bold. Runs with the mean stress held stand in an inset."""
    (held, own), *other = summary.by(runs, "stress path").items()
    with plt.rc_context(LARGE):
        fig, axis = plt.subplots(figsize=(7.2, 5.6 if other else 4.6))
        _loops(axis, held, own)
        axis.set_ylabel(r"measured $\sigma_2/P_0$")
        axis.legend(loc="lower left" if other else "upper left")
        axis.set_ylim(top=1.5)  # room above the loops, for the legend
        for held, own in other:
            axis.set(ylim=(None, 1.4), yticks=(1, 1.05, 1.1, 1.15, 1.2))  # for the inset
            _loops(axis.inset_axes([0.1, 0.71, 0.8, 0.28]), held, own)
        style.finish(fig, path, f"sigma2 rises by 0.2 P0 and falls back (dashed); {words} packings, a line each, bold: the first.", runs)


def _loops(axis, held, runs):
    """Draw the loops of runs, the first of each method bold, with the largest strain of the method in its label."""
    exponent = style.power_of_ten(np.concatenate([[0.0], *(run.values("gamma") for run in runs)]))
    for method, own in summary.by(runs, "method").items():
        largest = max(np.abs(run.values("gamma")).max() for run in own)
        for run in own:
            gamma, stress, first = run.values("gamma") * 10.0**-exponent, run.values("sigma2") / run.pressure, run is own[0]
            top = int(np.argmax(observables.load(run)))
            look = dict(color=style.COLOUR[method], linewidth=2.2 if first else 0.7, alpha=1 if first else 0.6)
            axis.plot(gamma[:top + 1], stress[:top + 1], label=rf"{style.WORDS[method]}: $|\gamma|$ up to {largest:.1e}" if first else None, **look)
            axis.plot(gamma[top:], stress[top:], linestyle=(0, (4, 1.5)), **look)
    axis.set_xlabel(rf"$\gamma = \epsilon_2 - \epsilon_1$ [$10^{{{exponent}}}$] (< 0: shortens) with {style.STRESS_PATH[held]}")


POINTS = (
    (4, "The perturbation that the loading exerts on the system is much weaker in the CD simulation", "section 3, Fig. 4", "agrees"),
    (6, "But note also that the energy dissipated is bigger in the MD cycle, and so is the remanent strain at the end of the process.",
     "section 3, Fig. 4", "agrees in part"),
)


def quantities(table):
    largest, kept, lost, error = "largest |gamma|", "remanent gamma", "dissipated/P0V0", "stress error/P0"
    finer, table = (table[table.md_dt_factor.isin(FINER) == which] for which in (True, False))
    loose, dense = (table[(table["preparation friction"] > 0) == which] for which in (True, False))
    rows = dict(list(dense.set_index("seed").groupby(["method", "stress path"])))
    md, cd, md_mean, cd_mean = (rows[method, path] for path in style.STRESS_PATH for method in style.WORDS)
    loose_md, loose_cd = (loose[loose.method == method].set_index("seed") for method in style.WORDS)
    both = [((one[lost] > other[lost]) & (one[kept].abs() > other[kept].abs())).sum()
            for one, other in ((md, cd), (md_mean, cd_mean), (loose_md, loose_cd))]  # pairs in which MD dissipates and keeps more
    stands, top = loose_cd[largest] < 1e-5, 1 + LOADING["delta_sigma"]
    yields, further, limit = loose_cd[~stands], (loose_md[largest] / loose_cd[largest])[~stands], loose_cd["static limit"]
    below = top / limit[~stands & (limit > top)]
    ratio, errors = limits.stress_ratio(cd_mean["static limit"], "mean"), dense["balance error"].abs().groupby(dense["stress path"]).max()
    unbalanced, finer = loose["balance error"].abs().sort_values(), finer.set_index("md_dt_factor")["balance error"].abs()
    rests, moves, times = cd_mean[ratio > 1.5], cd_mean[ratio < 1.5], (md_mean[largest] / cd_mean[largest])[ratio < 1.5]
    assert np.allclose(ratio, cd["static limit"], rtol=1e-6) and cd[largest].max() < 1e-7
    assert (rests[largest] < 1e-5).all() and (moves[largest] > 1e-4).all() and not dense["unsolved steps"].any()
    assert both[0] == both[1] and len(below) == 1 and (yields[largest] > 1e-4).all() and limit[stands].min() > 1.27
    assert (loose_cd["unsolved steps"] > 0).sum() == 1
    return locals()
