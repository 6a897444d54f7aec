"""The parameters that the paper does not give: each is varied alone, packing by packing."""
import pandas
from matplotlib.ticker import LogLocator, NullFormatter

from analysis import style, summary
from analysis.studies.fig3 import SPRINGS
from analysis.style import plt
from yade_scripts import parameters
from yade_scripts.tables import product

TITLE = "What do the settings change that the paper omits?"
QUESTION = "MD's strain after 10 cycles under dSigma = 0.4 if one setting is changed."
ORDER = 8  # in the report
BASE = SPRINGS | dict(cycles=10, delta_sigma=0.4)
# Springs with strong damping need shorter steps.
PHYSICAL = (dict(kt_over_kn=0.1), dict(kt_over_kn=0.25), dict(kt_over_kn=1.0), dict(beta_n=0.02), dict(beta_n=0.4, md_dt_factor=0.08),
            dict(damping_factor=0.2), dict(damping_factor=4.0, md_dt_factor=0.08),
            dict(radius_spread=0.1), dict(radius_spread=0.5), dict(wall_friction=0.1), dict(preparation_friction=0.02),
            dict(preparation_friction=0.1),
            dict(tangential_damping=1.0), dict(wall_mass_ratio=20.0), dict(wall_mass_ratio=200.0), dict(md_walls="servo"))
NUMERICAL = (dict(period=0.25), dict(period=1.0), dict(period=2.0), dict(md_dt_factor=0.1), dict(md_dt_factor=0.2))
SEEDS = range(1, 7)
# The settings in the words of the figure.
WORDS = {"kt_over_kn": r"stiffness ratio $k_t/k_n$", "beta_n": r"damping ratio $\beta_n$, also in the preparation",
         "damping_factor": "damping in the cycles, factor", "tangential_damping": "tangential dashpot, over the normal one",
         "radius_spread": "spread of the radii",
         "preparation_friction": "friction in the preparation", "wall_mass_ratio": "mass of a wall over that of a disk", "md_walls": "walls moved by",
         "period": "period [s]", "md_dt_factor": r"time step $dt/\sqrt{m/k_n}$"}
ROWS = {"quick": [BASE | change for change in ({}, dict(kt_over_kn=0.1), dict(preparation_friction=0.1))],
        "full": [row for change in ({}, *PHYSICAL) for row in product(**BASE | change | dict(seed=SEEDS))]
        + [row for change in NUMERICAL for row in product(**BASE | change | dict(seed=SEEDS[:3]))]}


def summarize(runs):
    """Return one row for each change, over the packings: |gamma| after the cycles, and over that of the same seed without the change.

    A run that collapses has strained by what it had then. rate ratio: the same of the strain a cycle in the last half of the cycles, without runs
    that collapse.
    """
    base, rows = _alone(runs, {}), []
    for change in ({}, *PHYSICAL, *NUMERICAL):
        found = _alone(runs, change)
        if found.empty:
            continue
        strains = found["strain"]
        rows.append({"change": ", ".join(f"{name} = {value}" for name, value in change.items()) or "none", "packings": len(found),
                     "|gamma|": strains.median(), "least |gamma|": strains.min(), "most |gamma|": strains.max()})
        for name, ratios in (("ratio", strains / base["strain"]), ("rate ratio", found["late rate"] / base["late rate"])):
            if ratios.notna().any():
                rows[-1] |= {name: ratios.median(), f"least {name}": ratios.min(), f"largest {name}": ratios.max()}
    return rows


def _alone(runs, change):
    """Return a table of the runs with that change alone, by seed: |gamma| at the end, and the rate of the last half of the cycles."""
    wanted = parameters.complete(BASE | change)
    found = {run.parameters["seed"]: {"strain": abs(run.values("gamma")[-1])} | summary.columns(run, "late rate") for run in runs
             if run.parameters == wanted | {"seed": run.parameters["seed"]}}
    return pandas.DataFrame(found, index=["strain", "late rate"], dtype=float).T


def draw(runs, rows, path):
    """Draw the strain over that of the same packing without the change, median and range; on top how far the packings differ among themselves."""
    fig, axis = plt.subplots(figsize=(8, 6.4))
    labels = []
    for place, row in enumerate(row for row in rows if "ratio" in row):
        if row["change"] == "none":
            low, middle, high = (row[name] / row["|gamma|"] for name in ("least |gamma|", "|gamma|", "most |gamma|"))
            label, colour = "another packing", style.GREY["44"]
        else:
            low, middle, high = (row[name] for name in ("least ratio", "ratio", "largest ratio"))
            label, colour = f"{_words(row['change'])} ({row['packings']:.0f})", style.COLOUR["MD"]
        labels.append(label)
        axis.plot([low, high], [place, place], color=colour, linewidth=2, alpha=0.5)
        axis.plot(middle, place, "o", color=colour, markersize=5)
    axis.axvline(1, color=style.GREY["44"], linewidth=0.8, linestyle="--")
    axis.set_yticks(range(len(labels)), labels)
    axis.invert_yaxis()
    axis.set(xscale="log", xlabel=rf"$|\gamma|$ after {BASE['cycles']} cycles over that without the change")
    axis.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axis.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axis.xaxis.set_minor_formatter(NullFormatter())
    axis.grid(True)
    style.finish(fig, path, "Points: medians over the packings, whose number is in brackets. Bars: from the least to the largest. "
                 f"Strong damping has a shorter time step, too. dSigma = {BASE['delta_sigma']:g}, sigma1 held.", runs)


def _words(change):
    """Return a change, as the table has it, in words. The step is not named where strong damping needs a shorter one."""
    name, value = change.split(", ")[0].split(" = ")
    return f"{WORDS[name]}: {value}"


def quantities(table):
    rows = table.set_index("change")
    dampings, tangential = (rows.loc[list(changes)] for changes in (
        ("damping_factor = 0.2", "damping_factor = 4.0, md_dt_factor = 0.08"), ("kt_over_kn = 0.25", "kt_over_kn = 1.0")))
    loose, heavy, servo, slow, third, dashpot = (rows.loc[change] for change in (
        "preparation_friction = 0.1", "wall_mass_ratio = 200.0", "md_walls = servo", "period = 2.0", "md_dt_factor = 0.1",
        "tangential_damping = 1.0"))
    radii = rows.loc[["radius_spread = 0.1", "radius_spread = 0.5"]]
    calm = rows.loc[["beta_n = 0.02", "beta_n = 0.4, md_dt_factor = 0.08"]]
    low, high, late_low, late_high = "least ratio", "largest ratio", "least rate ratio", "largest rate ratio"
    assert tangential[low].min() > 0.8 and tangential[high].max() < 1.2
    return locals()
