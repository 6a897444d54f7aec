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
    shades = dict(zip(STIFFER, ("#0072B2", "#56B4E9", "#CC79A7")))
    for axis, (across, up, label, title) in zip(axes, panels):
        for stiffer, own in quiet.groupby("k_n over the usual"):
            style.points(axis, own, across, up, "MD", color=shades[stiffer], label=f"springs of {'' if stiffer == 1 else f'{stiffer:g} '}$k_n$")
        if across == x:
            for _, found in quiet.groupby(["seed", "dSigma"]):
                axis.plot(found[across], found[up], color="#DDDDDD", lw=0.7, zorder=0)
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


ANSWER = """
Below the limit packings with springs strain from cycle to cycle mainly because the springs are soft. Under dSigma = 0.3, which loads 29 packings from
10 seeds to 0.75 to 0.95 of their limits, the strain of a late cycle (the mean of the last 10 of 20) goes nearly as 1/k_n if packings at the same
ratio of load to limit are compared: as k_n to the power -0.95 (standard error 0.02), and that in the first cycle to the power -0.96 (0.02). Closer to
the limit the strain of a late cycle depends less on k_n, without a sharp boundary. All 42 runs up to 0.96 of the limit, with a factor for each seed
and load, give -0.89 (0.03), those up to 0.9 of it -0.99 (0.05) and all 56 up to the limit -0.71 (0.06). Under dSigma = 0.4 alone, up to 0.96 of the
limit, it is -0.76 (0.09), a rough value from the 10 runs of 4 seeds that can be compared. The strain of the first cycle of these 42 runs goes as k_n
to the power -0.98 (0.02). So the strain of the first cycle is deformation of the contacts, type I, and that of a late cycle is so for the most part.
Stiffened packings have other contacts and are nearer to their limits. Under the same dSigma of 0.3 stiffness therefore helps less: the powers are
-0.67 (standard error 0.10; -1.00 to -0.17 on single packings) and -0.87 (0.03), means over the seeds. Between 0.96 and the limit 14 runs from 8 seeds
scatter too much to tell: the strain of a late cycle goes as k_n to the power -0.50 (0.16) over all of them and -0.44 (0.33) within the seeds. Most
rates still fall: over the last five cycles they are 0.63 times those of the five before (median; quartiles 0.56 and 0.76).

Cycles have to be slow. With 0.5 s instead of 2 s springs of k_n lag behind the load, and a late cycle strains them 3.1 times as far (median of 10
packings; 0.4 to 5.6), the first one 1.15 times. For springs of 10 k_n 0.63 s are slow enough: with 2 s a late cycle strains them 0.94 times as far
(0.76 to 1.21), with 0.5 s 1.05 times.

Rigid contacts rest below 0.98 of the limit, in 19 of 19 cases from 10 seeds, with 9.7e-10 a cycle at most. Between there and the limit the lowest
load at which one yields is 0.982 of it; 3 of 7 yield, by 1.8e-5 to 3.0e-4 in 20 cycles: the static limit is the most that contacts with friction can
carry, but they may carry less. The 7 runs that yield, here and beyond the limit, miss their tolerance of 1e-9 in 11 to 36 of 4000 steps; with a
tolerance of 1e-7 no run misses a step, and these packings yield 0.98 to 1.34 times as far. In the packings that rest, the strain is the error of the
solver. In the packings prepared with k_n it is 2.2e-10 a cycle with a tolerance of 1e-9 and 4.6e-7 with 1e-6 (medians).

Beyond the limit, up to 1.04 of it, rigid contacts yield, by 3.1e-4 to 1.2e-3 in the first cycle (4 cases from 3 seeds). Springs of 100 k_n strain
1.03 to 1.21 times as far there (3 cases) and springs of 10 k_n 1.73 times (1 case): the stiffer they are, the closer they are to rigid contacts. But
springs go on straining: after 20 cycles those of 100 k_n have strained 1.07 to 1.76 times as far as rigid contacts. The packings with rigid contacts
come to rest, with 3.0e-8 a cycle at most: by then they have formed contacts that carry 1.42 to 1.44 P0, more than the load.

With springs, the share of contacts that change from the first to the last peak of the load grows with the strain of a late cycle under dSigma = 0.4:
among the packings of one stiffness the rank correlation is 0.82 to 0.88 (7 to 10 packings, p of 0.014 at most). Under 0.3 it is 0.22 to 0.75 (p from
0.01 to 0.54), so for two of the three stiffnesses this may be chance. With rigid contacts this share means nothing, because contacts may lose their
force and stay closed.
"""
GIVEN = ("0.3", "0.5", "0.9", "0.63", "1e-6", "1e-7", "1e-9", "20", "100", "2", "1", "0.98", "4000")


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


