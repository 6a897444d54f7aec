"""Fig. 3: strain rate per cycle against accumulated strain, and with it what slides, dissipates and touches, for MD and CD."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D

from analysis import cycles, observables, style
from analysis.load import ResultError
from analysis.studies import summary

TITLE = "Fig. 3: strain per cycle under repeated loading"
QUESTION = ("Which loads shake down, which ratchet at a constant rate and which collapse, in MD as the paper reports and in CD, of which the paper "
            "reports no cycles; and do the sliding contacts vanish, return in every cycle or grow with it?")
TABLES = {"quick": ("quick/fig3.txt",), "full": ("fig3.txt",)}
# Cycles after which runs of both methods are compared: as many as the shorter ones have.
COMPARED = 20


def summarize(runs):
    """One row a run: regime, rates, sliding contacts, dissipation, contacts."""
    return [_row(run) for run in sorted(runs, key=_order)]


def _order(run):
    row = run.parameters
    return (*_group(run), row["delta_sigma"], row["seed"])


def _group(run):
    """Runs of one panel: MD before CD, then by the friction during the preparation."""
    return run.method != "MD", run.parameters["preparation_friction"]


def _row(run):
    found, regime = _cycles(run), cycles.regime(run)
    row = {"method": run.method, "preparation friction": run.parameters["preparation_friction"], "dSigma": run.parameters["delta_sigma"],
           "seed": run.parameters["seed"], "cycles": len(found.number) if found else 0, "regime": regime.name,
           "gamma at the end": float(run.values("gamma")[-1]), "late rate": float(regime.late_rate), "decay p": float(regime.decay),
           "noise of the rate": float(regime.noise), "other verdicts": " or ".join(cycles.other_verdicts(run)),
           "last quarter's rate over the one before": cycles.last_quarter(run), f"regime after {COMPARED}": cycles.regime(run, most=COMPARED).name,
           f"rate after {COMPARED}": float(cycles.regime(run, most=COMPARED).late_rate),
           "unsolved steps": observables.unconverged_steps(run) if run.method == "CD" else ""}
    if found:
        row |= {"first cycle": float(found.rate[0]), "sliding at most, first cycle": float(found.sliding_max[0]),
                "sliding at most, last cycle": float(found.sliding_max[-1]), "sliding at least, last cycle": float(_last_cycle(run, 1).min()),
                "sliding, change of a cycle": _sliding_change(run), "dissipated/P0V0, first cycle": float(found.dissipated[0]),
                "dissipated/P0V0, last cycle": float(found.dissipated[-1]), "2M/N at the end": float(found.contacts[-1])}
    return row | {"coordination at the end": float(observables.coordination(run.snapshots[-1])),
                  "balance error": float(observables.balance_error(run)), "stress error/P0": float(observables.stress_error(run)),
                  "outcome": run.outcome}


def _cycles(run):
    """The run's Cycles; None if it collapsed in the first."""
    try:
        return cycles.of(run)
    except ResultError:
        return None


def _first_cycle(run):
    """Sliding share through the first cycle."""
    first, last = cycles.ends(run)[:2]
    return cycles.sliding_share(run)[first:last + 1]


def _last_cycle(run, back):
    """Sliding share through the last completed cycle, or the one `back` - 1 before it."""
    at = cycles.ends(run)
    return cycles.sliding_share(run)[at[-1 - back]:at[-back] + 1]


def _sliding_change(run):
    """How much the sliding share differs between the last two cycles: rms over its mean; NaN where there are no two."""
    if len(cycles.ends(run)) < 3:
        return float("nan")
    last, before = _last_cycle(run, 1), _last_cycle(run, 2)
    return float(np.sqrt(np.mean((last - before)**2)) / last.mean()) if len(last) == len(before) and last.mean() else float("nan")


