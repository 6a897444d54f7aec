"""Fig. 3: strain a cycle of MD and CD under repeated loading, and which loads packings stand."""
import numpy as np
import pandas

from analysis import cycles, limits, observables, style, summary
from analysis.style import plt
from yade_scripts.tables import product

TITLE = "Under which loads do packings move, and when do they collapse?"
QUESTION = "Fig. 3 of the paper for MD and CD, dense and loose packings, on both stress paths that the paper's text allows."
ORDER = 2  # in the report
# At dSigma = 0.4 a period of 0.5 s makes MD strain 1.1 to 1.8 times as far as one of 2 s in ten cycles; a step of 0.3 sqrt(m/k_n) moves
# it by less than 1 % (study influence). Dense packings are prepared without friction, loose ones with the paper's own mu = 0.1
# throughout. Walls of both methods are pushed by forces; they are light, so that their inertia does not pass for a collapse. The paper
# gives sigma2 only: sigma1 = P0, as in its eq. 1, or the mean stress P0 are both read from it.
LOADING = dict(loading="cosine", period=0.5, records_per_cycle=20, wall_mass_ratio=1.0)
SPRINGS = dict(method="MD", md_dt_factor=0.3, md_walls="force", **LOADING)
RIGID = dict(method="CD", cd_dt=2.5e-3, tolerance=1e-8, **LOADING)
LOADS = {"mean": (0.1, 0.2, 0.3, 0.4, 0.5), "constant": (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 1.2)}
SEEDS = range(1, 6)
# Cycles after which runs of both methods are compared: as many as the shorter ones have.
COMPARED = 20


def _paths(loads=LOADS, **settings):
    return [row for path, several in loads.items() for row in product(stress_path=path, delta_sigma=several, **settings)]


ROWS = {"quick": [row for setting in (SPRINGS, RIGID | {"tolerance": 1e-7, "max_iterations": 2000})
                  for row in _paths({"mean": (0.1, 0.4), "constant": (0.4,)}, cycles=COMPARED, seed=1, **setting)],
        # Of the dense packings the first is continued to twice its length.
        "full": [row for setting in (SPRINGS, RIGID) for row in _paths(cycles=80, seed=1, **setting) + _paths(cycles=40, seed=SEEDS[1:], **setting)]
        + [row for setting in (SPRINGS, RIGID) for row in _paths(cycles=40, seed=SEEDS, preparation_friction=0.1, **setting)]}


def summarize(runs):
    """Return one row a run: when it collapses, how it strains, what slides, dissipates and touches. Of MD first, then by the preparation."""
    return [_row(run) for run in summary.order(runs, "method", "preparation friction", "period", "stress path", "dSigma", "seed")]


