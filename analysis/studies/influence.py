"""What the paper leaves open: each parameter varied alone around a base, and the search for the paper's three regimes."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullFormatter, ScalarFormatter

from analysis import cycles, style
from analysis.load import ResultError
from analysis.studies import summary

TITLE = "What the paper leaves open, and where its regimes lie"
QUESTION = ("How much do k_t/k_n, damping, size distribution, wall friction and mass, period and time step - none given in the paper - change the "
            "strain; and is there a preparation for which loads of 0.40 and 0.50 collapse while lower ones ratchet and shake down, as in the "
            "paper's Fig. 3?")
TABLES = {"quick": ("quick/influence.txt",), "full": ("influence.txt", "regions.txt", "fig3.txt")}
# The axes of the search; a run that differs from the base in nothing else belongs to it.
SEARCH = ("preparation_friction", "delta_sigma")
# A comparison after fewer cycles than the base has is one of the first cycles: those are the same in a longer run.
NOT_COMPARED = ("seed", "cycles", *SEARCH)
# Read by the other method or of no effect on motion.
IGNORED = ("cd_dt", "tolerance", "collapse_strain", "md_load_every")
# The paper's Fig. 3 with the words of its section 3: which regime at which load; of 0.1 to 0.3 it says only that low loads shake down
# and intermediate ones ratchet.
PAPER = {0.4: cycles.COLLAPSE, 0.5: cycles.COLLAPSE}
# Variations that the answer names; the table has all.
SHOWN = 5


def summarize(runs):
    """One row for each value of a parameter, over the packings; then one for each point of the search."""
    runs = [run for run in runs if run.method == "MD"]
    base = _base(runs)
    rows = []
    for (name, value), same in _variations(runs, base).items():
        rows.append({"kind": "variation", "parameter": name, "value": value} | _numbers(same, _partners(same, runs, base)))
    for (friction, load), same in _search(runs, base).items():
        rows.append({"kind": "search", "parameter": "preparation_friction", "value": friction, "dSigma": load} | _numbers(same, {}))
    return rows


def _base(runs):
    """Of each parameter the value that most runs have; runs made before a parameter existed do not have it."""
    names = [name for name in runs[0].parameters if name not in IGNORED and all(name in run.parameters for run in runs)]
    return {name: summary.commonest(run.parameters[name] for run in runs) for name in names}


def _differences(run, base, ignore=()):
    return [name for name, value in base.items() if run.parameters[name] != value and name not in ignore]


def _variations(runs, base):
    """{(parameter, value): runs}: what differs from the base in one parameter, at the load of those that vary something physical."""
    varied = [run for run in runs if len(_physical(run, base)) == 1]
    anchor = _anchor(runs, varied)
    found = {}
    for run in runs:
        names = _physical(run, base)
        if _search_point(run) != anchor or len(names) > 1:
            continue
        key = (names[0], _value(run, names[0])) if names else ("base", "")
        found.setdefault(key, []).append(run)
    return dict(sorted(found.items(), key=lambda item: (item[0][0] != "base", item[0][0], str(type(item[0][1])), item[0][1])))


def _physical(run, base):
    """What a run varies; walls pushed by forces count as one variation with their mass, which only they read."""
    names = _differences(run, base, NOT_COMPARED)
    return ["wall_mass_ratio"] if set(names) == {"md_walls", "wall_mass_ratio"} else names


def _value(run, name):
    return run.parameters[name]


def _search_point(run):
    return tuple(run.parameters[name] for name in SEARCH)


def _anchor(runs, varied):
    """The point of the search around which parameters are varied."""
    return summary.commonest(_search_point(run) for run in varied or runs)


def _partners(same, runs, base):
    """{seed: run} of the base at the same point of the search, the longest of each packing."""
    bases = [run for run in runs if not _physical(run, base) and _search_point(run) == _search_point(same[0])]
    return {run.parameters["seed"]: run for run in sorted(bases, key=lambda run: run.parameters["cycles"])}


def _search(runs, base):
    """{(preparation friction, dSigma): runs}, of each packing the longest."""
    points = {}
    for run in sorted(runs, key=lambda run: run.parameters["cycles"]):
        if not _physical(run, base):
            points.setdefault(_search_point(run), {})[run.parameters["seed"]] = run
    return {point: list(seeds.values()) for point, seeds in sorted(points.items())}


def _numbers(runs, partners):
    """Medians over the packings; strains after the cycles that all of the runs and their partners have."""
    longest = {run.parameters["seed"]: run for run in sorted(runs, key=lambda run: run.parameters["cycles"])}
    runs = list(longest.values())
    regimes = [cycles.regime(run).name for run in runs]
    compared = runs + [partners[seed] for seed in longest if seed in partners]
    count = min([_completed(run) for run in compared if not run.collapsed] or [_completed(run) for run in compared])
    ratios = [_strain(run, count) / _strain(partners[seed], count) for seed, run in longest.items() if seed in partners and count]
    return {"packings": len(runs), "cycles": count, "|gamma| after them": _median(_strain(run, count) for run in runs),
            "least": min(_strain(run, count) for run in runs), "most": max(_strain(run, count) for run in runs),
            "ratio to the base": _median(ratios), "least ratio": min(ratios, default=float("nan")), "largest ratio": max(ratios, default=float("nan")),
            "late rate": _median(abs(cycles.regime(run).late_rate) for run in runs),
            **{name: regimes.count(name) for name in (cycles.SHAKEDOWN, cycles.RATCHETING, cycles.COLLAPSE, cycles.SHORT)}}


def _completed(run):
    try:
        return len(cycles.of(run).number)
    except ResultError:
        return 0


def _strain(run, count):
    """|gamma| after `count` cycles; of a run that collapsed before, what it had strained then."""
    return float(abs(cycles.of(run).permanent[count - 1] if 0 < count <= _completed(run) else run.values("gamma")[-1]))


def _median(values):
    values = summary.finite(values)
    return float(np.median(values)) if len(values) else float("nan")


def draw(runs, rows, path):
    """Left: the ratio of strain to the base, value by value; right: the regimes over preparation and load."""
    fig, (left, right) = plt.subplots(1, 2, figsize=(12, 6.6), gridspec_kw=dict(width_ratios=(1.15, 1)))
    _ratios(left, [row for row in rows if row["kind"] == "variation"])
    _map(right, [row for row in rows if row["kind"] == "search"])
    fig.subplots_adjust(left=0.17, right=0.985, top=0.9, bottom=0.25, wspace=0.2)
    style.finish(fig, [run for run in runs if run.method == "MD"], path, "Left: median and range over the packings. Right: a cell a point of the "
                 "search; each packing counts once; outlined: loads at which the paper's sample collapsed")


def _ratios(axis, rows):
    labels = []
    for place, row in enumerate(rows):
        middle, low, high = (row[name] for name in ("ratio to the base", "least ratio", "largest ratio"))
        axis.plot([low, high], [place, place], color=style.COLOUR["MD"], linewidth=2, alpha=0.5)
        axis.plot(middle, place, "o", color=style.COLOUR["MD"], markersize=5)
        value = row["value"] if isinstance(row["value"], str) else f"{row['value']:g}"
        labels.append(row["parameter"] + (f" = {value}" if value else ""))
    axis.axvline(1, color="#444444", linewidth=0.8, linestyle="--")
    axis.set_yticks(range(len(labels)), labels)
    axis.invert_yaxis()
    axis.set(xscale="log", xlabel=r"$|\gamma|$ over that of the base, after the same cycles", title="One parameter at a time")
    axis.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axis.xaxis.set_major_formatter(ScalarFormatter())
    axis.xaxis.set_minor_formatter(NullFormatter())
    axis.grid(color="#DDDDDD", linewidth=0.5)


_REGIME_COLOUR = {cycles.SHAKEDOWN: "#56B4E9", cycles.RATCHETING: "#F0E442", cycles.COLLAPSE: "#D55E00", cycles.SHORT: "#CCCCCC"}


def _map(axis, rows):
    """Cells divided by the share of packings in each regime."""
    frictions, loads = sorted({row["value"] for row in rows}), sorted({row["dSigma"] for row in rows})
    for row in rows:
        left, bottom = frictions.index(row["value"]), loads.index(row["dSigma"])
        start, total = left - 0.45, sum(row[name] for name in _REGIME_COLOUR)
        for name, colour in _REGIME_COLOUR.items():
            width = 0.9 * row[name] / total
            if width:
                axis.bar(start, 0.9, width, bottom=bottom - 0.45, align="edge", color=colour, edgecolor="white", linewidth=0.5)
                axis.text(start + width / 2, bottom, f"{name[0].upper()}{row[name]}", ha="center", va="center", fontsize=8 if width > 0.2 else 6,
                          rotation=0 if width > 0.2 else 90)
            start += width
        if row["dSigma"] in PAPER:
            axis.bar(left, 0.96, 0.96, bottom=bottom - 0.48, fill=False, edgecolor="#1A1A1A", linewidth=0.9)
    axis.set_xticks(range(len(frictions)), [f"{value:g}" for value in frictions])
    axis.set_yticks(range(len(loads)), [f"{value:g}" for value in loads])
    axis.set(xlabel=r"$\mu$ while the packing is prepared", ylabel=r"$\Delta\sigma$", title="Search: regimes by preparation and load")
    handles = [Line2D([], [], marker="s", linestyle="none", color=colour, label=f"{name[0].upper()}: {name}") for name, colour in _REGIME_COLOUR.items()
               if any(row[name] for row in rows)]
    axis.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.09), ncol=4)
    axis.spines[:].set_visible(False)


def answer(rows):
    """Which parameter matters most, and whether the paper's regimes were found."""
    return f"{strongest(rows)} {_extent(_of(rows, 'search'))} {verdict(rows)}"


