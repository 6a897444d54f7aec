"""Fig. 3: strain rate per cycle against accumulated strain for MD and CD; which loads packings stand, in a figure of its own."""
import numpy as np
import pandas

from analysis import cycles, limits, observables, publish, style, summary
from analysis.style import plt
from yade_scripts.tables import product

TITLE = "Fig. 3: strain per cycle under repeated loading"
QUESTION = ("Under which loads does a packing shake down, ratchet at a constant rate or collapse, in MD, as in the paper, and in CD, for which the "
            "paper reports no cycles? Do the sliding contacts vanish, return in every cycle or become more from cycle to cycle?")
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
    """Draw the strain rate against the strain of dense packings, a panel a stress path, both methods on the same axes. Which loads packings stand is
    a figure of its own."""
    look = style.shades(run.parameters["delta_sigma"] for run in runs)
    if not (dense := [run for run in runs if run.parameters["preparation_friction"] == 0]):
        return
    paths = dict(reversed(summary.by(dense, "stress path").items()))
    fig, axes = plt.subplots(1, len(paths), figsize=(2 + 4.5 * len(paths), 4), squeeze=False)
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
    style.legend(axes[-1], entries, fontsize=6.5, loc="upper left")
    style.finish(fig, path, "Dense packings, a line each; a cross is a collapse. CD's strain at rest is the error of its solver, and MD's rates "
                 "below about 1e-7 are noise.", dense)
    _draw_stands(pandas.DataFrame(rows), runs, path.with_name(f"{path.stem}-loads.png"))


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


def _draw_stands(table, runs, path):
    """Draw the strain of the first cycle against the load over the static limit, and when a packing collapses, or how many cycles it stands, against
    the load itself. Dense packings have larger symbols."""
    fig, (starts, ends) = plt.subplots(1, 2, figsize=(10, 4))
    table = table.assign(strain=table["first cycle"].abs() if "first cycle" in table else np.nan)
    for (method, friction), own in table.groupby(["method", "preparation friction"]):
        size, shift = (5 if friction == 0 else 2.5), (0.994 if method == "MD" else 1.006)
        own = own.assign(**{"largest ratio": shift * own["largest ratio"]})
        falls, words = own["collapses after"].notna(), f"{method}, {'dense' if friction == 0 else 'loose'}"
        style.points(starts, own, "load over limit", "strain", method, ms=size, label=words)
        style.points(ends, own[falls], "largest ratio", "collapses after", method, ms=size, label=words)
        style.points(ends, own[~falls], "largest ratio", "cycles", method, ms=size, mfc="none")
    starts.axvline(1, color="k", lw=0.7, ls=":")
    starts.set(yscale="log", xlabel=r"largest $\sigma_2/\sigma_1$ over the static limit", ylabel=r"strain $|\Delta\gamma|$ of the first cycle")
    ends.set(yscale="log", xlabel=r"largest $\sigma_2/\sigma_1$", ylabel="cycles")
    starts.legend(fontsize=6.5)
    style.finish(fig, path, "Left: motion begins at the static limit. Right: cycles until collapse, drawn 0.6 % beside the load; open: none within "
                 "that many cycles.", runs)


