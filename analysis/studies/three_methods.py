"""Ramp, later cycles, collapse and slow cycles by three methods: MD's springs, the same springs in the solver of Contact Dynamics, and rigid
contacts."""
import numpy as np
import pandas
from scipy import stats

from analysis import cycles, limits, observables, style, summary
from analysis.studies import collapse, fig3, fig5, ratcheting
from analysis.studies.implicit import COLOUR, MARKER, MD, RIGID, SPRINGS, kind
from analysis.style import plt
from yade_scripts.tables import product

TITLE = "Is it the same beyond one cycle?"
QUESTION = "MD's springs, the same springs in Contact Dynamics (cd_contacts=springs), and rigid contacts, from the same packings."
ORDER = 4.5  # in the report
RAMP, LATE, COLLAPSE, SLOW = "ramp", "late cycles", "collapse", "slow cycles"
IMPLICIT = dict(method="CD", cd_contacts="springs", cd_dt=1e-3)
SEEDS, FEW = range(1, 11), (1, 2, 3)
MD_RAMP, RIGID_RAMP = (dict(ramp_rate=fig5.USUAL, cycles=15, **fig5.RAMP) | method for method in fig5.METHODS)
PERIOD, COUNT = ratcheting.PERIODS[1], 20  # of the late cycles: s, number
# Packings that yield or nearly so cannot be solved to 1e-8 in every step.
MD_LATE, RIGID_LATE = (base | dict(period=PERIOD, cycles=COUNT) for base in (fig3.SPRINGS, fig3.RIGID | dict(tolerance=1e-7)))
RIGID_COLLAPSE = collapse.RIGID | dict(tolerance=1e-6)
SLOW_PERIOD, SLOW_COUNT, OVERLAP = 4.0, 100, 10  # MD runs the first OVERLAP of the slow cycles
MD_SLOW = fig3.SPRINGS | dict(period=SLOW_PERIOD)
LATE_LOAD, HIGHER, LIVES, SLOW_LOADS = 0.3, 0.4, (0.3, 0.4), (0.2, 0.3, 0.4)
OTHER_LAW = dict(tangential_law="path_independent")


def implicit(md, **more):
    """Return a row of MD by springs in Contact Dynamics."""
    return {name: value for name, value in md.items() if name not in ("md_dt_factor", "md_walls")} | IMPLICIT | more


FINER, HALF, SLOW_STEP = dict(cd_dt=2.5e-4), dict(cd_dt=5e-4), dict(cd_dt=5e-3)  # grains that rattle, as in a collapse, are damped by long steps
LATE_THREE = (MD_LATE, implicit(MD_LATE), RIGID_LATE)
ROWS = {"quick": [base | dict(seed=1, ramp_rate=fig5.QUICK, cycles=3) for base in (MD_RAMP, implicit(MD_RAMP), RIGID_RAMP)]
        + [base | dict(seed=1, delta_sigma=HIGHER, cycles=4) for base in LATE_THREE]
        + product(**implicit(MD_SLOW, **SLOW_STEP), seed=1, delta_sigma=HIGHER, cycles=4),
        "full": [row for bases, more in (
            ((MD_RAMP, implicit(MD_RAMP), RIGID_RAMP), dict(seed=SEEDS)),
            (LATE_THREE, dict(delta_sigma=LATE_LOAD, seed=SEEDS)), (LATE_THREE, dict(delta_sigma=HIGHER, seed=FEW)),
            ((collapse.SPRINGS, implicit(collapse.SPRINGS, cycles=48, **FINER), RIGID_COLLAPSE), dict(delta_sigma=LIVES, seed=SEEDS)))
                 for base in bases for row in product(**base, **more)]
        # The step's error, and how much MD itself changes with its tangential law.
        + product(**implicit(MD_LATE, **HALF), delta_sigma=LATE_LOAD, seed=FEW)
        + product(**implicit(collapse.SPRINGS), delta_sigma=LIVES[0], seed=SEEDS)
        + product(**MD_RAMP | OTHER_LAW, seed=FEW) + product(**MD_LATE | OTHER_LAW, delta_sigma=LATE_LOAD, seed=FEW)
        + product(**collapse.SPRINGS | OTHER_LAW, delta_sigma=LIVES[0], seed=SEEDS)
        + product(**MD_SLOW, cycles=OVERLAP, delta_sigma=SLOW_LOADS, seed=FEW)
        + product(**implicit(MD_SLOW, **SLOW_STEP), cycles=SLOW_COUNT, delta_sigma=SLOW_LOADS, seed=FEW)}
THRESHOLDS = (1e-4, 1e-3, 1e-2, 1e-1)  # of |gamma| under the ramp
WINDOWS = ((1, 1), (2, 5), (6, 10), (11, 20), (21, 50), (51, SLOW_COUNT))  # of the slow cycles


def experiment(run):
    """Return which of the four experiments a run belongs to."""
    row = run.parameters
    if row["loading"] == "ramp":
        return RAMP
    return COLLAPSE if row["stress_path"] == "mean" else SLOW if row["period"] == SLOW_PERIOD else LATE


