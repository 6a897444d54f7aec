"""How the static limit, the load at yield and the strain under cycles depend on the number of disks."""
import numpy as np
import pandas

from analysis import cycles, limits, observables, style, summary
from analysis.studies import fig3, fig5
from analysis.style import plt
from yade_scripts.tables import product

TITLE = "How many disks does it take?"
QUESTION = ("The paper's sample has 400 disks. Do the static limit of the packings, the load at which rigid contacts and springs yield, "
            "and the strain a cycle of springs change with the number of disks, and how far do packings of one size differ?")
ORDER = 12  # in the report
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
               (("first cycle", "#56B4E9", "^", "first cycle"), ("rate", style.COLOUR["MD"], "o", "a cycle of the last ten"))))
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
    style.finish(fig, path, "A point a packing, a line the median of a size.", runs)


ANSWER = """
The number of disks changes neither the static limit nor the load at yield by more than packings of one size differ among each other. The static limit
is 1.58 P0 (median of 10 packings of 100 disks; 1.42 to 1.79), 1.49 P0 (10 of 400; 1.41 to 1.74), 1.58 P0 (3 of 1600; 1.55 to 1.58) and 1.51 P0 (1 of
6400). Under a ramp rigid contacts pass |gamma| = 1e-2 at 1.01 to 1.21 times the limit with 100 disks, at 1.01 to 1.11 with 400, at 1.04 to 1.11 with
1600 and at 1.09 with 6400; springs at 0.93 to 1.14, 0.99 to 1.05, 1.01 to 1.06 and 1.06. With springs packings of 400 disks scatter less than those
of 100 (standard deviations 0.024 and 0.081); with rigid contacts (0.039 and 0.075) this may be chance, and the packings of 1600 and 6400 are too few
to show whether it goes on. Rigid contacts yield at the higher load on 22 of 24 packings, with 100, 400, 1600 and 6400 disks at 1.05, 1.05, 1.04 and
1.03 times that of springs (medians): this difference does not vanish in larger samples. Stiffer springs nearly remove it (study "Fig. 5: the ramp, up
to collapse").

The strain of springs under cycles grows with the load over the limit (rank correlation 0.66 over the 24 packings), and from packing to packing it
differs by a factor of ten and more: below 0.9 of the limit a late cycle strains 5 packings of 100 disks by 4.0e-8 to 3.1e-6, 3 of 400 by 2.9e-6 to
7.6e-5 and 2 of 1600 by 6.1e-6 to 6.6e-6; the packing of 6400 strains by 2.5e-5 at 0.93 of its limit. That is too much to show whether the number of
disks matters. The cycles of 100, 400 and 1600 disks last 1, 2 and 4 s, since the slowest motion of a larger sample takes longer. With 6400 disks they
last 2 s, because cycles of 8 s would have taken 3.5 hours: for its size that is as short as 0.5 s for 400 disks, where springs strain a few times as
far as in cycles of 2 s (study of ratcheting). Its walls weigh as much as four disks, not one, and its runs pass through checkpoints.
"""
GIVEN = ("100", "400", "1600", "6400", "1e-2", "0.9", "1", "2", "4", "8", "3.5", "0.5")


def numbers(table):
    sizes = dict(list(table.groupby("disks")))
    largest, = sizes[6400].to_dict("records")
    limit, (md, cd) = "static limit", ((f"yields over the limit at, {method}") for method in style.MARKER)
    low = {disks: part[part["load over limit of the cycles"] < 0.9].rate for disks, part in sizes.items()}
    ratio, spread = (table[cd] / table[md]).groupby(table.disks).median(), table.groupby("disks")[[md, cd]].std()
    return {"1.58": [sizes[100][limit].median(), sizes[1600][limit].median(), sizes[1600][limit].max()],
            "10": [len(sizes[100]), len(sizes[400])], **summary.stated("1.42 1.79", sizes[100][limit]),
            **summary.stated("1.49 1.41 1.74", sizes[400][limit], "median min max"), "3": [len(sizes[1600]), len(low[400])],
            "1.55": sizes[1600][limit].min(), "1.51": largest[limit], "1.01": [sizes[100][cd].min(), sizes[400][cd].min(), sizes[1600][md].min()],
            "1.21": sizes[100][cd].max(), "1.11": [sizes[400][cd].max(), sizes[1600][cd].max()],
            "1.04": [sizes[1600][cd].min(), ratio[1600]], "1.09": largest[cd], **summary.stated("0.93 1.14", sizes[100][md]),
            "0.99": sizes[400][md].min(),
            "1.05": [sizes[400][md].max(), ratio[100], ratio[400]], "1.06": [sizes[1600][md].max(), largest[md]], "0.024": spread[md][400],
            "0.081": spread[md][100], "0.039": spread[cd][400], "0.075": spread[cd][100], "22": (table[cd] > table[md]).sum(),
            "24": len(table), "1.03": ratio[6400], "0.66": table["load over limit of the cycles"].corr(table.rate, method="spearman"),
            "5": len(low[100]), **summary.stated("4.0e-8 3.1e-6", low[100]), **summary.stated("2.9e-6 7.6e-5", low[400]),
            **summary.stated("6.1e-6 6.6e-6", low[1600]), "2.5e-5": largest["rate"], "0.93": largest["load over limit of the cycles"]}