def draw(runs, rows, path):
    """A column for each method and preparation, a colour and marker for each load: medians over the packings bold, packings thin."""
    groups = summary.groups(runs, _group)
    look = style.shades(run.parameters["delta_sigma"] for run in runs)
    fig, axes = plt.subplots(5, len(groups), figsize=(1.2 + 3.9 * len(groups), 15), squeeze=False, sharey="row")
    _dress(axes)
    for column, ((rigid, friction), own) in enumerate(groups.items()):
        axes[0, column].set_title(f"{'CD' if rigid else 'MD'}, prepared with $\\mu$ = {friction:g}")
        for load, same in summary.groups(own, lambda run: run.parameters["delta_sigma"]).items():
            _curves(axes[:, column], same, *look[load])
    handles = [Line2D([], [], color=colour, marker=marker, markersize=4, label=rf"$\Delta\sigma$ = {load:g}")
               for load, (colour, marker) in look.items()]
    handles.append(Line2D([], [], color="#444444", marker="x", linestyle="none", label="collapsed"))
    fig.legend(handles=handles, loc="upper center", ncol=len(handles), bbox_to_anchor=(0.5, 0.995))
    fig.subplots_adjust(left=0.09 if len(groups) > 2 else 0.11, right=0.985, top=0.955, bottom=0.1, hspace=0.3, wspace=0.08)
    style.finish(fig, runs, path, "Bold: median over the packings, thin: each packing. Rates are means over windows that grow with the cycle's number.\nWhat CD "
                 "strains in packings that rest is its solver's tolerance (see that study)")


