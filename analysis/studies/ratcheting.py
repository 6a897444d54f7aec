"""Strain a cycle against the load over the static limit, for springs of three stiffnesses and for rigid contacts on the same packings."""
import numpy as np
import pandas
from scipy import stats

from analysis import cycles, limits, observables, style, summary
from analysis.studies import fig3
from analysis.style import plt
from yade_scripts.tables import product

TITLE = "Ratcheting: stiffness of the springs, or rearrangement?"
QUESTION = ("Does the strain that remains after every cycle vanish as springs get stiffer, as rigid contacts say, or does it belong to "
            "the packing? Below its static limit a packing strains by the deformation of its contacts (type I of Combe and Roux, "
            "arXiv:0901.3842, which goes as 1/k_n) or by their rearrangement (type II, which does not). Their work is on a rising load; "
            "this study asks the same of the strain that remains after a cycle.")
ORDER = 2.5  # in the report
# sigma1 = P0; under LOAD sigma2/sigma1 rises to 1.4, which is 0.80 to 1.04 of the static limits of these packings.
SPRINGS, RIGID = fig3.SPRINGS, fig3.RIGID | dict(tolerance=1e-9)
# Soft springs answer more slowly: with 0.5 s they lag behind the load. Of 1 and 10 k_n the periods go as 1/sqrt(k_n).
PERIODS = {1: 2.0, 10: 0.63, 100: 0.5}
STIFFER, LOAD, SEEDS = (1, 10, 100), 0.4, range(1, 11)
LOWER = 0.3  # 0.75 to 0.96 of the limits
NEAR = 0.96    # of the limit
SOLVED, LOOSER = 1e-7, 1e-6  # tolerances for comparison
FIRST_PEAK, LAST_PEAK = 1, 2  # snapshots of runs of several cycles; 0 is the start
ROWS = {"quick": [SPRINGS | dict(stiffening=stiffer, period=PERIODS[stiffer], delta_sigma=LOAD, cycles=4) for stiffer in STIFFER[:2]]
        + product(delta_sigma=LOAD, cycles=4, **RIGID),
        "full": [row for settings in (
            *(SPRINGS | dict(period=period, stiffening=stiffer) for stiffer, period in PERIODS.items()),
            SPRINGS | dict(stiffening=STIFFER[:2]), SPRINGS | dict(stiffening=10, period=PERIODS[1]),  # in haste and slower, for comparison
            RIGID | dict(stiffening=STIFFER), RIGID | dict(tolerance=LOOSER),
            RIGID | dict(stiffening=STIFFER, tolerance=SOLVED))  # packings that yield cannot be solved to 1e-9 in every step
                 for row in product(**settings, delta_sigma=LOAD, cycles=20, seed=SEEDS)]
        + [row for stiffness, period in PERIODS.items()
           for row in product(**SPRINGS | dict(period=period, stiffening=stiffness), delta_sigma=LOWER, cycles=20, seed=SEEDS)]}