def _of(rows, kind):
    return [row for row in rows if row["kind"] == kind and row["parameter"] != "base"]


def strongest(rows, shown=SHOWN):
    """The `shown` parameters that matter most, in a sentence."""
    rows = _of(rows, "variation")
    ranked = sorted((row for row in rows if row["ratio to the base"] > 0), key=lambda row: -_factor(row))
    if not ranked:
        return "No parameter has been varied yet."
    words = [f"{row['parameter']} = {row['value']} by a factor of {summary.number(row['ratio to the base'])} "
             f"({summary.number(row['least ratio'])} to {summary.number(row['largest ratio'])}, {summary.count(row['packings'], 'packing')})"
             for row in ranked[:shown]]
    rest = f"; all others by less than a factor of {summary.number(_factor(ranked[shown]))}" if len(ranked) > shown else ""
    cycles_compared = summary.between(row["cycles"] for row in ranked)
    return f"Varied alone, these change |gamma| after {cycles_compared} cycles most: {'; '.join(words)}{rest}."


def _factor(row):
    """By how much the strain changes, up or down, as a factor above 1."""
    return float(np.exp(abs(np.log(row["ratio to the base"]))))


def _extent(rows):
    """How far the search went and what it met."""
    frictions, loads = (", ".join(f"{value:g}" for value in sorted({row[name] for row in rows})) for name in ("value", "dSigma"))
    counts = [f"{name} in {sum(row[name] for row in rows)}" for name in _REGIME_COLOUR if any(row[name] for row in rows)]
    return (f"The search covered preparation friction {frictions} and dSigma {loads}, {summary.between(row['packings'] for row in rows)} packings and "
            f"{summary.between(row['cycles'] for row in rows)} cycles a point. Of {sum(row['packings'] for row in rows)} runs: {', '.join(counts)}.")