ANSWER = """
Motion begins near the static limit of a packing. Up to 0.976 of it rigid grains rest in 36 of 36 runs (1.6e-8 at most in the first cycle). From 0.991
of it to the limit 3 of 3 move, by 3.0e-4 to 5.3e-3 in 20 cycles. Above it all 101 move, by 3.7e-4 at least in the first cycle. Springs strain under
every load, without a step at the limit: below it by 1.5e-5 to 6.6e-3 in the first cycle, above it by 5.1e-3 at least (figure of the loads, left). The
paper gives sigma2 only: with sigma1 = P0 its dSigma means sigma2/sigma1 = 1 + dSigma, with the mean stress held (1 + dSigma)/(1 - dSigma). Where both
make 1.5 (dSigma of 0.5 and of 0.2), the strain of MD on dense packings depends little on which stress is held: with the mean stress held it is 0.76
to 1.01 times that with sigma1 held in the first cycle and 0.93 to 1.12 times after 20 cycles (5 packings). On loose packings it is 0.46 to 0.94 times
after 20 cycles.

The stress ratio itself decides on collapse, not its ratio to the static limit, since a packing that moves makes new contacts. With ratios up to 1.5
all 140 runs stand 40 cycles, dense or loose, springs or rigid grains. With 1.6 and 1.7 springs collapse in 6 and rigid grains in 5 of 20 cases, from
1.8 on in 49 and 44 of 50. The static limit at the start does not predict collapse: between 1.1 and 1.3 times this limit springs collapse in 10 of 14
runs of dense packings and in 1 of 18 runs of loose ones. So only with the mean stress held do the paper's loads reach collapse: no dense packing of
MD strains by more than 2.6e-4 at 0.1; at 0.2 all 5 stand and strain by 0.0066 to 0.0431; at 0.3, 0.4 and 0.5 all collapse, after 10.70, 1.95 and 0.95
cycles (medians of 5). With sigma1 held, none of 25 runs collapses at 0.1 to 0.5. The path matters here: at a ratio of 1.86 with the mean stress held
MD stands 0.85 to 2.37 times as many cycles as at 1.8 with sigma1 held, more on 4 of 5 packings.

Above the limit both methods collapse in 49 of 101 pairs, neither in 46 and only springs in 6. Where MD collapses within 20 cycles, CD stands 1.49
times as many cycles (median of 52 pairs from 10 packings; longer in 47, shorter in 1, to the end of the run in 4). Most of these packings collapse
soon: where MD stands more than 3 cycles CD stands 2.52 times as many (17 pairs), else 1.43 times. (To choose by the cycles that MD stands favours CD;
if the geometric mean of both numbers of cycles exceeds 3, the median is 2.18.) The factor depends on the load: its medians for single loads lie
between 1.14 and 3.01. These numbers hold for a period of 0.5 s and steps of 2.5 ms only: with shorter steps rigid grains collapse earlier, and in
slow cycles both methods collapse at once (study of collapse). In 13 runs of rigid grains more than 0.1 % of the steps missed the tolerance. With a
larger one, which hardly any step misses, the same runs stand and collapse; close to the limit the strain differs by up to a factor of two (study of
missed steps).

The loads are those asked for. While a packing collapses, the stress of the walls cannot follow: it is off by 0.33 P0 (median of these runs; 0.78 at
most). In runs above the limit that stand it is off by 0.12 P0 (median; 0.43 at most).

Below the limit CD has strained by 2.7e-8 after 20 cycles and MD by 6.8e-4 (medians of 39 pairs). MD's rate falls in most runs: in 17 of 39 runs it is
below 1e-6 a cycle in the second half of the cycles; in the 22 others the rate of the last quarter of the cycles is 0.74 times that of the quarter
before (median; quartiles 0.61 and 0.99; 1 would be a constant rate; 16 fall). 40 or 80 cycles do not show whether it reaches zero. Cycles of 0.5 s
are short for springs of k_n: in a late cycle of 2 s they strain a third as far (study of ratcheting).
"""
GIVEN = ("2.5", "0.1", "0.2", "0.3", "0.4", "0.5", "1.1", "1.3", "1.5", "1.6", "1.7", "1.8", "1.86", "1", "1e-6", "2", "3", "20", "40", "80")
POINTS = (
    (0, "If the loadings are low enough, the excitations shakedown in the material. [...] there will be practically no accumulation of permanent "
     "strain.",
     "section 3, Fig. 3", "agrees", "At dSigma = 0.1, the mean stress held, MD's rate falls to 4.8e-8 a cycle and less on 5 of 5 dense packings."),
    (1, "This is related to the disappearance of sliding contacts in the sample.", "section 3, Fig. 3", "agrees in part",
     "In these runs at most 20 % of the contacts are at the Coulomb limit at the same time in the first cycle; in the last cycle it is 10 % at most "
     "and 0.6 % at least (medians of 5). But slip does not vanish: in 3 of 3 runs of one dense packing of springs at "
     "rest friction dissipates nearly as much in the last unloading as in the first (study of the continued runs)."),
    (2, "the strain rate does not apparently diminish, leading to a fast failure of the material. This incremental collapse can be seen in cases "
     "dSigma = 0.40 and dSigma = 0.50 of the figure.", "section 3, Fig. 3", "agrees in part",
     "With the mean stress held 10 of 10 dense MD samples collapse at these loads, after 0.90 to 2.65 cycles. But so do 5 of 5 at 0.3, which the "
     "paper does not name, after 10.70 cycles (median), and within two cycles where these take 2 s (study of collapse). With sigma1 held, where the "
     "loads mean a smaller stress ratio, none collapses within 40 cycles. Neither reading makes just the paper's loads collapse."),
    (3, "For loads above the shakedown limit but far from collapse, the material accumulates permanent strain at a constant but very small rate. "
     "This behavior is associated to a quasi-periodic response of the sliding contacts [...].", "section 3, Fig. 3", "agrees in part",
     "Between shakedown and collapse most rates fall. With the mean stress held and dSigma = 0.2 the rate of the last quarter of the cycles is 1.02, "
     "0.33, -0.03, 1.52 and 0.26 times that of the quarter before: constant on one packing, higher on another. With sigma1 held and dSigma = 0.4 it "
     "is 0.71 times (median of 5; 0.12 to 0.78); there the rate of the second half of the cycles is 5.2e-5 a cycle (median). That is for cycles of "
     "0.5 s, which triple the late rates (study of ratcheting). In cycles of 2 s one of three packings strains at a constant rate for 40 cycles, and "
     "then faster (study thousand)."),
    (14, "[...] while CD is much more resistant to collapse.", "section 4", "agrees in part",
     "The sign agrees, \"much\" does not. In cycles of 0.5 s CD stands 1.49 times as many cycles as MD (median of 52 pairs from 10 packings); in 1 "
     "pair it collapses earlier. In slow cycles both collapse in the first or second cycle (study of collapse)."),
    (13, "A different behavior of the plastic response of a system simulated by a MD algorithm and a CD algorithm has been shown.", "section 4",
     "agrees", "Well below the static limit MD strains and CD rests; above it both give way, CD more slowly."),
)


