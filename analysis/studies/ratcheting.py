"""Late transient strain: strain a cycle against the load over the static limit, for springs of three stiffnesses and for rigid contacts on
the same packings."""
import numpy as np
import pandas

from analysis import cycles, limits, observables, style, summary
from analysis.studies import fig3
from analysis.style import plt
from yade_scripts.tables import product

TITLE = "Later cycles: do springs strain because they are soft?"
QUESTION = ("Strain of the first and of a late cycle with springs of k_n, 10 k_n and 100 k_n and with rigid contacts. Deformation of "
            "contacts goes as 1/k_n, rearrangement does not (Combe and Roux, arXiv:0901.3842).")
ORDER = 3  # in the report
# sigma1 = P0; under LOAD sigma2/sigma1 rises to 1.4, which is 0.80 to 1.04 of the static limits of these packings.
SPRINGS, RIGID = fig3.SPRINGS, fig3.RIGID | dict(tolerance=1e-9)
# Soft springs answer more slowly: with 0.5 s they lag behind the load. Of 1 and 10 k_n the periods go as 1/sqrt(k_n).
PERIODS = {1: 2.0, 10: 0.63, 100: 0.5}
STIFFER, LOAD, SEEDS = (1, 10, 100), 0.4, range(1, 11)
LOWER = 0.3  # 0.75 to 0.96 of the limits
NEAR = 0.96    # of the limit
SOLVED, LOOSER = 1e-7, 1e-6  # tolerances for comparison
FIRST_PEAK, LAST_PEAK = 1, 3  # snapshots of runs of several cycles; 0 is the start, 2 the end of the first cycle
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
            "contacts changed": changed(run.snapshots[FIRST_PEAK], run.snapshots[LAST_PEAK]) if len(run.snapshots) > LAST_PEAK else np.nan,
            "limit at the last load": limits.static_limit(run, LAST_PEAK) if rigid and len(run.snapshots) > LAST_PEAK else np.nan,
            **summary.columns(run, "unsolved steps", "balance error", "outcome")}


def changed(first, last):
    """Return how many contacts carry a force in one of two snapshots and not in the other, over those that do in the first."""
    before, after = observables.matched_forces(first, last) > 0
    return float((before != after).sum() / before.sum())


def draw(runs, rows, path):
    """Draw the strain of the first and of a late cycle against the load over the limit."""
    fig, axes = plt.subplots(1, 2, figsize=(9.5, 4.4), sharey=True, sharex=True)
    table = pandas.DataFrame(rows).assign(rate=lambda rows: rows["rate"].abs())
    rigid, quiet = table[table.tolerance == RIGID["tolerance"]], slow(table)
    shades = dict(zip(STIFFER, (style.BLUE, style.SKY, style.PINK)))
    for axis, (up, title) in zip(axes, (("first cycle", "first cycle"), ("rate", "a late cycle (mean of the last half)"))):
        for stiffer, own in quiet.groupby("k_n over the usual"):
            style.points(axis, own, "load over limit", up, "MD", color=shades[stiffer],
                         label=f"springs of {'' if stiffer == 1 else f'{stiffer:g} '}$k_n$")
        style.points(axis, rigid, "load over limit", up, "CD", mfc="none", label="rigid contacts")
        axis.axvline(1, color="k", lw=0.7, ls=":")
        axis.set(yscale="log", xlabel=r"largest $\sigma_2/\sigma_1$ over its static limit", title=title)
    axes[0].set_ylabel(r"strain of a cycle $|\Delta\gamma|$")
    axes[0].legend(loc="center left")
    style.finish(fig, path, "Each point is a packing. Rigid contacts: tolerance 1e-9; below 0.98 of the limit they show the error of their solver.",
                 [runs[place] for place in quiet.index.union(rigid.index)] or runs)


def slow(table):
    """Return the springs' runs whose period is long enough."""
    return table[(table.method == "MD") & (table.period == table["k_n over the usual"].map(PERIODS))]


