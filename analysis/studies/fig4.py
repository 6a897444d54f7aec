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


ANSWER = """
With sigma1 held, springs strain on each of 10 dense packings (compacted without friction) and rigid contacts rest. The largest |gamma| is 4.3e-4
(median; 3.2e-4 to 5.0e-4) in MD and 3.8e-8 (1.5e-8 to 4.5e-8) in CD. After the unloading MD keeps |gamma| = 1.2e-4 and has dissipated 9.9e-6 P0 V0;
CD keeps 2.7e-8 and has dissipated 7.8e-8 P0 V0. So MD keeps more strain and dissipates more, as the paper reports. The strain of CD is the error of
its solver at a tolerance of 1e-8: see the study of the tolerance. A contact of MD slips by 3.1e-4 of a radius in total, and the slip is distributed
as if 80 contacts shared it equally.

With the mean stress held, the same dSigma is a higher stress ratio, sigma2/sigma1 = 1.5 instead of 1.2, which is near what the packings can carry:
their static limits are 1.41 to 1.74, the same on both paths. CD rests on 4 of 4 packings whose limit is above 1.5 (|gamma| of 1.6e-6 at most, at a
tolerance of 1e-7). It strains on 6 of 6 whose limit is below, by 5.0e-4 to 4.6e-3. MD strains on all 10, by 1.7e-3 to 2.4e-2, and on these 6 by 4.4
to 13.5 times as much as CD. How far a packing strains above its limit depends on how long the load stays there. In both methods forces push the
walls. While a packing rearranges, the stress on the walls differs from the load by up to 0.07 P0 in MD and 0.02 P0 in CD, since the forces accelerate
the walls, too. CD strains less than MD on every packing.

Loose packings (compacted with the friction of the cycle, as the paper seems to do) have static limits of 1.15 to 1.42 P0, most of them below this
load of 1.2 P0. So with sigma1 held CD rests on only 3 of 10 (|gamma| of 2.1e-6 at most), those whose limits are above 1.27. On the 7 others it
strains by 5.5e-4 to 1.6e-2, among them one that is loaded to 0.991 of its limit. MD strains on all 10, by 8.2e-4 to 1.9e-2. On 5 of these 7 MD
strains further than CD, up to 6.8 times, on 2 CD strains further, 1.33 and 1.47 times. If both yield, it depends on the packing which method strains
further. In CD the stress on the walls differs from the load by up to 0.24 P0 while such a packing yields.

The work of the walls and the sum of stored, kinetic and dissipated energy agree to 1e-7 of the work with sigma1 held and to 9e-5 with the mean stress
held, where MD's packings rearrange; on loose packings to 1.6e-3 (on one packing; 7.9e-4 at most on the others). This error is proportional to the
time step: half and a quarter of it leave 7.4e-4 and 3.5e-4 on the packing with the largest error. On one loose packing 6 of the 4000 steps of CD
missed their tolerance; no other step of CD did.
"""
GIVEN = ("1e-8", "0.2", "1.2", "1.5", "1.27", "4000")
POINTS = (
    (4, "The perturbation that the loading exerts on the system is much weaker in the CD simulation", "section 3, Fig. 4", "agrees",
     "On dense packings with sigma1 held MD strains by 3.2e-4 to 5.0e-4 and CD by less than 1e-7, the error of its solver; where both yield with the "
     "mean stress held MD strains 4.4 to 13.5 times as far (6 packings). On loose packings, whose limits are lower, CD strains, too, on 7 of 10, and "
     "on 2 of them further than MD."),
    (6, "But note also that the energy dissipated is bigger in the MD cycle, and so is the remanent strain at the end of the process.",
     "section 3, Fig. 4", "agrees in part",
     "Both hold on 10 of 10 dense packings, on either stress path, and on 7 of 10 loose ones, which are prepared as the paper seems to do."),
)


