"""What the paper leaves open: each parameter varied alone around a base, and the search for the paper's three regimes."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullFormatter, ScalarFormatter

from analysis import cycles, style
from analysis import summary
from yade_scripts.results.reader import ResultError
from yade_scripts.tables import product

TITLE = "What the paper leaves open, and where its regimes lie"
QUESTION = ("How much do k_t/k_n, damping, size distribution, wall friction and mass, period and time step - none given in the paper - change the "
            "strain; and is there a preparation for which loads of 0.40 and 0.50 collapse while lower ones ratchet and shake down, as in the "
            "paper's Fig. 3?")
ORDER = 4  # in the report
BASE = dict(method="MD", loading="cosine", period=0.5, records_per_cycle=20, cycles=30, md_dt_factor=0.3, delta_sigma=0.4)
PHYSICAL = ({}, dict(kt_over_kn=0.1), dict(kt_over_kn=0.25), dict(kt_over_kn=1.0), dict(beta_n=0.02), dict(beta_n=0.4), dict(radius_spread=0.1),
            dict(radius_spread=0.5), dict(wall_friction=0.1), *(dict(md_walls="force", wall_mass_ratio=mass) for mass in (1.0, 20.0, 200.0)))
NUMERICAL = (dict(period=0.25), dict(period=1.0), dict(period=2.0), dict(md_dt_factor=0.1), dict(md_dt_factor=0.2))
# The search at constant sigma1: dense and loose packings under five loads, by both methods. Loose ones settle fast, so that 30 cycles do but for the
# first; CD rests after few cycles.
LOADS, SEEDS = (0.1, 0.2, 0.3, 0.4, 0.5), range(1, 6)
LOADING = dict(loading="cosine", period=0.5, records_per_cycle=20)
SPRINGS = dict(method="MD", md_dt_factor=0.3, **LOADING)
REGIMES = product(cycles=100, preparation_friction=0.0, seed=SEEDS, delta_sigma=LOADS, **SPRINGS) \
    + product(cycles=100, preparation_friction=0.1, seed=1, delta_sigma=LOADS, **SPRINGS) \
    + product(cycles=30, preparation_friction=0.1, seed=SEEDS[1:], delta_sigma=LOADS, **SPRINGS) \
    + product(method="CD", cycles=20, cd_dt=2.5e-3, tolerance=1e-7, wall_mass_ratio=1.0, preparation_friction=(0.0, 0.1), seed=SEEDS, delta_sigma=LOADS, **LOADING)
ROWS = {"quick": [BASE | {"cycles": 10} | change for change in ({}, dict(kt_over_kn=0.1), dict(preparation_friction=0.05))],
        "full": [BASE | change | {"seed": seed} for seed in (1, 2) for change in PHYSICAL] + [BASE | change for change in NUMERICAL]
        + product(**BASE | dict(preparation_friction=(0.02, 0.05, 0.2, 0.4), seed=(1, 2), delta_sigma=LOADS)) + REGIMES}
# The axes of the search; a run that differs from the base in nothing else belongs to it.
SEARCH = ("preparation_friction", "delta_sigma")
# A comparison after fewer cycles than the base has is one of the first cycles: those are the same in a longer run.
NOT_COMPARED = ("seed", "cycles", *SEARCH)
# Read by the other method or of no effect on motion.
IGNORED = ("cd_dt", "tolerance", "collapse_strain", "md_load_every")
# The paper's Fig. 3 with the words of its section 3: which regime at which load; of 0.1 to 0.3 it says only that low loads shake down
# and intermediate ones ratchet.
PAPER = {0.4: cycles.COLLAPSE, 0.5: cycles.COLLAPSE}


def summarize(runs):
    """Return one row for each value of a parameter, over the packings; then one for each point of the search."""
    runs = [run for run in runs if run.method == "MD"]
    base = _base(runs)
    rows = []
    for (name, value), same in _variations(runs, base).items():
        rows.append({"kind": "variation", "parameter": name, "value": value} | _numbers(same, _partners(same, runs, base)))
    for (friction, load), same in _search(runs, base).items():
        rows.append({"kind": "search", "parameter": "preparation_friction", "value": friction, "dSigma": load} | _numbers(same, {}))
    return rows


def _base(runs):
    """Return for each parameter the value that most runs have; runs made before a parameter existed do not have it."""
    names = [name for name in runs[0].parameters if name not in IGNORED and all(name in run.parameters for run in runs)]
    return {name: summary.commonest(run.parameters[name] for run in runs) for name in names}


def _differences(run, base, ignore=()):
    return [name for name, value in base.items() if run.parameters[name] != value and name not in ignore]


def _variations(runs, base):
    """Return {(parameter, value): runs}: what differs from the base in one parameter, at the load of those that vary something physical."""
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
    """Return what a run varies; walls pushed by forces count as one variation with their mass, which only they read."""
    names = _differences(run, base, NOT_COMPARED)
    return ["wall_mass_ratio"] if set(names) == {"md_walls", "wall_mass_ratio"} else names


def _value(run, name):
    return run.parameters[name]


def _search_point(run):
    return tuple(run.parameters[name] for name in SEARCH)


def _anchor(runs, varied):
    """Return the point of the search around which parameters are varied."""
    return summary.commonest(_search_point(run) for run in varied or runs)


def _partners(same, runs, base):
    """Return {seed: run} of the base at the same point of the search, the longest of each packing."""
    bases = [run for run in runs if not _physical(run, base) and _search_point(run) == _search_point(same[0])]
    return {run.parameters["seed"]: run for run in sorted(bases, key=lambda run: run.parameters["cycles"])}


def _search(runs, base):
    """Return {(preparation friction, dSigma): runs}, of each packing the longest."""
    points = {}
    for run in sorted(runs, key=lambda run: run.parameters["cycles"]):
        if not _physical(run, base):
            points.setdefault(_search_point(run), {})[run.parameters["seed"]] = run
    return {point: list(seeds.values()) for point, seeds in sorted(points.items())}


def _numbers(runs, partners):
    """Return the medians over the packings; strains after the cycles that all of the runs and their partners have."""
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
    """Return |gamma| after `count` cycles; of a run that collapsed before, what it had strained then."""
    return float(abs(cycles.of(run).permanent[count - 1] if 0 < count <= _completed(run) else run.values("gamma")[-1]))


def _median(values):
    values = summary.finite(values)
    return float(np.median(values)) if len(values) else float("nan")


def draw(runs, rows, path):
    """Draw the ratio of strain to the base, value by value, on the left; on the right the regimes over preparation and load."""
    fig, (left, right) = plt.subplots(1, 2, figsize=(12, 6.6), gridspec_kw=dict(width_ratios=(1.15, 1)))
    _ratios(left, [row for row in rows if row["kind"] == "variation"])
    _map(right, [row for row in rows if row["kind"] == "search"])
    style.finish(fig, path, "Left: median and range over the packings. Right: a cell a point of the "
                 "search; each packing counts once; outlined: loads at which the paper's sample collapsed", [run for run in runs if run.method == "MD"])


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
    """Draw cells divided by the share of packings in each regime."""
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


ANSWER = """
With sigma1 held at P0 the parameters that the paper leaves open change the strain on single packings by factors up to 4.6, no more than packings differ
among themselves; the stress path (study of Fig. 3) and the preparation change it more. Varied alone at dSigma = 0.4 on 2 packings each, |gamma| after
30 cycles changes the same way on both for wall_friction = 0.1 (0.31 to 0.47 times), walls of 200 disk masses (1.78 to 1.88) and radius_spread = 0.1
(0.48 to 0.73); it goes either way for beta_n = 0.4 (0.69 to 4.58), beta_n = 0.02 (0.56 to 2.55) and radius_spread = 0.5 (0.24 to 1.23). Of 90 runs with
six preparations and five loads 52 shake down and 38 ratchet by a rule on their rates; none collapses, unlike in the paper's Fig. 3.
"""
GIVEN = ("0.4", "0.1", "200", "0.02", "0.5")
POINTS = ()


def numbers(table):
    """Return the numbers of the text, from the summary table."""
    variation, search = (table[table.kind == kind] for kind in ("variation", "search"))
    low, high = ({(row.parameter, str(row.value)): row[name] for _, row in variation.iterrows()} for name in ("least ratio", "largest ratio"))
    ends = {"0.31": low["wall_friction", "0.1"], "0.47": high["wall_friction", "0.1"], "1.78": low["wall_mass_ratio", "200.0"], "1.88": high["wall_mass_ratio", "200.0"],
            "0.48": low["radius_spread", "0.1"], "0.73": high["radius_spread", "0.1"], "0.69": low["beta_n", "0.4"], "4.58": high["beta_n", "0.4"],
            "0.56": low["beta_n", "0.02"], "2.55": high["beta_n", "0.02"], "0.24": low["radius_spread", "0.5"], "1.23": high["radius_spread", "0.5"]}
    return ends | {"4.6": max(max(high.values()), 1 / min(value for value in low.values() if value > 0)), "2": variation[variation.parameter == "beta_n"].packings.max(),
                   "30": variation[variation.parameter != "base"].cycles.unique()[0], "90": search.packings.sum(), "52": search.shakedown.sum(),
                   "38": search.ratcheting.sum()}
