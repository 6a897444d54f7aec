"""How many cycles a packing stands before it collapses, and how one changed setting changes that."""
import math

import numpy as np
import pandas
from scipy import stats

from analysis import limits, observables, style, summary
from analysis.studies import fig3
from analysis.style import plt
from yade_scripts.tables import product

TITLE = "Which packings survive, and what decides?"
QUESTION = "Cycles that pass the static limit, the mean stress held; one setting is changed at a time."
ORDER = 4  # in the report
LOADING = dict(cycles=80, stress_path="mean")
SPRINGS, RIGID = fig3.SPRINGS | LOADING, fig3.RIGID | LOADING
SLOW = dict(period=2.0, records_per_cycle=400, cycles=10)
STIFF, ANOTHER_LAW = dict(stiffening=10.0), dict(tangential_law="path_independent")
RIGID_CHANGES = {"tolerance 1e-6": dict(tolerance=1e-6), "step / 5": dict(cd_dt=5e-4), "other forces": dict(network_seed=1)}
# What is changed of springs and of rigid contacts; the packings of 10 k_n are the same ones, stiffened.
CASES = {name: SPRINGS | change for name, change in {
    "springs": {}, "springs, 10 k_n": STIFF, "springs, 10 k_n, path-independent law": STIFF | ANOTHER_LAW,
    "springs, step / 3": dict(md_dt_factor=0.1),
    "springs, path-independent law": ANOTHER_LAW, "springs, servo for walls": dict(md_walls="servo"),
    "springs, damping x 3": dict(damping_factor=3.0, md_dt_factor=0.1),
    "springs, 2 s": SLOW}.items()}
CASES |= {name: RIGID | change for name, change in {
    "rigid": {}, "rigid, 2 s": SLOW, **{f"rigid{words}, {name}": base | change for words, base in (("", {}), (", packing of 10 k_n", STIFF))
                                        for name, change in RIGID_CHANGES.items()}, "rigid, packing of 10 k_n": STIFF}.items()}
LOADS, SEEDS, MORE = (0.3, 0.4), range(1, 7), range(7, 16)
# Cases that are compared on the packings of MORE, too: both methods, and the settings that may decide which method stands longer.
MAIN = ("springs", "springs, 10 k_n", "rigid", "rigid, packing of 10 k_n", "springs, servo for walls", "springs, 2 s", "rigid, 2 s")
FINE, SOME = "rigid, step / 5", range(7, 11)  # this case is dear: on some of these
ROWS = {"quick": product(delta_sigma=0.4, **SPRINGS) + product(delta_sigma=0.4, **RIGID),
        "full": [row for settings in CASES.values() for row in product(**settings, delta_sigma=LOADS, seed=SEEDS)]
        + [row for name in MAIN for row in product(**CASES[name], delta_sigma=LOADS, seed=MORE)]
        + product(**CASES[FINE], delta_sigma=LOADS, seed=SOME)}


def case(full):
    """Return the name of what is changed in a run of these parameters."""
    usual = dict(stiffening=1.0, tangential_law="standard", network_seed=0, damping_factor=1.0)
    return next(name for name, settings in CASES.items() if all(full.get(key, value) == value for key, value in (usual | settings).items()))


@summary.each
def summarize(run):
    """Return the row of a run: when it collapses, in cycles and seconds, or how far it has strained where it stands."""
    return {"method": run.method, "case": case(run.parameters),
            **summary.columns(run, "dSigma", "seed", "static limit", "load over limit", "collapses after"),
            "seconds": run.values("time")[-1] if run.collapsed else np.nan, "seconds above the limit": _above(run),
            "stands": np.nan if run.collapsed else run.values("cycle")[-1],
            **summary.columns(run, "gamma at the end", "unsolved steps", "balance error", "outcome")}


def _above(run):
    """Return the time that the load has been above the static limit of the packing at the start [s]."""
    return np.diff(run.values("time"), prepend=0.0)[limits.over_limit(run, observables.load(run)) > 1].sum()


# Of the cases: those that are drawn, with their words and looks.
SHOWN = {"springs": ("springs, cycles of 0.5 s", dict(color=style.COLOUR["MD"], lw=2.4)),
         "springs, servo for walls": ("the same, walls moved by a servo", dict(color=style.COLOUR["MD"], ls=":", lw=2)),
         "springs, 10 k_n": (r"springs of $10\,k_n$, cycles of 0.5 s", dict(color=style.SKY, lw=1.2)),
         "springs, 2 s": ("springs, cycles of 2 s", dict(color=style.COLOUR["MD"], ls="--", lw=1.2)),
         "rigid": ("rigid contacts, cycles of 0.5 s", dict(color=style.COLOUR["CD"], lw=2.4)),
         "rigid, step / 5": ("the same, a fifth of the step", dict(color=style.COLOUR["CD"], ls=":", lw=2)),
         "rigid, 2 s": ("rigid contacts, cycles of 2 s", dict(color=style.COLOUR["CD"], ls="--", lw=1.2))}