@summary.each
def summarize(run):
    """Return the row of a run: the first cycle's strain, the rate of the last half of the cycles, and how many contacts change.

    rate: mean strain a cycle of the last half, positive where the sample goes on shortening along the loaded axis; rate error: its standard error,
    from the scatter of these cycles. changed: contacts that carry at the first or the last peak of the load, not at both, over those at the first.
    limit at the last load: the static limit by the contacts at the last peak, of rigid grains.
    """
    found, rigid = cycles.of(run), run.method == "CD"
    return {**summary.columns(run, "method", "period", "k_n over the usual"), "tolerance": run.parameters["tolerance"] if rigid else np.nan,
            **summary.columns(run, "dSigma", "seed", "static limit", "load over limit"),
            "first cycle": abs(found.first), "rate": -found.late_rate, "rate error": cycles.error_of_mean(found.rate[-(len(found.rate) // 2):]),
            **summary.columns(run, "gamma at the end", "last quarter's rate over the one before"),
            "contacts changed": changed(*run.snapshots[FIRST_PEAK:LAST_PEAK + 1]) if len(run.snapshots) > LAST_PEAK else np.nan,
            "limit at the last load": limits.static_limit(run, LAST_PEAK) if rigid and len(run.snapshots) > LAST_PEAK else np.nan,
            **summary.columns(run, "unsolved steps", "balance error", "outcome")}


def changed(first, last):
    """Return how many contacts carry a force in one of two snapshots and not in the other, over those that do in the first."""
    before, after = observables.matched_forces(first, last) > 0
    return float((before != after).sum() / before.sum())


def draw(runs, rows, path):
    """Draw the strain of the first and of a late cycle against the load over the limit, and the latter against the contacts that change."""
    fig, axes = plt.subplots(1, 3, figsize=(12, 4.2), sharey=True)
    x = "load over limit"
    panels = ((x, "first cycle", r"largest $\sigma_2/\sigma_1$ over its static limit", "first cycle"),
              (x, "rate", r"largest $\sigma_2/\sigma_1$ over its static limit", "a cycle of the last half"),
              ("contacts changed", "rate", "share of contacts changed, first to last peak", "a cycle of the last half, springs"))
    table = pandas.DataFrame(rows).assign(rate=lambda rows: rows["rate"].abs())
    rigid, quiet = table[table.tolerance == RIGID["tolerance"]], slow(table)
    shades = dict(zip(STIFFER, (style.BLUE, style.SKY, style.PINK)))
    for axis, (across, up, label, title) in zip(axes, panels):
        for stiffer, own in quiet.groupby("k_n over the usual"):
            style.points(axis, own, across, up, "MD", color=shades[stiffer], label=f"springs of {'' if stiffer == 1 else f'{stiffer:g} '}$k_n$")
        if across == x:
            for _, found in quiet.groupby(["seed", "dSigma"]):
                axis.plot(found[across], found[up], color=style.GREY["DD"], lw=0.7, zorder=0)
            style.points(axis, rigid, across, up, "CD", mfc="none", label="rigid contacts")
            axis.axvline(1, color="k", lw=0.7, ls=":")
        else:
            axis.set_xscale("log")
        axis.set(yscale="log", xlabel=label, title=title)
    axes[0].set_ylabel(r"strain of a cycle $|\Delta\gamma|$")
    axes[0].legend(loc="center left")
    style.finish(fig, path, "Each point is a packing; grey lines join those of one seed under one load, prepared with three stiffnesses. "
                 "Rigid contacts (tolerance 1e-9) have the higher load on all of them.",
                 [runs[place] for place in quiet.index.union(rigid.index)] or runs)


def slow(table):
    """Return the springs' runs whose period is long enough."""
    return table[(table.method == "MD") & (table.period == table["k_n over the usual"].map(PERIODS))]


def power(rows, name, within=()):
    """Return (b, standard error) of name ~ k_n^b exp(c load/limit), by least squares; the error by the jackknife over the seeds.

    Stiffer packings are nearer to their limits, so that both have to be fitted at once. within: columns such as "seed"; each combination of their
    values has a factor of its own. Without one for each dSigma the two loads would be taken for one, which act on a packing through load/limit alone.
    """
    without = np.array([_fit(rows[rows.seed != seed], name, within) for seed in rows.seed.unique()])
    return _fit(rows, name, within), np.sqrt((len(without) - 1) * without.var())


def _fit(rows, name, within):
    group = rows.groupby(list(within)).ngroup() if within else pandas.Series(0, index=rows.index)
    known = np.column_stack([np.log(rows["k_n over the usual"]), rows["load over limit"], pandas.get_dummies(group)]).astype(float)
    return np.linalg.lstsq(known, np.log(rows[name]), rcond=None)[0][0]


def _same_load(rows, name):
    """Return the powers of k_n at one dSigma, whatever the load over the limit is then: their mean over the seeds, its standard error, and all."""
    found = np.array([np.polyfit(np.log(own["k_n over the usual"]), np.log(own[name]), 1)[0] for _, own in rows.groupby("seed")])
    return found.mean(), found.std(ddof=1) / np.sqrt(len(found)), found


def quantities(table):
    load, first, rate, stiffer, end = "load over limit", "first cycle", "rate", "k_n over the usual", "gamma at the end"
    packing = [stiffer, "seed"]
    springs = slow(table)[lambda rows: rows[load] < 1]
    lower, far, close = springs[springs.dSigma == LOWER], springs[springs[load] < NEAR], springs[springs[load] > NEAR]
    low, high = far[far.dSigma == LOWER], far[far.dSigma == LOAD]
    powers = {name: {what: power(rows, what, ("seed", "dSigma")) for what in (rate, first)} for name, rows in (
        ("low", low), ("far", far), ("to 0.9", springs[springs[load] < 0.9]), ("all", springs))}
    powers |= {"high": power(high, rate, ("seed",)), "close": power(close, rate), "close, own": power(close, rate, ("seed",)),
               "same": {what: _same_load(lower, what) for what in (rate, first)}}
    compared = high.seed.value_counts()[lambda count: count > 1]
    slows = springs["last quarter's rate over the one before"]
    table = table[table.dSigma == LOAD]
    loose, rigid, solved = (table[table.tolerance == tolerance] for tolerance in (LOOSER, RIGID["tolerance"], SOLVED))
    rests, near, beyond = rigid[rigid[load] < 0.98], rigid[rigid[load].between(0.98, 1)], rigid[rigid[load] > 1]
    yields, usual = near[near[end].abs() > 1e-5], [own[own[stiffer] == 1] for own in (loose, rigid)]
    md, mine = slow(table).set_index(packing), table[table.method == "MD"]
    over = lambda period, k: mine[(mine.period == period) & (mine[stiffer] == k)].set_index(packing)[[first, rate]] / md.loc[[k], [first, rate]]
    hasty, hasty_stiff, slower = over(SPRINGS["period"], 1).dropna(), over(SPRINGS["period"], 10), over(PERIODS[1], 10).dropna()
    pairs = beyond.merge(md, on=packing, suffixes=("", " MD")).set_index(stiffer)
    ratio, later = (pairs[f"{name} MD"] / pairs[name] for name in (first, end))
    alike = rigid[rigid[end].abs() > 1e-5].merge(solved, on=packing, suffixes=("", " to 1e-7"))
    missed, times = alike["unsolved steps"].astype(int), alike[f"{end} to 1e-7"] / alike[end]
    both, each = (rate, "contacts changed"), springs[springs.dSigma == LOAD].groupby(stiffer).size()
    correlated = {load: pandas.DataFrame([stats.spearmanr(*part[[*both]].dropna().to_numpy().T) for _, part in own.groupby(stiffer)],
                                         columns=["rank", "p"]) for load, own in springs.groupby("dSigma")}
    assert not solved["unsolved steps"].astype(float).any() and len(alike) == len(yields) + len(beyond)
    assert (springs[rate] > springs["rate error"]).all()
    assert list(ratio.index.value_counts()[[10, 100]]) == [1, 3] and (beyond["limit at the last load"] > 1 + LOAD).all()
    return locals()