def power(rows, name, within=()):
    """Return (b, standard error, c) of name ~ k_n^b exp(c load/limit), by least squares; the error is the larger of those by least squares and by the
    jackknife over the seeds.

    Stiffer packings are nearer to their limits, so that both have to be fitted at once. within: columns such as "seed"; each combination of their
    values has a factor of its own. Without one for each dSigma the two loads would be taken for one, which act on a packing through load/limit alone.
    """
    (b, c), error = _fit(rows, name, within)
    without = np.array([_fit(rows[rows.seed != seed], name, within)[0][0] for seed in rows.seed.unique()])
    return b, max(error, np.sqrt((len(without) - 1) * without.var())), c


def _fit(rows, name, within):
    group = rows.groupby(list(within)).ngroup() if within else pandas.Series(0, index=rows.index)
    known = np.column_stack([np.log(rows["k_n over the usual"]), rows["load over limit"], pandas.get_dummies(group)]).astype(float)
    found = np.linalg.lstsq(known, np.log(rows[name]), rcond=None)[0]
    variance = np.sum((np.log(rows[name]) - known @ found)**2) / max(1, len(known) - known.shape[1])
    return found[:2], np.sqrt(variance * np.linalg.pinv(known.T @ known)[0, 0])


def _same_load(rows, name):
    """Return the powers of k_n at one dSigma, whatever the load over the limit is then: their mean over the seeds, its standard error, and all."""
    found = np.array([np.polyfit(np.log(own["k_n over the usual"]), np.log(own[name]), 1)[0] for _, own in rows.groupby("seed")])
    return found.mean(), found.std(ddof=1) / np.sqrt(len(found)), found


def quantities(table):
    load, first, rate, stiffer, end = "load over limit", "first cycle", "rate", "k_n over the usual", "gamma at the end"
    packing = [stiffer, "seed"]
    springs = slow(table)[lambda rows: rows[load] < 1]
    lower = springs[springs.dSigma == LOWER]
    low = lower[lower[load] < NEAR]
    powers = {name: {what: power(rows, what, ("seed", "dSigma")) for what in (rate, first)} for name, rows in (("low", low), ("all", springs))}
    powers["same"] = {what: _same_load(lower, what) for what in (rate, first)}
    slows = springs["last quarter's rate over the one before"]
    by_seed = lower.pivot_table(index="seed", columns=stiffer, values=rate).abs()
    stiffer_less = (by_seed[1] / by_seed[10]).dropna()  # the same dSigma; the packings differ, since each is prepared with its own springs
    table = table[table.dSigma == LOAD]
    rigid, solved = (table[table.tolerance == tolerance] for tolerance in (RIGID["tolerance"], SOLVED))
    rests, near, beyond = rigid[rigid[load] < 0.98], rigid[rigid[load].between(0.98, 1)], rigid[rigid[load] > 1]
    yields = near[near[end].abs() > 1e-5]
    md, mine = slow(table).set_index(packing), table[table.method == "MD"]
    over = lambda period, k: mine[(mine.period == period) & (mine[stiffer] == k)].set_index(packing)[[first, rate]] / md.loc[[k], [first, rate]]
    hasty = over(SPRINGS["period"], 1).dropna()
    pairs = beyond.merge(md, on=packing, suffixes=("", " MD")).set_index(stiffer)
    ratio = pairs[f"{first} MD"] / pairs[first]
    both = rigid.merge(md.reset_index(), on=packing, suffixes=("", " MD"))
    under = both[both[load] < 0.98]
    rigid_late = under[rate].abs() / under[f"{rate} MD"].abs()
    assert not solved["unsolved steps"].astype(float).any() and (springs[rate] > springs["rate error"]).all()
    assert list(ratio.index.value_counts()[[10, 100]]) == [1, 3] and (beyond["limit at the last load"] > 1 + LOAD).all()
    return locals() | {"exp": np.exp}
