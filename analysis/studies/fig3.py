"""Fig. 3: strain rate per cycle against accumulated strain for MD and CD, with sliding contacts, dissipation and contacts in an appendix."""
import numpy as np
import pandas

from analysis import cycles, observables, publish, style, summary
from analysis.style import plt
from yade_scripts.tables import product

TITLE = "Fig. 3: strain per cycle under repeated loading"
QUESTION = ("Which loads shake down, which ratchet at a constant rate and which collapse, in MD as the paper reports and in CD, of which the paper "
            "reports no cycles; and do the sliding contacts vanish, return in every cycle or grow with it?")
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
    """Draw the strain rate against the strain of dense packings, a panel a stress path, both methods on the same axes; beside them, when packings
    collapse. What slides, dissipates and touches is a figure of its own."""
    look = style.shades(run.parameters["delta_sigma"] for run in runs)
    dense = [run for run in runs if run.parameters["preparation_friction"] == 0]
    paths = dict(reversed(summary.by(dense, "stress path").items()))
    fig, axes = plt.subplots(1, len(paths) + 1, figsize=(2 + 3.5 * (len(paths) + 1), 4), squeeze=False)
    axes = axes[0]
    for axis, (stress_path, own) in zip(axes, paths.items()):
        if axis is not axes[0]:
            axis.sharex(axes[0])
            axis.sharey(axes[0])
        for run in summary.order(own, "method", "dSigma"):
            _rates(axis, run, look[run.parameters["delta_sigma"]])
        axis.set(xscale="log", yscale="log", xlabel=r"accumulated strain $|\gamma|$", title=style.STRESS_PATH[stress_path])
        axis.grid(True)
    axes[0].set_ylabel(r"strain rate $|\Delta\gamma|$ a cycle")
    entries = [dict(color=colour, label=rf"$\Delta\sigma$ = {load:g}") for load, colour in look.items()]
    entries += [dict(color="#444444", ls=line, marker=style.MARKER[method], ms=4, label=method)
                for method, line in LINES.items() if any(run.method == method for run in dense)]
    style.legend(axes[max(0, len(paths) - 1)], entries, fontsize=6.5, loc="upper left")
    _collapses(axes[-1], pandas.DataFrame(rows))
    style.finish(fig, path, "Left: dense packings, a line each; a cross is a collapse. CD's strain at rest is the error of its solver. "
                 "Right: all packings; open: no collapse in so many cycles.", runs)
    held = [run for run in runs if run.parameters["stress_path"] == "mean"]
    _draw_each_cycle(held or runs, look, path.with_name(f"{path.stem}-cycles.png"))


LINES = {"MD": "-", "CD": "--"}


def _rates(axis, run, colour):
    """Draw strain and rate of a packing, over windows that grow with the number of the cycle; a cross where it collapses."""
    found = cycles.of(run)
    if run.collapsed:
        end, before = run.values("gamma")[-1], found.permanent[-1] if len(found.number) else 0
        axis.plot(abs(end), abs(end - before), "x", color=colour, markersize=5)
    windows = cycles.windows(len(found.number))
    axis.plot(np.abs([found.gamma[last] for _, last in windows]), np.abs(found.rates(windows)), color=colour, linestyle=LINES[run.method],
              marker=style.MARKER[run.method], markersize=2, linewidth=0.7, alpha=0.8)


def _collapses(axis, table):
    """Draw the cycle in which a packing collapses, or as many as it stands, against the load over its static limit."""
    for method in LINES:
        own = table[table.method == method]
        falls = own["collapses after"].notna()
        style.points(axis, own[falls], "load over limit", "collapses after", method, label=f"{method}: collapses")
        style.points(axis, own[~falls], "load over limit", "cycles", method, mfc="none", label=f"{method}: stands")
    axis.axvline(1, color="k", lw=0.7, ls=":")
    axis.set(yscale="log", xlabel=r"largest $\sigma_2/\sigma_1$ over its static limit", ylabel="cycles", title="collapse")
    axis.legend(fontsize=6.5)


def _draw_each_cycle(runs, look, path):
    """Draw cycle by cycle the most sliding contacts, the energy dissipated, and the contacts; a column a method and preparation."""
    columns = summary.by(runs, "method", "preparation friction")
    fig, axes = plt.subplots(3, len(columns), figsize=(1 + 2.6 * len(columns), 7.5), squeeze=False, sharex=True, sharey="row")
    for line, (method, friction), own in zip(axes.T, columns, columns.values()):
        line[0].set_title(f"{method}, prepared with $\\mu$ = {friction:g}", fontsize=9)
        for load, same in summary.by(own, "dSigma").items():
            several = [found for run in same if len((found := cycles.of(run)).number)]
            count = min((len(found.number) for found in several), default=0)
            for axis, name in zip(line, ("sliding_max", "dissipated", "contacts")):
                if count:
                    median = np.median([getattr(found, name)[:count] for found in several], axis=0)
                    axis.plot(range(1, count + 1), np.where((median > 0) | (name != "dissipated"), median, np.nan), color=look[load],
                              marker=".", ms=3, label=rf"$\Delta\sigma$ = {load:g}")
        for axis in line:
            axis.set_xscale("log")
            axis.grid(True)
        line[1].set_yscale("log")
        line[2].set_xlabel("cycle")
    for axis, label in zip(axes[:, 0], ("most contacts at the Coulomb\nlimit / contacts", "dissipated in a cycle\n/ $P_0V_0$", "contacts $2M/N$")):
        axis.set_ylabel(label)
    axes[0, -1].legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    style.finish(fig, path, "Median over the packings.", runs)