def _row(run):
    found = cycles.of(run)
    compared, window = len(found.number) >= COMPARED, (COMPARED // 2 + 1, COMPARED)
    row = summary.columns(run, "method", "stress path", "preparation friction", "dSigma", "seed", "static limit", "load over limit", "cycles",
                          "collapses after", "gamma at the end")
    row["largest ratio"] = limits.stress_ratio(1 + run.parameters["delta_sigma"], run.parameters["stress_path"])  # sigma2/sigma1
    row[f"gamma after {COMPARED}"] = found.permanent[COMPARED - 1] if compared else np.nan
    row |= summary.columns(run, "late rate", "last quarter's rate over the one before")
    row["rate of cycles {} to {}".format(*window)] = found.rates([window])[0] if compared else np.nan
    row |= summary.columns(run, "unsolved steps")
    if len(found.number):
        share, ends = cycles.sliding_share(run), cycles.ends(run)
        last, before = (share[first:end + 1] for first, end in ((ends[-2], ends[-1]), (ends[max(0, len(ends) - 3)], ends[-2])))
        alike = len(ends) > 2 and len(last) == len(before) and last.mean()
        row |= {"first cycle": found.first, "sliding at most, first cycle": found.sliding_max[0],
                "sliding at most, last cycle": found.sliding_max[-1], "sliding at least, last cycle": last.min(),
                "sliding, change of a cycle": np.sqrt(np.mean((last - before)**2)) / last.mean() if alike else np.nan,  # rms over the mean
                "dissipated/P0V0, first cycle": found.dissipated[0], "dissipated/P0V0, last cycle": found.dissipated[-1],
                "2M/N at the end": found.contacts[-1]}
    return row | {"coordination at the end": observables.coordination(run.snapshots[-1])} | summary.columns(
        run, "balance error", "stress error/P0", "outcome")


def draw(runs, rows, path):
    """Draw the paper's figure for one packing, the strain of the first cycle against the load over the static limit, and when packings collapse."""
    fig, (rates, starts, ends) = plt.subplots(1, 3, figsize=(13, 4.3))
    mean = [run for run in runs if run.parameters["preparation_friction"] == 0 and run.parameters["stress_path"] == "mean"]
    _draw_rates(rates, [run for run in mean if run.parameters["seed"] == mean[0].parameters["seed"]])
    table = pandas.DataFrame(rows, columns=["method", "preparation friction", "load over limit", "first cycle", "largest ratio", "cycles",
                                            "collapses after"])
    for (method, friction), own in table.groupby(["method", "preparation friction"]):
        size, shift = (5, 0.012) if friction == 0 else (2.5, 0.004)
        own = own.assign(strain=own["first cycle"].abs(), ratio=own["largest ratio"] * (1 + shift * (-1 if method == "MD" else 1)))
        falls, words = own["collapses after"].notna(), f"{method}, {'dense' if friction == 0 else 'loose'}"
        style.points(starts, own, "load over limit", "strain", method, ms=size, label=words)
        style.points(ends, own[falls], "ratio", "collapses after", method, ms=size)
        style.points(ends, own[~falls], "ratio", "cycles", method, ms=size, marker="^", mfc="none")
    starts.axvline(1, color="k", lw=0.7, ls=":")
    starts.set(yscale="log", xlabel=r"largest $\sigma_2/\sigma_1$ over the static limit", ylabel=r"strain $|\Delta\gamma|$",
               title="first cycle, all packings")
    ends.set(yscale="log", xlabel=r"largest $\sigma_2/\sigma_1$", ylabel="cycles", title="cycles until collapse")
    starts.legend(loc="lower right")
    style.finish(fig, path, "Left: rigid grains at rest are not drawn; a cross is a collapse. Middle: far below the limit rigid grains show the "
                 "error of "
                 "their solver only. Right: a triangle is a run that still stands; points stand beside their load, so that all can be seen.", runs)


LINES = {"MD": "-", "CD": "--"}


def _draw_rates(axis, runs):
    """Draw strain a cycle against strain of one packing, over windows that grow with the number of the cycle; a cross where it collapses."""
    look = style.shades(run.parameters["delta_sigma"] for run in runs)
    for run in summary.order(runs, "method", "dSigma"):
        found, colour = cycles.of(run), look[run.parameters["delta_sigma"]]
        if run.method == "CD" and np.abs(run.values("gamma")).max() < 1e-5:
            continue
        if run.collapsed:
            end, before = run.values("gamma")[-1], found.permanent[-1] if len(found.number) else 0
            axis.plot(abs(end), abs(end - before), "x", color=colour, markersize=6)
        windows = cycles.windows(len(found.number))
        axis.plot(np.abs([found.gamma[last] for _, last in windows]), np.abs(found.rates(windows)), color=colour, linestyle=LINES[run.method],
                  marker=style.MARKER[run.method], markersize=3)
    axis.set(xscale="log", yscale="log", xlabel=r"accumulated strain $|\gamma|$", ylabel=r"strain a cycle $|\Delta\gamma|$",
             title=f"one packing, {style.STRESS_PATH['mean']}")
    entries = [dict(color=colour, label=rf"$\Delta\sigma$ = {load:g}") for load, colour in look.items()]
    entries += [dict(color=style.GREY["44"], ls=line, marker=style.MARKER[method], ms=4, label=method) for method, line in LINES.items()
                if any(run.method == method for run in runs)]
    style.legend(axis, entries, loc="lower right", fontsize=7)


POINTS = (
    (3, "If the loadings are low enough, the excitations shakedown in the material. [...] there will be practically no accumulation of "
     "permanent strain.", "section 3", "agrees in part"),
    (4, "This is related to the disappearance of sliding contacts in the sample.", "section 3", "disagrees"),
    (5, "for very high loadings, the strain rate does not apparently diminish, leading to a fast failure of the material. This incremental "
     "collapse can be seen in cases dSigma = 0.40 and dSigma = 0.50 of the figure.",
     "section 3", "agrees in part"),
    (6, "For loads above the shakedown limit but far from collapse, the material accumulates permanent strain at a constant but very small "
     "rate.", "section 3", "agrees in part"),
    (17, "The response of the material is more apparent in the MD simulation", "section 4", "agrees in part"),
    (22, "Three ranges of response can be differentiated in the figure.", "section 3", "agrees in part"),
    (25, "MD results have been compared with experimental triaxial tests data and a good correlation has been found", "section 4", "not decided"),
)


def quantities(table):
    after, gamma, load, quarter = "collapses after", f"gamma after {COMPARED}", "load over limit", "last quarter's rate over the one before"
    case = ["stress path", "preparation friction", "dSigma", "seed"]
    table = table.assign(ratio=table["largest ratio"], start=table["first cycle"].abs(), falls=table[after].notna())
    md, cd = (table[table.method == method] for method in LINES)
    rests, moves = (cd[cd[load].between(*both)] for both in ((0, 0.98), (0.98, 1)))
    dense = md[md["preparation friction"] == 0].set_index("seed")
    held, constant = (dense[dense["stress path"] == path] for path in LOADS)
    at, low = dict(list(held.groupby("dSigma"))), constant[constant.dSigma <= 0.5]
    pairs = md.merge(cd, on=case, suffixes=(" MD", " CD"))
    frail = pairs[(pairs["stress path"] == "mean") & (pairs["preparation friction"] > 0) & (pairs.dSigma == 0.3)].set_index("seed")
    loose_lives = (frail[f"{after} CD"] / frail[f"{after} MD"]).dropna()  # of the packings that collapse by both methods
    loosest = md[(md["preparation friction"] > 0) & (md.dSigma == 0.1) & (md[load] < 1)]
    same = constant[constant.dSigma == 0.5]  # sigma2/sigma1 goes to 1.5, as in at[0.2]
    start = at[0.2]["first cycle"] / same["first cycle"]
    gentle = table[table.ratio < 1.51]
    within, severe = ({name: rows[rows.ratio.between(*both)].falls for name, rows in (("md", md), ("cd", cd))} for both in ((1.55, 1.75), (1.79, 9)))
    below, above = pairs[pairs["load over limit MD"] < 1], pairs[pairs["load over limit MD"] > 1]
    most = "sliding at most, {} cycle".format
    first_load = dense[dense.dSigma == 0.1]
    fewer = first_load[most("last")] / first_load[most("first")]
    slow, severest = (constant[constant.dSigma == several] for several in (0.4, 0.8))
    detour = at[0.3][after] / severest[after]
    assert not gentle.falls.any() and not low.falls.any() and not at[0.2].falls.any() and not (above["falls CD"] & ~above["falls MD"]).any()
    assert all(at[several].falls.all() for several in (0.3, 0.4, 0.5))
    return locals()