def numbers(table):
    largest, kept, lost = "largest |gamma|", "remanent gamma", "dissipated/P0V0"
    finer, table = (table[table.md_dt_factor.isin(FINER) == which] for which in (True, False))
    loose, table = (table[(table["preparation friction"] > 0) == which] for which in (True, False))
    rows = dict(list(table.set_index("seed").groupby(["method", "stress path"])))
    loose_md, loose_cd = (loose[loose.method == method].set_index("seed") for method in style.WORDS)
    stands = loose_cd[largest] < 1e-5
    further, limit = (loose_md[largest] / loose_cd[largest])[~stands], loose_cd["static limit"]
    top = 1 + LOADING["delta_sigma"]
    below = top / limit[~stands & (limit > top)]
    both = [[rows[method, path] for method in style.WORDS] for path in style.STRESS_PATH]
    (md, cd), (md_mean, cd_mean) = both
    ratio, errors = limits.stress_ratio(cd_mean["static limit"], "mean"), table["balance error"].abs().groupby(table["stress path"]).max()
    unbalanced, finer = loose["balance error"].abs().sort_values(), finer.set_index("md_dt_factor")["balance error"].abs()
    rests, moves = cd_mean[ratio > 1.5], cd_mean[ratio < 1.5]
    assert np.allclose(ratio, cd["static limit"], rtol=1e-6) and cd[largest].max() < 1e-7
    assert (rests[largest] < 1e-5).all() and (moves[largest] > 1e-4).all() and not table["unsolved steps"].any()
    assert len(below) == 1 and (loose_cd[largest][~stands] > 1e-4).all() and limit[stands].min() > 1.27
    assert (loose_cd["unsolved steps"] > 0).sum() == 1
    return {"10": [len(md), len(md_mean), len(loose_md), len(loose_cd),
                   *(((one[lost] > other[lost]) & (one[kept].abs() > other[kept].abs())).sum() for one, other in both)],
            **summary.stated("4.3e-4 3.2e-4", md[largest], "median min"), "5.0e-4": [md[largest].max(), moves[largest].min()],
            **summary.stated("3.8e-8 1.5e-8 4.5e-8", cd[largest], "median min max"),
            "1.2e-4": md[kept].abs().median(), "9.9e-6": md[lost].median(), "2.7e-8": cd[kept].abs().median(),
            "7.8e-8": cd[lost].median(), "3.1e-4": md["slip of a contact/R"].median(), "80": md["contacts that slip"].median(),
            **summary.stated("1.41 1.74", ratio), "4": len(rests), "1.6e-6": rests[largest].max(), "1e-7": errors["constant"], "6": len(moves),
            "4.6e-3": moves[largest].max(), **summary.stated("1.7e-3 2.4e-2", md_mean[largest]),
            **summary.stated("4.4 13.5", (md_mean[largest] / cd_mean[largest])[ratio < 1.5]),
            "0.07": md_mean["stress error/P0"].max(), "0.02": cd_mean["stress error/P0"].max(), **summary.stated("1.15 1.42", limit),
            "3": stands.sum(), "2.1e-6": loose_cd[largest][stands].max(), "7": [(~stands).sum(), len(further),
                  ((loose_md[kept].abs() > loose_cd[kept].abs()) & (loose_md[lost] > loose_cd[lost])).sum()],
            **summary.stated("5.5e-4 1.6e-2", loose_cd[largest][~stands]), "0.991": below.iloc[0],
            **summary.stated("8.2e-4 1.9e-2", loose_md[largest]),
            "5": (further > 1).sum(), "6.8": further.max(), "2": (further < 1).sum(), "1.33": 1 / further[further < 1].max(),
            "1.47": 1 / further.min(),
            "0.24": loose_cd["stress error/P0"].max(), "9e-5": errors["mean"], "1.6e-3": unbalanced.iloc[-1],
            "7.9e-4": unbalanced.iloc[-2], **dict(zip(("7.4e-4", "3.5e-4"), finer[list(FINER)]))}