ANSWER = """
Whether a packing rests or yields depends on the largest stress ratio sigma2/sigma1 of a cycle, whichever stress is held. The paper gives sigma2 only:
with sigma1 = P0 its dSigma is a ratio of 1 + dSigma, with the mean stress held a ratio of (1 + dSigma)/(1 - dSigma). Where both make a ratio of 1.5
(dSigma of 0.5 and of 0.2), the strain of MD after 20 cycles differs by 1 to 12 % between them, on each of 5 packings. What happens above the limit
depends on the path, too: at a ratio of 1.86 with the mean stress held MD stands 0.85 to 2.37 times as many cycles as at 1.8 with sigma1 held, more on
4 of 5 packings. Only with the mean stress held do the paper's loads reach collapse: no dense packing of MD strains by more than 2.6e-4 at 0.1; at 0.2
all 5 stand 40 cycles and strain by 0.0066 to 0.0431; at 0.3, 0.4 and 0.5 all collapse, after 10.70, 1.95 and 0.95 cycles (medians of 5). With sigma1
held, none of 25 runs collapses at 0.1 to 0.5, and 10 of 10 do at 0.8 and 1.2.

What matters is this ratio over the static limit of the packing. Dense packings of MD stand at 1.06 of it and collapse from 1.12, loose ones collapse
from 1.33, but one stands at 1.53, in CD as well. Below the limit rigid grains rest: after 20 cycles CD has strained by 2.3e-8 and MD by 3.3e-4
(medians of 30 pairs from 6 packings); the largest strain of CD is 3.0e-4, at 0.991 of the limit. Above it MD collapses in 39 and CD in 35 of 55
pairs, CD never where MD stands. Where MD collapses within 20 cycles, CD stands 1.46 times as many (median of 38 pairs from 10 packings; longer in 34,
shorter in 1, to the end of its cycles in 3), the more the nearer the limit: 2.8 times between 1.1 and 1.3 of it (9 pairs), 1.24 times above 2 (10
pairs). How many cycles that are belongs to the period of 0.5 s: see the study of collapse. A little above the limit, up to 1.07 of it, all 6 runs of
CD on dense packings stand (3 packings) and come to rest: in cycles 11 to 20 they strain by 3.3e-5 a cycle at most, in cycles 31 to 40 by 1.8e-6.

Below the limit MD's rate falls more often than not: over the last quarter of the cycles it is 0.73 times that of the quarter before (median of the 21
runs with more than 1e-6 a cycle; quartiles 0.59 and 0.90; 1 would be a constant rate; 16 fall). 40 or 80 cycles do not show whether it reaches zero.
Cycles of 0.5 s are short for springs of k_n: in slower ones they strain less, see the study of ratcheting.
"""
GIVEN = ("0.1", "0.2", "0.3", "0.4", "0.5", "0.8", "1.07", "1.1", "1.2", "1.3", "1.5", "1.8", "1.86", "1", "1e-6", "2", "11", "20", "31", "40", "80")
POINTS = (
    (0, "If the loadings are low enough, the excitations shakedown in the material. [...] there will be practically no accumulation of permanent "
     "strain.",
     "section 3, Fig. 3", "agrees", "At dSigma = 0.1, the mean stress held, MD's rate falls to 4.8e-8 a cycle and less on 5 of 5 dense packings."),
    (1, "This is related to the disappearance of sliding contacts in the sample.", "section 3, Fig. 3", "agrees in part",
     "In these runs up to 20 % of the contacts are at the Coulomb limit at one time of the first cycle, up to 10 % of the last one, and there at "
     "least 0.6 % (medians of 5). How many of them slip was not measured."),
    (2, "the strain rate does not apparently diminish, leading to a fast failure of the material. This incremental collapse can be seen in cases "
     "dSigma = 0.40 and dSigma = 0.50 of the figure.", "section 3, Fig. 3", "agrees in part",
     "With the mean stress held 10 of 10 dense MD samples collapse at these loads, after 0.90 to 2.65 cycles; with sigma1 held, where they mean a "
     "smaller stress ratio, none does."),
    (3, "For loads above the shakedown limit but far from collapse, the material accumulates permanent strain at a constant but very small rate. "
     "This behavior is associated to a quasi-periodic response of the sliding contacts [...].", "section 3, Fig. 3", "agrees in part",
     "Rates between settling and collapse fall slowly rather than stay: with sigma1 held and dSigma = 0.4 the rate of the second half of the cycles "
     "is 5.2e-5 a cycle (median of 5), and over the last quarter 0.71 times that of the quarter before (0.12 to 0.78)."),
    (12, "[...] while CD is much more resistant to collapse.", "section 4", "agrees in part",
     "Under cycles CD stands 1.46 times as many (median of 38 pairs from 10 packings); in 1 of them it collapses earlier."),
    (13, "A different behavior of the plastic response of a system simulated by a MD algorithm and a CD algorithm has been shown.", "section 4",
     "agrees", "Below the static limit MD strains and CD rests; above it both give way, CD more slowly."),
)