def numbers(table):
    load, first, rate, stiffer, end = "load over limit", "first cycle", "rate", "k_n over the usual", "gamma at the end"
    springs = slow(table)[lambda rows: rows[load] < 1]
    lower, far, close = springs[springs.dSigma == LOWER], springs[springs[load] < NEAR], springs[springs[load] > NEAR]
    low = far[far.dSigma == LOWER]
    (late_low, first_low), (late_far, first_far) = ([power(rows, name, ("seed", "dSigma")) for name in (rate, first)] for rows in (low, far))
    high = far[far.dSigma == LOAD]
    late_high, compared = power(high, rate, ("seed",)), high.seed.value_counts()[lambda count: count > 1]
    late_same, first_same = (_same_load(lower, name) for name in (rate, first))
    late_near, late_near_own = (power(close, rate, within) for within in ((), ("seed",)))
    slows = springs["last quarter's rate over the one before"]
    table = table[table.dSigma == LOAD]
    loose, rigid, solved = (table[table.tolerance == tolerance] for tolerance in (LOOSER, RIGID["tolerance"], SOLVED))
    rests, near, beyond = rigid[rigid[load] < 0.98], rigid[rigid[load].between(0.98, 1)], rigid[rigid[load] > 1]
    yields = near[near[end].abs() > 1e-5]
    packing = [stiffer, "seed"]
    md, mine = slow(table).set_index(packing), table[table.method == "MD"]
    over = lambda period, k: mine[(mine.period == period) & (mine[stiffer] == k)].set_index(packing)[[first, rate]] / md.loc[[k], [first, rate]]
    hasty, hasty_stiff, slower = over(SPRINGS["period"], 1), over(SPRINGS["period"], 10), over(PERIODS[1], 10)
    pairs = beyond.merge(md, on=packing, suffixes=("", " MD")).set_index(stiffer)
    ratio, later = (pairs[f"{name} MD"] / pairs[name] for name in (first, end))
    alike = rigid[rigid[end].abs() > 1e-5].merge(solved, on=packing, suffixes=("", " to 1e-7"))
    missed, alike = alike["unsolved steps"].astype(float), alike[f"{end} to 1e-7"] / alike[end]
    both, each = (rate, "contacts changed"), springs[springs.dSigma == LOAD].groupby(stiffer).size()
    together = {load: [stats.spearmanr(*part[[*both]].dropna().to_numpy().T) for _, part in own.groupby(stiffer)]
                for load, own in springs.groupby("dSigma")}
    correlation, chance = ({load: [getattr(found, name) for found in of_load] for load, of_load in together.items()}
                           for name in ("statistic", "pvalue"))
    late_90, late_all = (power(springs[springs[load] < bound], rate, ("seed", "dSigma")) for bound in (0.9, 1))
    assert not solved["unsolved steps"].astype(float).any() and len(alike) == len(yields) + len(beyond)
    assert (springs[rate] > springs["rate error"]).all()
    assert list(ratio.index.value_counts()[[10, 100]]) == [1, 3] and (beyond["limit at the last load"] > 1 + LOAD).all()
    return {"29": len(low), "10": [low.seed.nunique(), compared.sum(), len(hasty), rests.seed.nunique(), each.max()],
            **summary.stated("0.75 0.95", low[load]),
            "-0.95": late_low[0], "0.02": [late_low[1], first_low[1], first_far[1]], "-0.96": first_low[0], "42": len(far), "0.96": NEAR,
            "-0.89": late_far[0], "0.03": [late_far[1], first_same[1]], "-0.99": late_90[0], "0.05": late_90[1], "56": len(springs),
            "-0.71": late_all[0], "0.06": late_all[1], "0.4": LOAD, "-0.76": late_high[0], "0.09": late_high[1], "4": [len(compared), len(beyond)],
            "-0.98": first_far[0],
            "-0.67": late_same[0], "0.10": late_same[1], **summary.stated("-1.00 -0.17", late_same[2]), "-0.87": first_same[0], "14": len(close),
            "8": close.seed.nunique(), "-0.50": late_near[0],
            "0.16": late_near[1], "-0.44": late_near_own[0], "0.33": late_near_own[1], "0.63": slows.median(), "0.56": slows.quantile(0.25),
            "0.76": slows.quantile(0.75),
            **summary.stated("3.1 0.4 5.6", hasty[rate].dropna(), "median min max"), "1.15": hasty[first].median(),
            **summary.stated("0.94 0.76 1.21", slower[rate].dropna(), "median min max"), "1.05": hasty_stiff[rate].median(),
            "0.98": alike.min(), "19": [len(rests), (rests[end].abs() < 1e-6).sum()], "9.7e-10": rests[rate].abs().max(), "0.982": yields[load].min(),
            "3": [len(yields), beyond.seed.nunique(), len(ratio[100])], "7": [len(near), len(alike), each.min()],
            **summary.stated("1.8e-5 3.0e-4", yields[end].abs()), **summary.stated("11 36", missed), "1.34": alike.max(),
            "2.2e-10": rigid[rigid[stiffer] == 1][rate].abs().median(), "4.6e-7": loose[rate].abs().median(),
            "1.04": beyond[load].max(), **summary.stated("3.1e-4 1.2e-3", beyond[first]), **summary.stated("1.03 1.21", ratio[100]),
            "1.73": ratio[10], **summary.stated("1.07 1.76", later[100]), "3.0e-8": beyond[rate].abs().max(),
            **summary.stated("1.42 1.44", beyond["limit at the last load"]),
            **summary.stated("0.82 0.88", correlation[LOAD]), "0.014": max(chance[LOAD]), **summary.stated("0.22 0.75", correlation[LOWER]),
            **summary.stated("0.01 0.54", chance[LOWER])}