def verdict(rows):
    """Whether a preparation was found that gives the paper's regimes, in a sentence."""
    by = {(row["value"], row["dSigma"]): row for row in _of(rows, "search")}
    frictions, loads = (sorted(set(values)) for values in zip(*by))

    def share(friction, load, name):
        row = by.get((friction, load))
        return row[name] / row["packings"] if row else 0.0

    def matches(friction):
        return all(share(friction, load, name) > 0.5 for load, name in PAPER.items()) and all(
            any(share(friction, load, name) > 0.5 for load in loads) for name in (cycles.RATCHETING, cycles.SHAKEDOWN))

    matching = [friction for friction in frictions if matches(friction)]
    if matching:
        return f"The paper's regimes appear, by the majority of packings, at preparation friction {', '.join(f'{value:g}' for value in matching)}."
    order = [friction for friction in frictions if any(share(friction, low, cycles.SHAKEDOWN) > 0.5 and share(friction, high, cycles.RATCHETING) > 0.5
                                                       for low in loads for high in loads if low < high)]
    below = f" Without it, shakedown below ratcheting appears at {', '.join(f'{value:g}' for value in order)}." if order else ""
    best, friction, load = max((share(*point, cycles.COLLAPSE), *point) for point in by)
    return ("No preparation was found for which loads of 0.40 and 0.50 collapse while lower ones ratchet and shake down in the majority of packings; "
            + (f"collapse is most frequent at preparation friction {friction:g} and dSigma {load:g} ({100 * best:.0f} % of the packings)." if best
               else "no run collapsed.") + below)