def numbers(table):
    after, end, gamma, quarter = "collapses after", "gamma at the end", f"gamma after {COMPARED}", "last quarter's rate over the one before"
    table = publish.finished(table)
    md, cd = (table[table.method == method] for method in LINES)
    dense = md[md["preparation friction"] == 0].set_index("seed")
    held, constant = (dense[dense["stress path"] == path] for path in LOADS)
    at, low, high = dict(list(held.groupby("dSigma"))), constant[constant.dSigma <= 0.5], constant[constant.dSigma > 0.5]
    alike = (at[0.2][gamma] / constant[constant.dSigma == 0.5][gamma] - 1).abs()
    pairs = md.merge(cd, on=["stress path", "preparation friction", "dSigma", "seed"],
                                                  suffixes=(" MD", " CD"))
    below, above = pairs[pairs["load over limit MD"] < 1], pairs[pairs["load over limit MD"] > 1]
    falls = [above[f"{after} {method}"].notna() for method in LINES]
    breaks = pairs[pairs[f"{after} MD"] <= COMPARED]
    times, over = (breaks[f"{after} CD"] / breaks[f"{after} MD"]).fillna(np.inf), breaks["load over limit MD"]  # infinite where CD stands
    load = table.assign(falls=table[after].notna()).groupby(["falls", "method", "preparation friction"])["load over limit"]
    stands, falls_from = load.max()[False], load.min()[True]
    slows = md[md[after].isna() & (md["load over limit"] < 1) & (md["late rate"].abs() > 1e-6)][quarter]
    closer, further = times[over.between(1.1, 1.3)], times[over > 2]
    detour = at[0.3][after] / constant[constant.dSigma == 0.8][after]
    fails, slow = held[held.dSigma.isin((0.4, 0.5))][after], constant[constant.dSigma == 0.4]
    near = cd[(cd["preparation friction"] == 0) & cd["load over limit"].between(1, 1.07)]
    later = near[f"rate of cycles {COMPARED // 2 + 1} to {COMPARED}"].abs()
    rest = near["late rate"].abs() * 2 * near[quarter] / (1 + near[quarter])  # the rate of the last quarter: late rate is the mean of the last two
    packings = lambda rows: len(rows[["preparation friction", "seed"]].drop_duplicates())
    assert near[after].isna().all() and (near.cycles == 40).all()
    assert low[after].isna().all() and at[0.2][after].isna().all() and not (falls[1] & ~falls[0]).any()
    assert all(at[load][after].notna().all() for load in (0.3, 0.4, 0.5)) and alike.between(0.01, 0.13).all()
    return {"1": (times < 1).sum(), "12": 100 * alike.max(), "5": [len(alike), len(at[0.1]), len(at[0.2]), len(detour)],
            **summary.stated("0.85 2.37", detour), "4": (detour > 1).sum(), "2.6e-4": at[0.1][end].abs().max(),
            **summary.stated("0.0066 0.0431", at[0.2][end].abs()),
            "10.70": at[0.3][after].median(), "1.95": at[0.4][after].median(), "0.95": at[0.5][after].median(), "25": len(low),
            "10": [high[after].notna().sum(), len(high), fails.notna().sum(), packings(breaks), len(further),
                   100 * at[0.1]["sliding at most, last cycle"].median()],
            "1.06": stands["MD", 0.0], "1.12": falls_from["MD", 0.0], "1.33": falls_from["MD", 0.1], "1.53": [stands["MD", 0.1], stands["CD"].max()],
            "2.3e-8": below[f"{gamma} CD"].abs().median(), "3.3e-4": below[f"{gamma} MD"].abs().median(),
            "30": len(below), "6": [packings(below), len(near)], "3.0e-4": below[f"{gamma} CD"].abs().max(),
            "0.991": below.loc[below[f"{gamma} CD"].abs().idxmax(), "load over limit CD"], "39": falls[0].sum(), "35": falls[1].sum(),
            "55": len(above), "1.46": times.median(), "38": len(breaks), "34": (times.between(1, np.inf, "neither")).sum(),
            "3": [np.isinf(times).sum(), near.seed.nunique()], "2.8": closer.median(), "9": len(closer), "1.24": further.median(),
            "3.3e-5": later.max(), "1.8e-6": rest.max(), "0.73": slows.median(), "21": len(slows), "0.59": slows.quantile(0.25),
            "0.90": [slows.quantile(0.75), fails.min()], "16": (slows < 1).sum(), "4.8e-8": at[0.1]["late rate"].abs().max(),
            "0.6": 100 * at[0.1]["sliding at least, last cycle"].median(), "2.65": fails.max(),
            "5.2e-5": slow["late rate"].abs().median(), "0.71": slow[quarter].median(), **summary.stated("0.12 0.78", slow[quarter])}
