"""How the static limit, the load at yield and the strain under cycles depend on the number of disks."""
import numpy as np
import pandas
from scipy import stats

from analysis import cycles, limits, observables, style, summary
from analysis.studies import fig3, fig5
from analysis.style import plt
from yade_scripts.tables import product

TITLE = "Are 400 disks enough?"
QUESTION = "100 to 6400 disks: static limit, yield under a ramp, and strain under cycles."
ORDER = 9  # in the report
SPRINGS, RIGID = fig5.METHODS
CYCLES = fig3.SPRINGS | dict(delta_sigma=0.4, cycles=20)
PACKINGS = {100: 10, 400: 10, 1600: 3, 6400: 1}  # how many of each number of disks
# The slowest motion of a sample takes a time that grows with its width, so ramps and cycles of more disks are slower. All ramps rise to 2.5 P0 at
# most.
RAMPS = {100: dict(ramp_rate=0.2, cycles=8), 400: dict(ramp_rate=0.1, cycles=15), 1600: dict(ramp_rate=0.05, cycles=30),
         6400: dict(ramp_rate=0.025, cycles=60, collapse_strain=0.03)}  # beyond it rigid contacts get slow
PERIODS = {100: 1.0, 400: 2.0, 1600: 4.0, 6400: 2.0}  # s; cycles of 8 s of 6400 disks would take 3.5 hours
# Some packings of 1600 disks need a shorter step (a small disk with many contacts). A wall that is as light as one disk but touches the 80 disks of a
# side would set the step of springs; with the mass of four disks it does not.
SHORTER, HEAVIER = {1600: dict(md_dt_factor=0.25)}, {6400: dict(wall_mass_ratio=4.0)}


def _of_packings(disks, *bases):
    return [row for base in bases for row in product(disks=disks, seed=range(1, PACKINGS[disks] + 1), **base | HEAVIER.get(disks, {}))]


ROWS = {"quick": [row for disks in (100, 400) for row in product(disks=disks, **fig5.RAMP | dict(ramp_rate=0.5, cycles=3), **RIGID)],
        "full": [row for disks in PACKINGS
                 for row in _of_packings(disks, fig5.RAMP | RAMPS[disks] | RIGID, fig5.RAMP | RAMPS[disks] | SPRINGS | SHORTER.get(disks, {}),
                                         CYCLES | SHORTER.get(disks, {}) | dict(period=PERIODS[disks]))]}
THRESHOLD = 1e-2  # |gamma| at which a packing counts as yielding; at the static limit springs have strained by 3e-3 to 2e-2 (study fig5)


def summarize(runs):
    """Return one row a packing: its static limit, the loads at which both methods yield, and what springs strain under cycles."""
    rows = []
    for (disks, seed), group in summary.by(runs, "disks", "seed").items():
        ramps = {run.method: run for run in group if run.parameters["loading"] == "ramp"}
        cycled = next((run for run in group if run.parameters["loading"] != "ramp"), None)
        limit = limits.static_limit(group[0])
        rows.append({"disks": disks, "seed": seed, "static limit": limit})
        for method in style.MARKER:
            load = observables.critical_load(ramps[method], THRESHOLD) if method in ramps else np.nan
            rows[-1] |= {f"yields at, {method}": load, f"yields over the limit at, {method}": load / limit}
        rows[-1] |= {"load over limit of the cycles": limits.load_over_limit(cycled) if cycled else np.nan,
                     "first cycle": abs(cycles.of(cycled).first) if cycled else np.nan,
                     "rate": abs(cycles.of(cycled).late_rate) if cycled else np.nan,
                     "unsolved steps": observables.unconverged_steps(ramps["CD"]) if "CD" in ramps else ""}
    return rows


def draw(runs, rows, path):
    """Draw a point a packing against the number of disks: static limit; loads at yield over it; strain a cycle."""
    table = pandas.DataFrame(rows)
    panels = ((r"static limit, $\sigma_2/P_0$", "linear", (("static limit", "k", "D", None),)),
              (r"load at $|\gamma| = 10^{-2}$ over the static limit", "linear",
               [(f"yields over the limit at, {method}", style.COLOUR[method], style.MARKER[method], words)
                for method, words in style.WORDS.items()]),
              (r"$|\Delta\gamma|$ a cycle of springs, $\Delta\sigma = 0.4$", "log",
               (("first cycle", style.SKY, "^", "first cycle"), ("rate", style.COLOUR["MD"], "o", "a cycle of the last ten"))))
    panels = [panel for panel in panels if table[[name for name, *_ in panel[2]]].notna().any(axis=None)]
    fig, axes = plt.subplots(1, len(panels), figsize=(3.5 * len(panels), 3.7), squeeze=False)
    for axis, (words, scale, several) in zip(axes[0], panels):
        for shift, (name, colour, marker, label) in zip((0.96, 1.04), several):
            if table[name].notna().any():
                axis.plot(shift * table.disks, table[name], ls="", marker=marker, ms=4.5, mfc="none", color=colour, label=label)
            for size, median in table.groupby("disks")[name].median().dropna().items():
                axis.plot([size / 1.25, size * 1.25], [median] * 2, color=colour, lw=1)
        axis.set(xscale="log", yscale=scale, xlabel="disks", ylabel=words)
        sizes = sorted(table.disks.unique())
        axis.set_xticks(sizes, list(map(str, sizes)), minor=False)
        axis.minorticks_off()
        if len(several) > 1:
            axis.legend()
    style.finish(fig, path, "Each point is a packing. Short lines: medians.", runs)


def quantities(table):
    sizes = dict(list(table.groupby("disks")))
    md, cd = (f"yields over the limit at, {method}" for method in style.MARKER)
    ratio = (table[cd] / table[md]).groupby(table.disks).median()
    late = {disks: part["rate"].abs().dropna() for disks, part in sizes.items()}
    chance = stats.mannwhitneyu(late[100], late[400]).pvalue
    return locals() | {"limit": {disks: part["static limit"] for disks, part in sizes.items()}}