def over(threshold):
    return f"over the limit at |gamma| = {threshold:g}"


@summary.each
def summarize(run):
    """Return the row of a run. over the limit at: sigma2/sigma1 over its static limit where |gamma| passes a threshold. rate: strain a cycle of the
    second half, positive where the sample goes on shortening. stands: cycles that a packing stands at least, if it does not collapse.
    Under slow cycles `rate, cycles 2 to 5` and so on, where these have been run."""
    row, found, which = run.parameters, cycles.of(run), experiment(run)
    named = {"experiment": which, "medium": kind(run), "law": row["tangential_law"] if run.method == "MD" else "standard", "packing": row["seed"],
             "dSigma": np.nan if which == RAMP else row["delta_sigma"], "step_s": row["cd_dt"] if run.method == "CD" else np.nan,
             "load over limit": np.nan if which == RAMP else limits.load_over_limit(run)}
    if which == RAMP:
        load = limits.over_limit(run, observables.load(run))
        named |= {over(threshold): limits.over_limit(run, observables.critical_load(run, threshold)) for threshold in THRESHOLDS}
        named["|gamma| at the limit"] = float(np.interp(1, load, np.abs(run.values("gamma")), right=np.nan))
    elif which == COLLAPSE:
        named |= summary.columns(run, "collapses after") | {"stands": np.nan if run.collapsed else run.values("cycle")[-1]}
    else:
        count = len(found.number)
        named |= {"first cycle": abs(found.first), "rate": -found.late_rate, "rate error": cycles.error_of_mean(found.rate[-(count // 2):])}
    if which == SLOW:
        named |= {_window(window): -found.rates([window])[0] for window in WINDOWS if window[1] <= count}
    return named | {"seconds": float(run.values("processor_time")[-1]), **summary.columns(run, "unsolved steps", "balance error", "outcome")}


def _window(window):
    return "rate, cycle" + ("s %d to %d" % tuple(window) if window[0] < window[1] else f" {window[0]}")


def other_step(table):
    """Return which rows of late cycles and collapse show the step's error."""
    step = table.experiment.map({LATE: HALF["cd_dt"], COLLAPSE: IMPLICIT["cd_dt"]})
    return (table.medium == SPRINGS) & (table.step_s == step)


def usual(table):
    """Return the rows of one law and step, over which the packings are compared."""
    return table[(table.law == "standard") & ~other_step(table)]


def draw(runs, rows, path):
    """Draw a panel an experiment of which there are runs."""
    fig, axes = plt.subplots(2, 2, figsize=(10, 8))
    table = usual(pandas.DataFrame(rows))
    runs_of = summary.groups([run for run in runs if run.parameters["tangential_law"] == "standard"], experiment, ordered=False)
    for axis, which, panel in zip(axes.flat, (RAMP, LATE, COLLAPSE, SLOW), (_ramp, _late, _survival, _slow)):
        axis.set_visible(which in runs_of)
        if which in runs_of:
            panel(axis, runs_of[which], table[table.experiment == which])
    style.finish(fig, path, "Top left: one packing. Top right: each point is a packing under one load; late cycles are cycles 11 to 20; "
                 "dotted: as by MD. Rigid contacts below the static limit show the error of their solver only. Bottom left: all packings. "
                 "Bottom right: means of neighbouring cycles, a line for each packing.", runs)


LINE = {MD: dict(lw=3, alpha=0.6), SPRINGS: dict(lw=1.5, ls="--"), RIGID: dict(lw=1.5)}


def _ramp(axis, runs, table):
    """Draw |gamma| of the first packing against the load over the limit."""
    for run in runs:
        if run.parameters["seed"] == min(other.parameters["seed"] for other in runs):
            axis.plot(limits.over_limit(run, observables.load(run)), np.abs(run.values("gamma")), color=COLOUR[kind(run)], label=kind(run),
                      **LINE[kind(run)])
    axis.axvline(1, color="k", lw=0.7, ls=":")
    axis.set(yscale="log", ylim=(1e-8, 0.4), xlabel=r"$\sigma_2/\sigma_1$ over its static limit", ylabel=r"strain $|\gamma|$",
             title="a ramp until collapse")
    axis.legend(loc="upper left")


def _late(axis, runs, table):
    """Draw the strain of the first and of a late cycle of a packing against that of MD on it."""
    ends = []
    for name, full in (("rate", True), ("first cycle", False)):
        values = table.pivot_table(index=["dSigma", "packing"], columns="medium", values=name, dropna=False)
        values = values.reindex(columns=(MD, SPRINGS, RIGID)).abs()
        for medium in (SPRINGS, RIGID):
            axis.plot(values[MD], values[medium], ls="", marker=MARKER[medium], color=COLOUR[medium], mfc=None if full else "none", ms=5,
                      label=medium if full else None)
        ends += [values[MD].min(), values[MD].max()]
    if np.isfinite(ends).all():
        axis.plot([min(ends), max(ends)], [min(ends), max(ends)], color="k", lw=0.7, ls=":")
    axis.set(xscale="log", yscale="log", xlabel="strain of a cycle by MD", ylabel="strain of a cycle by CD",
             title="first cycle (hollow) and late cycles (full)")
    axis.legend()


def _survival(axis, runs, table):
    """Draw the share of the packings that stand against the number of cycles."""
    for (load, medium), own in table.groupby(["dSigma", "medium"]):
        falls = np.sort(own["collapses after"].dropna())
        end = max(table["collapses after"].max(), table.stands.fillna(0).max())
        x = np.concatenate(([table["collapses after"].min() / 2], falls, [end]))
        y = np.append(1 - np.arange(len(falls) + 1) / len(own), 1 - len(falls) / len(own))
        axis.step(x, y, where="post", color=COLOUR[medium], **LINE[medium] | dict(ls="-" if load == max(table.dSigma) else (0, (4, 1.5))),
                  label=medium if load == max(table.dSigma) else None)
    axis.set(xscale="log", xlabel="cycles", ylabel="share of the packings that stand",
             title="collapse, mean stress held")
    for load in sorted(table.dSigma.unique()):
        axis.plot([], [], color=style.GREY["44"], ls="-" if load == max(table.dSigma) else (0, (4, 1.5)), label=rf"$\Delta\sigma$ = {load:g}")
    axis.legend()


def _slow(axis, runs, table):
    """Draw the strain of a cycle, in means over windows of the cycles, against its number."""
    shades = style.shades(run.parameters["delta_sigma"] for run in runs)
    for run in runs:
        found, load, medium = cycles.of(run), run.parameters["delta_sigma"], kind(run)
        windows = cycles.windows(len(found.number))
        first = run.parameters["seed"] == min(other.parameters["seed"] for other in runs)
        axis.plot([np.sqrt(first * last) for first, last in windows], np.abs(found.rates(windows)), color=shades[load],
                  lw=4 if medium == MD else 1.2, alpha=0.35 if medium == MD else 1,
                  label=rf"$\Delta\sigma$ = {load:g}" + (", MD" if medium == MD else "") if first else None)
    axis.set(xscale="log", yscale="log", xlabel="cycle", ylabel=r"strain of a cycle $|\Delta\gamma|$", title="cycles of 4 s: springs in CD, and MD")
    axis.legend(fontsize=7)


def _pairs(own, other, name, at=("dSigma", "packing")):
    """Return a column of the rows `own` over that of the rows `other`, by packing and load."""
    one, two = (rows.assign(dSigma=rows.dSigma.fillna(0)).set_index(list(at))[name] for rows in (own, other))
    return (one / two).dropna()


def _lives(own, other):
    """Return (packings that surely stand longer by `own`, that stand less long, ratios of the lives where both fall), by packing."""
    lives = [rows.set_index("packing") for rows in (own, other)]
    one, two = (rows["collapses after"].fillna(rows.stands) for rows in lives)
    falls = [rows["collapses after"].notna() for rows in lives]
    return int(((one > two) & falls[1]).sum()), int(((one < two) & falls[0]).sum()), (one / two)[falls[0] & falls[1]].dropna()


def quantities(table):
    of = lambda which, medium, rows=usual(table): rows[(rows.experiment == which) & (rows.medium == medium)]
    other = lambda which: table[(table.experiment == which) & (table.law != "standard")]
    stepped = lambda which: table[(table.experiment == which) & other_step(table)]
    ramp = {threshold: _pairs(of(RAMP, SPRINGS), of(RAMP, MD), over(threshold)) for threshold in THRESHOLDS}
    ramp_laws = {threshold: _pairs(other(RAMP), of(RAMP, MD), over(threshold)) for threshold in THRESHOLDS}
    before = _pairs(of(RAMP, SPRINGS), of(RAMP, MD), "|gamma| at the limit")
    below = {medium: of(LATE, medium)[lambda rows: rows["load over limit"] < 0.96] for medium in (MD, SPRINGS, RIGID)}
    first, late = (_pairs(below[SPRINGS], below[MD], name) for name in ("first cycle", "rate"))
    half_late = _pairs(stepped(LATE), of(LATE, MD), "rate")
    law_late = _pairs(other(LATE), of(LATE, MD), "rate")
    lives = {load: {medium: of(COLLAPSE, medium)[lambda rows: rows.dSigma == load] for medium in (MD, SPRINGS, RIGID)} for load in LIVES}
    same, harder = ({load: _lives(own[one], own[two]) for load, own in lives.items()} for one, two in ((SPRINGS, MD), (RIGID, SPRINGS)))
    coarse_lives = _lives(stepped(COLLAPSE)[stepped(COLLAPSE).dSigma == LIVES[0]], lives[LIVES[0]][MD])
    chance = lambda counts: stats.binomtest(counts[0], counts[0] + counts[1]).pvalue
    slow_md, slow = of(SLOW, MD), of(SLOW, SPRINGS)
    slow_ratios = {window: _pairs(slow, slow_md, _window(window)) for window in WINDOWS if window[1] <= OVERLAP}
    cost = {medium: (rows.seconds / count).median() for medium, rows, count in ((MD, slow_md, OVERLAP), (SPRINGS, slow, SLOW_COUNT))}
    return locals() | {"MD": MD, "SPRINGS": SPRINGS}