def _curves(axes, runs, colour, marker):
    thin, bold = dict(color=colour, linewidth=0.5, alpha=0.5), dict(color=colour, linewidth=1.7, marker=marker, markersize=3.5)
    several, strains = [], []
    for run in runs:
        found = _cycles(run)
        if run.collapsed:
            end = run.values("gamma")[-1]
            axes[0].plot(abs(end), abs(end - found.permanent[-1] if found else end), "x", color=colour, markersize=6)
        if found is None:
            continue
        windows = cycles.windows(len(found.number))
        strains.append(np.stack([np.abs(found.permanent[[last - 1 for _, last in windows]]), np.abs(found.rates(windows))]))
        several.append(found)
        axes[0].plot(*strains[-1], **thin)
        axes[1].plot(found.number, found.sliding_max, **thin)
        axes[3].plot(found.number, _positive(found.dissipated), **thin)
        axes[4].plot(found.number, found.contacts, **thin)
    if not several:
        return
    # Medians over packings cycle by cycle, as far as all of them go.
    count = min(len(found.number) for found in several)
    shortest = min(strain.shape[1] for strain in strains)
    axes[0].plot(*np.median([strain[:, :shortest] for strain in strains], axis=0), **bold)
    every = dict(markevery=max(1, count // 8))
    for axis, name in ((axes[1], "sliding_max"), (axes[3], "dissipated"), (axes[4], "contacts")):
        median = np.median([getattr(found, name)[:count] for found in several], axis=0)
        axis.plot(np.arange(1, count + 1), _positive(median) if name == "dissipated" else median, **bold, **every)
    _through_the_cycle(axes[2], [run for run in runs if _cycles(run)], bold)


def _positive(values):
    """NaN where a logarithmic axis has no place: CD below yield dissipates within its tolerance of nothing, on either side."""
    return np.where(values > 0, values, np.nan)


def _through_the_cycle(axis, runs, bold):
    """Medians of the sliding share through the first and the last cycle, of runs sampled alike."""
    for share_of, line in ((_first_cycle, ":"), (lambda run: _last_cycle(run, 1), "-")):
        shares = [share_of(run) for run in runs]
        shares = [share for share in shares if len(share) == len(shares[0])]
        look = bold | dict(linestyle=line, linewidth=1.2, marker=None)
        axis.plot(np.linspace(0, 1, len(shares[0])), np.median(shares, axis=0), **look)


def _dress(axes):
    labels = (("accumulated strain $|\\gamma|$ at the end of a cycle", "strain rate $|\\Delta\\gamma|$ a cycle"),
              ("cycle", "most sliding contacts / contacts"), ("time in the cycle / $t_0$", "sliding contacts / contacts\n(first cycle dotted, last solid)"),
              ("cycle", "dissipated in a cycle / $P_0V_0$"), ("cycle", "contacts $2M/N$ at the end of a cycle"))
    for row, (x, y) in zip(axes, labels):
        row[0].set_ylabel(y)
        for axis in row:
            axis.set_xlabel(x)
            axis.grid(color="#DDDDDD", linewidth=0.5)
            if x == "cycle":
                axis.set_xscale("log")
    for axis in axes[0]:
        axis.set(xscale="log", yscale="log")
    for axis in axes[3]:
        axis.set_yscale("log")


def answer(rows):
    """The regimes by method, preparation and load, with rates and sliding contacts."""
    parts = []
    for (method, friction), own in _by(rows, "method", "preparation friction"):
        loads = [f"{load:g} {_regimes(same)}" for (load,), same in _by(own, "dSigma")]
        parts.append(f"{method}, prepared with mu = {friction:g}: dSigma {', '.join(loads)}; {_rates(own)}. {_sliding(own)}")
    return "\n".join([*parts, paired(rows), _limits(rows)])


def paired(rows):
    """What the two methods make of the same packing under the same load, after the same cycles."""
    name = f"regime after {COMPARED}"
    pairs = summary.pairs(rows, ("preparation friction", "dSigma", "seed"))
    if not pairs:
        return "No packing has been run by both methods yet."
    count = {}
    for md, cd in pairs:
        count[md[name], cd[name]] = count.get((md[name], cd[name]), 0) + 1
    words = ", ".join(f"{md} in MD and {cd} in CD {number}" for (md, cd), number in sorted(count.items(), key=lambda item: -item[1]))
    return (f"The same packing under the same load, after {COMPARED} cycles ({summary.count(len(pairs), 'pair')}): {words}.")


def _by(rows, *names):
    groups = summary.groups(rows, lambda row: tuple(row[name] for name in names))
    return sorted(groups.items(), key=lambda item: [value if not isinstance(value, str) else -ord(value[0]) for value in item[0]])


def _regimes(rows):
    names = summary.groups(rows, lambda row: row["regime"])
    return " and ".join(f"{name} ({len(same)} of {len(rows)})" if len(names) > 1 or len(rows) > 1 else name for name, same in names.items())


def _rates(rows):
    """Late rates of the smallest and the largest load."""
    loads = [load for (load,), same in _by(rows, "dSigma") if len(summary.finite(row["late rate"] for row in same))]
    if not loads:
        return "too few cycles for a late rate"
    shown = dict.fromkeys((loads[0], loads[-1]))
    return "late |rate| a cycle " + ", ".join(
        f"{summary.spread(abs(row['late rate']) for row in rows if row['dSigma'] == load)} at {load:g}" for load in shown)


def _sliding(rows):
    ends = [row for row in rows if "sliding at most, last cycle" in row]
    if not ends:
        return "No cycle was completed."
    return (f"At most {summary.spread(100 * row['sliding at most, last cycle'] for row in ends)} % of the contacts slide in the last cycle "
            f"(first cycle: {summary.spread(100 * row['sliding at most, first cycle'] for row in ends)} %), at least "
            f"{summary.spread(100 * row['sliding at least, last cycle'] for row in ends)} %; from the last cycle but one this differs by "
            f"{summary.spread(100 * row['sliding, change of a cycle'] for row in ends)} % (rms).")


def _limits(rows):
    most = {method: max(row["cycles"] for row in same) for (method,), same in _by(rows, "method")}
    seeds = len({row["seed"] for row in rows})
    firm = sum(not row["other verdicts"] for row in rows)
    longer = [row for row in rows if row["cycles"] > COMPARED]
    kept = sum(row["regime"] == row[f"regime after {COMPARED}"] for row in longer)
    unsolved = [row["unsolved steps"] for row in rows if row["method"] == "CD" and row["unsolved steps"]]
    missed = (f" {len(unsolved)} CD runs have steps that missed the tolerance, at most {max(unsolved)}: those that move." if unsolved else "")
    return (f"Evidence: {summary.count(seeds, 'packing')} of each preparation, at most "
            + " and ".join(f"{number} cycles of {method}" for method, number in most.items())
            + f"; 'too short' is a run of fewer than {cycles.FEWEST_FOR_DECAY} cycles that still strains, and a rate that falls faster than 1/n over the last "
            f"octaves counts as shakedown, which more cycles could overturn: of {len(longer)} longer runs {kept} were judged the same after {COMPARED} cycles. "
            "The limits between the regimes were set with trial runs in view; "
            f"{firm} of {len(rows)} verdicts stay when any one of them is moved (by factors of 3 and 0.3 and the like, see the definitions; column 'other "
            f"verdicts').{missed} The walls are a servo without mass in MD and pushed by forces in CD (table influence: md_walls).")