def draw(runs, rows, path):
    """Draw the share of the packings that still stand against the number of cycles, a panel a load.

    All runs of a case that stand have the same length, so the steps are the estimate of Kaplan and Meier.
    """
    table = pandas.DataFrame(rows)
    loads = sorted(table.dSigma.unique())
    fig, axes = plt.subplots(1, len(loads), figsize=(2.5 + 4 * len(loads), 4.6), squeeze=False, sharex=True, sharey=True)
    for axis, load in zip(axes[0], loads):
        for name, (words, look) in SHOWN.items():
            if len(own := table[(table.dSigma == load) & (table.case == name)]):
                axis.step(*survival(own), where="post", label=f"{words} ({len(own)})", **look)
        axis.set(xscale="log", xlabel="cycles", title=rf"$\Delta\sigma$ = {load:g}, {style.STRESS_PATH['mean']}", ylim=(-0.02, 1.02))
        axis.grid(True)
    axes[0, 0].set_ylabel("share of the packings that stand")
    axes[0, -1].legend(loc="upper right", fontsize=7.5)
    style.finish(fig, path, "In brackets: how many packings. Forces push the walls unless a servo moves them. A line that does not reach 0 ends with "
                 "the runs.", runs)


def survival(own):
    """Return (cycles, share of the packings that stand from there on), up to the last collapse or the end of the runs."""
    lives = np.sort(own["collapses after"].dropna())
    share, end = 1 - np.arange(len(lives) + 1) / len(own), own.stands.max()
    return np.append(np.insert(lives, 0, 0.5), [end] if end > 0 else []), np.append(share, [share[-1]] if end > 0 else [])


POINTS = (
    (18, "[...] while CD is much more resistant to collapse.", "section 4", "agrees in part"),
)


def times(table, case, base):
    """Return how many times as many cycles the packings stand in `case` as in `base`: a row a packing and load, between `least` and `most`.

    A packing that still stands after the last cycle of its run may stand for ever, so one of the two ends is open: infinite or 0.
    """
    table = table.assign(life=table["collapses after"].fillna(table.stands).round(6), falls=table["collapses after"].notna())
    own, usual = (table[table.case == name].set_index(["dSigma", "seed"])[["life", "falls"]] for name in (case, base))
    both = own.join(usual, rsuffix=" usual", how="inner")
    known = both.life / both["life usual"]
    return pandas.DataFrame({"least": known.where(both["falls usual"], 0.0), "most": known.where(both.falls, np.inf)})


def medians(quotients):
    """Return the least and the largest median that such quotients can have: the same number twice if those that still stand do not matter."""
    return quotients.least.median(), quotients.most.clip(upper=1e9).median()


def bound(quotients, sides=1):
    """Return the bounds of the median by order statistics that hold with a confidence of at least 95 %, and this confidence in per cent.

    sides: 1 for the bound from below only, 2 for that from above, too. Raise ValueError if there are too few values.
    """
    found, count = np.sort(quotients.least), len(quotients)
    ranks = {rank: 1 - sides * sum(math.comb(count, k) for k in range(rank)) / 2**count for rank in range(1, count // 2 + 1)}
    rank = max((rank for rank, confidence in ranks.items() if confidence >= 0.95), default=None)
    if rank is None:
        raise ValueError(f"{count} packings are too few for bounds that hold with 95 % confidence")
    ends = (found[rank - 1],) if sides == 1 else (found[rank - 1], np.sort(quotients.most)[count - rank])
    return *ends, 100 * ranks[rank]


def longer(quotients):
    """Return how many packings surely stand longer."""
    return (quotients.least > 1).sum()


def words(quotients, digits=2):
    """Return the median of such quotients in words: a range where it depends on the packings that still stand."""
    low, high = medians(quotients)
    return f"{low:.{digits}f}" + ("" if low == high else " or more" if high == 1e9 else f" to {high:.{digits}f}")


def shorter(quotients):
    """Return how many packings surely stand less long."""
    return (quotients.most < 1).sum()


def standing(table, case, load):
    """Return how many packings of a case stand to the end of its runs under a load, of how many, and the median of the cycles they stand: infinite
    if half of them stand to the end."""
    lives = table[(table.case == case) & (table.dSigma == load)]["collapses after"]
    return int(lives.isna().sum()), len(lives), lives.fillna(np.inf).median()


def quantities(table):
    hard_rigid, hard_springs, stiff, period = "rigid, packing of 10 k_n", "springs, 10 k_n", STIFF["stiffening"], SLOW["period"]
    soft, hard, servo, step, fine, between, stiff_springs, slowly, slow_pairs = (times(table, *pair) for pair in (
        ("rigid", "springs"), (hard_rigid, hard_springs), ("springs, servo for walls", "springs"),
        ("rigid, step / 5", "rigid"), ("rigid, step / 5", "springs"), ("rigid", "springs, servo for walls"), (hard_springs, "springs"),
        ("springs, 2 s", "springs"), ("rigid, 2 s", "springs, 2 s")))
    others = [times(table, f"{base}, {change}", base) for base, change in (
        ("rigid", "tolerance 1e-6"), ("rigid", "other forces"), (hard_rigid, "tolerance 1e-6"), (hard_rigid, "other forces"), ("springs", "step / 3"),
        ("springs", "damping x 3"), ("springs", "path-independent law"), (hard_springs, "path-independent law"))]
    loose, networks, law = others[0], others[1], others[6]
    shown = {name: [standing(table, name, load) for load in LOADS] for name in (*MAIN, FINE)}
    long = table[table.case.isin(("springs, 2 s", "rigid, 2 s"))]["collapses after"]

    def sign(quotients):
        """Return the p of the sign test: of the packings of which it is known, as many stand longer, or less long, by chance."""
        more, less = longer(quotients), shorter(quotients)
        return stats.binomtest(int(more), int(more + less)).pvalue

    for change in others:  # of none the text says that it has an effect
        own = change.groupby("seed").prod()
        assert len(own) not in (longer(own), shorter(own)), own
    return locals() | {function.__name__: function for function in (words, bound, longer, shorter)}