def numbers(table):
    after, end, gamma, quarter = "collapses after", "gamma at the end", f"gamma after {COMPARED}", "last quarter's rate over the one before"
    table = publish.finished(table).assign(ratio=lambda rows: rows["largest ratio"], start=lambda rows: rows["first cycle"].abs())
    md, cd = (table[table.method == method] for method in LINES)
    carried, beyond = ([rows[(rows["load over limit"] < 1) == which].start for rows in (md, cd)] for which in (True, False))
    dense = md[md["preparation friction"] == 0].set_index("seed")
    held, constant = (dense[dense["stress path"] == path] for path in LOADS)
    at, low = dict(list(held.groupby("dSigma"))), constant[constant.dSigma <= 0.5]
    loose = md[(md["preparation friction"] > 0) & ((md["largest ratio"] - 1.5).abs() < 1e-9)].set_index(["stress path", "seed"])
    same, paths = constant[constant.dSigma == 0.5], [loose.loc[path, gamma] for path in LOADS]
    start, alike, loosely = at[0.2]["first cycle"] / same["first cycle"], at[0.2][gamma] / same[gamma], paths[0] / paths[1]
    gentle, severe = table[table.ratio < 1.51], [rows[rows.ratio > 1.79][after].notna() for rows in (md, cd)]
    close = md[md["load over limit"].between(1.1, 1.3)].groupby("preparation friction")[after]
    pairs = md.merge(cd, on=["stress path", "preparation friction", "dSigma", "seed"], suffixes=(" MD", " CD"))
    below, above = pairs[pairs["load over limit MD"] < 1], pairs[pairs["load over limit MD"] > 1]
    falls = [above[f"{after} {method}"].notna() for method in LINES]
    breaks = pairs[pairs[f"{after} MD"] <= COMPARED]
    times, long = (breaks[f"{after} CD"] / breaks[f"{after} MD"]).fillna(np.inf), breaks[f"{after} MD"] > 3  # infinite where CD stands
    by_load = times.groupby([breaks["stress path"], breaks.dSigma]).median()[lambda rows: np.isfinite(rows)]
    errors, falling = table["stress error/P0"], table[after].notna()
    standing = ~falling & (table["load over limit"] > 1)
    quiet = md[md[after].isna() & (md["load over limit"] < 1)]
    slows = quiet[quiet["late rate"].abs() > 1e-6][quarter]
    detour = at[0.3][after] / constant[constant.dSigma == 0.8][after]
    fails, slow = held[held.dSigma.isin((0.4, 0.5))][after], constant[constant.dSigma == 0.4]
    packings = lambda rows: len(rows[["preparation friction", "seed"]].drop_duplicates())
    steps = cd[after].fillna(cd.cycles) * LOADING["period"] / RIGID["cd_dt"]
    many = (cd["unsolved steps"] > 1e-3 * steps).sum()
    assert gentle[after].isna().all()
    assert low[after].isna().all() and at[0.2][after].isna().all() and not (falls[1] & ~falls[0]).any()
    assert all(at[load][after].notna().all() for load in (0.3, 0.4, 0.5)) and len(alike) == len(loosely) == 5
    within = [table[table.ratio.between(1.55, 1.75) & (table.method == method)][after].notna() for method in LINES]
    rests, moves = (cd[cd["load over limit"].between(*ends)] for ends in ((0, 0.98), (0.98, 1)))
    return {"0.976": rests["load over limit"].max(), "36": [len(rests), (rests[gamma].abs() < 1e-6).sum()], "1.6e-8": rests.start.max(),
            "0.991": moves["load over limit"].min(), "3": [len(moves), (moves[gamma].abs() > 1e-4).sum()],
            **summary.stated("3.0e-4 5.3e-3", moves[gamma].abs()), "101": [len(beyond[1]), len(above)], "3.7e-4": beyond[1].min(),
            **summary.stated("1.5e-5 6.6e-3", carried[0]), "5.1e-3": beyond[0].min(),
            **summary.stated("0.76 1.01", start), **summary.stated("0.93 1.12", alike),
            "5": [len(alike), len(at[0.1]), len(at[0.2]), len(detour), within[1].sum()], **summary.stated("0.46 0.94", loosely), "140": len(gentle),
            "6": [within[0].sum(), (falls[0] & ~falls[1]).sum()], "49": [severe[0].sum(), (falls[0] & falls[1]).sum()], "44": severe[1].sum(),
            "50": [len(severe[0]), len(severe[1])],
            "10": [close.count()[0.0], packings(breaks), fails.notna().sum(), 100 * at[0.1]["sliding at most, last cycle"].median()],
            "14": close.size()[0.0], "18": close.size()[0.1],
            "2.6e-4": at[0.1][end].abs().max(), **summary.stated("0.0066 0.0431", at[0.2][end].abs()),
            "10.70": at[0.3][after].median(), "1.95": at[0.4][after].median(), "0.95": at[0.5][after].median(), "25": len(low),
            **summary.stated("0.85 2.37", detour), "4": [(detour > 1).sum(), np.isinf(times).sum()], "46": (~falls[0]).sum(),
            "1.49": times.median(), "52": len(breaks), "47": (times.between(1, np.inf, "neither")).sum(), "2.52": times[long].median(),
            "17": [long.sum(), len(quiet) - len(slows)], "1.43": times[~long].median(),
            "2.18": times[np.sqrt(times.clip(upper=1e9)) * breaks[f"{after} MD"] > 3].median(),
            "1.14": by_load.min(), "3.01": by_load.max(), "13": many, "0.33": errors[falling].median(), "0.78": errors[falling].max(),
            "0.12": errors[standing].median(), "0.43": errors[standing].max(),
            "2.7e-8": below[f"{gamma} CD"].abs().median(), "6.8e-4": below[f"{gamma} MD"].abs().median(), "39": [len(below), len(quiet)],
            "22": len(slows), "0.74": slows.median(), "0.61": slows.quantile(0.25), "0.99": slows.quantile(0.75), "16": (slows < 1).sum(),
            "4.8e-8": at[0.1]["late rate"].abs().max(),
            "0.6": 100 * at[0.1]["sliding at least, last cycle"].median(), "0.90": fails.min(), "2.65": fails.max(),
            **dict(zip(("1.02", "0.33", "-0.03", "1.52", "0.26"), at[0.2][quarter].sort_index())),
            "0.71": slow[quarter].median(), **summary.stated("0.12 0.78", slow[quarter]), "5.2e-5": slow["late rate"].abs().median()}
