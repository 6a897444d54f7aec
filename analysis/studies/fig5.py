"""Fig. 5: gamma under a load that rises until the sample collapses, and the load at which it yields."""
import numpy as np
import pandas

from analysis import limits, observables, style, summary
from analysis.style import plt
from yade_scripts.tables import product
from yade_scripts.theory import statics

TITLE = "Under a rising load, when does a packing yield?"
QUESTION = "Fig. 5 of the paper, sigma2 = P0 (1 + alpha t), until the strain reaches 0.2."
ORDER = 5  # in the report
# Up to 2.5 P0 or collapse; with the mean stress held, where sigma1 falls as sigma2 rises, to 1.9 P0. Both methods have the same walls, pushed by
# forces and light, so that their inertia does not pass for a collapse.
RAMP = dict(loading="ramp", period=1.0, records_per_cycle=50, wall_mass_ratio=1.0)
METHODS = (dict(method="MD", md_dt_factor=0.3, md_walls="force"), dict(method="CD", cd_dt=2e-3, tolerance=1e-7))
USUAL, QUICK = 0.1, 0.5  # ramp rate alpha [1/s]
ROWS = {"quick": [row for method in METHODS for row in product(ramp_rate=QUICK, cycles=3, **RAMP, **method)],
        "full": [row for method in METHODS for more in (
            dict(ramp_rate=USUAL, cycles=15, preparation_friction=(0.0, 0.1)),
            dict(ramp_rate=USUAL, cycles=9, preparation_friction=(0.0, 0.1), stress_path="mean"),
            dict(ramp_rate=2 * USUAL, cycles=8), dict(ramp_rate=USUAL / 2, cycles=30), dict(ramp_rate=USUAL, cycles=15, stiffening=10.0))
                 for row in product(**more, **RAMP, **method, seed=range(1, 6))]}
# |gamma| that defines a critical load. Springs deform before they yield, by about 1e-2. So the methods are also compared at YIELD beyond the strain
# that each has at the static limit.
THRESHOLDS, YIELD = (1e-4, 1e-3, 1e-2, 3e-2, 1e-1), 1e-2
SMOOTH = (1e-2, 1e-1)  # between these strains it is measured how evenly the sample strains
MORE = f"over the limit at {YIELD:g} more"


def summarize(runs):
    """Return one row a run: critical loads, volume, sliding contacts against their bound.

    over the limit at: sigma2/sigma1 there over the largest that the contacts can carry, which does not depend on the path.
    """
    return [_row(run) for run in summary.order(runs, "stress path", "preparation friction", "ramp rate", "k_n over the usual", "method", "seed")]


def _row(run):
    gamma, load = run.values("gamma"), observables.load(run)
    volume = (1 + run.values("strain1")) * (1 + run.values("strain2")) - 1
    used, first = _share_of_bound(run), run.snapshots[0]
    contacts, disks, bound = statics.degrees_of_freedom(first, first["force_normal"] > 0)
    critical = {f"{threshold:g}": observables.critical_load(run, threshold) for threshold in THRESHOLDS}
    at_limit = float(np.interp(1, limits.over_limit(run, load), np.abs(gamma), right=np.nan))
    return {
        **summary.columns(run, "method", "stress path", "preparation friction", "ramp rate", "k_n over the usual", "seed", "static limit"),
        **{f"load at |gamma| = {threshold}": value for threshold, value in critical.items()},
        **{f"over the limit at |gamma| = {threshold}": limits.over_limit(run, value) for threshold, value in critical.items()},
        "|gamma| at the limit": at_limit, MORE: limits.over_limit(run, observables.critical_load(run, at_limit + YIELD)),
        "load at the end": load.max(), "gamma at the end": gamma[-1], "least volume strain": volume.min(), "volume strain at the end": volume[-1],
        "load where sliding reaches the bound": _first(used >= 1, load),
        "M at the start": contacts, "N at the start": disks, "bound at the start": bound,
        "sliding/bound at |gamma| = 0.001": _first(np.abs(gamma) > 1e-3, used), "sliding/bound at |gamma| = 0.01": _first(np.abs(gamma) > 1e-2, used),
        "largest sliding/bound": used.max(), "samples that strain": _samples_that_strain(gamma),
        **summary.columns(run, "balance error", "unsolved steps", "outcome")}


def _samples_that_strain(gamma):
    """Return over how many samples, which follow at equal steps of the load, the strain between the two of SMOOTH is spread: (sum d)^2/sum d^2 of the
    strains d of the samples there. 1: it comes in one jump; n: evenly in n samples."""
    steps = np.diff(np.clip(np.abs(gamma), *SMOOTH))
    return steps.sum()**2 / np.sum(steps**2) if steps.any() else np.nan


def _first(reached, values):
    """Return the value at the first sample that `reached` marks; NaN if there is none."""
    return values[np.argmax(reached)] if reached.any() else np.nan


def _share_of_bound(run):
    """Return the sliding contacts over the most that can slide at rest, at each sample; rattlers and walls' contacts as at the start.

    A snapshot counts unknowns and equations; between snapshots each contact more, of two disks, adds two unknowns. 1 where the bound is not positive.
    """
    first = run.snapshots[0]
    loaded = first["force_normal"] > 0
    bound = statics.degrees_of_freedom(first, loaded)[2] + 2 * (run.values("contacts") - loaded.sum())
    return np.where(bound > 0, run.values("sliding_contacts") / np.maximum(bound, 1), 1.0)


def draw(runs, rows, path):
    """Draw dense packings: gamma over the load, a panel a stress path with CD enlarged in the inset, and the critical loads. Loose ones have a figure
    of their own.

    Ramps at another rate and of stiffer packings stand in the table only.
    """
    table, usual = pandas.DataFrame(rows), [run for run in runs if run.parameters["ramp_rate"] in (USUAL, QUICK)
                                            and run.parameters["stiffening"] == 1]
    for friction, own in summary.by(usual, "preparation friction").items():
        _draw_ramps(own, table[table["preparation friction"] == friction], path if friction == 0 else path.with_name(f"{path.stem}-loose.png"),
                    "Dense" if friction == 0 else "Loose")


def _draw_ramps(runs, table, path, words):
    paths = dict(sorted(summary.by(runs, "stress path").items()))
    fig, axes = plt.subplots(1, len(paths) + 1, figsize=(1 + 3.6 * (len(paths) + 1), 4))
    for axis, (stress_path, own) in zip(axes, paths.items()):
        _strain(axis, own)
        axis.set_title(style.STRESS_PATH[stress_path])
    _loads(axes[-1], table)
    entries = [dict(color=colour, marker=style.MARKER[method], label=method)
               for method, colour in style.COLOUR.items() if any(run.method == method for run in runs)]
    entries += [dict(color=style.GREY["44"], marker="x", ls="none", label="collapsed")] * any(run.collapsed for run in runs)
    style.legend(axes[-1], entries, loc="lower right", fontsize=7)
    style.finish(fig, path, f"{words} packings, each line is one; inset: CD alone, enlarged. Right: grey lines join MD and CD on one packing; "
                 "open: the mean stress held. Not drawn: other rates and 10 k_n.", runs)


def _strain(axis, runs):
    inset = axis.inset_axes([0.12, 0.1, 0.36, 0.42])
    for run in runs:
        load, gamma = observables.load(run), run.values("gamma")
        for panel in (axis, inset) if run.method == "CD" else (axis,):
            panel.plot(load, gamma, color=style.COLOUR[run.method], linewidth=1, alpha=0.8)
        if run.collapsed:
            axis.plot(load[-1], gamma[-1], "x", color=style.COLOUR[run.method])
    yields = np.array([observables.critical_load(run, THRESHOLDS[0]) for run in runs if run.method == "CD"])
    if np.isfinite(yields).any():
        inset.set(xlim=(1, np.nanmax(yields) + 0.02), ylim=(-3 * THRESHOLDS[0], THRESHOLDS[0]))
    inset.tick_params(labelsize=6)
    inset.ticklabel_format(axis="y", style="sci", scilimits=(0, 0))  # short numbers, which do not cover those of the panel
    inset.yaxis.get_offset_text().set_fontsize(6)
    inset.set_title("CD", fontsize=7, pad=2)
    axis.set(xlabel=r"$\sigma_2/P_0 = 1 + \alpha t$", ylabel=r"$\gamma$   (< 0: shortens along axis 2)")
    axis.grid(True)


def _loads(axis, table):
    """Draw the critical loads over the static limit by threshold: a point a packing, MD and CD of one packing joined by a line."""
    slow = table[table["ramp rate"].isin((USUAL, QUICK)) & (table["k_n over the usual"] == 1)]
    for place, threshold in enumerate(THRESHOLDS):
        name = f"over the limit at |gamma| = {threshold:g}"
        shifts = slow["stress path"].map({"constant": -0.2, "mean": 0.2}) + slow.method.map({"MD": -0.08, "CD": 0.08})
        for (stress_path, _), pair in slow.assign(place=place + shifts).groupby(["stress path", "seed"]):
            axis.plot(pair.place, pair[name], color=style.GREY["AA"], linewidth=0.6, zorder=1)
            for method in style.MARKER:
                style.points(axis, pair[pair.method == method], "place", name, method, ms=4, mfc="none" if stress_path == "mean" else None)
    axis.axhline(1, color="k", lw=0.7, ls=":")
    axis.set_xticks(range(len(THRESHOLDS)), [f"{threshold:g}" for threshold in THRESHOLDS])
    axis.set(xlabel=r"$|\gamma|$ that defines the critical load", ylabel=r"$\sigma_2/\sigma_1$ over its static limit",
             xlim=(-0.5, len(THRESHOLDS) - 0.5))
    axis.grid(axis="y")


POINTS = (
    (10, "The higher inertia of the CD method is even more clearly observed in Figure 5", "section 3", "agrees in part"),
    (11, "In the MD simulation, the system starts expanding slowly.", "section 3", "agrees in part"),
    (13, "In this range of values, however, the CD simulated sample seems to remain unaltered.", "section 3",
     "agrees in part"),
    (14, "In the CD simulation, the response is smoother than in the MD case.", "section 3", "agrees in part"),
    (15, "There is however a critical load, beyond which, the system expands.", "section 3",
     "agrees in part"),
    (23, "This leads to a collapse of the sample at the end of the simulation.", "section 3", "agrees"),
    (24, "We choose alpha small enough so that the system is loaded quasi-statically", "section 2.1", "not decided"),
    (16, "this expansion is carried out without any collapse or breakage of the physical structure of the grains.", "section 3",
     "agrees in part"),
)


def quantities(table):
    keys = ["preparation friction", "stress path", "ramp rate", "seed"]
    first, last, end = "over the limit at |gamma| = 0.0001", "over the limit at |gamma| = 0.01", "load at the end"
    every, (stiffer, table) = table, (table[(table["k_n over the usual"] > 1) == which] for which in (True, False))
    rows = table.set_index(["method", *keys]).sort_index()
    md, cd = rows.loc["MD"], rows.loc["CD"]
    start = md[first].groupby(level=keys[:3]).median()
    rates = {rate: rows.xs(rate, level="ramp rate")["load at |gamma| = 0.01"] for rate in (0.05, 0.1, 0.2)}
    change = {rate: (loads / rates[USUAL] - 1).abs().max() for rate, loads in rates.items()}
    at = {level: (md[f"load at |gamma| = {level}"], cd[f"load at |gamma| = {level}"]) for level in ("0.0001", "0.001", "0.01", "0.1")}
    ratio, beyond = ((cd[name] / md[name]).xs(USUAL, level="ramp rate") for name in (last, MORE))
    usual = md.loc[0.0, "constant", USUAL]
    hard_md, hard_cd = (stiffer[stiffer.method == method].set_index(keys) for method in ("MD", "CD"))
    hard = hard_cd[last] / hard_md[last]
    steady = table[(table["stress path"] == "constant") & (table["ramp rate"] == USUAL)].groupby(["method", "preparation friction"])
    flows = steady["load at |gamma| = 0.1"].median()
    strained = {method: own["|gamma| at the limit"].xs(USUAL, level="ramp rate") for method, own in (("md", md), ("cd", cd))}
    by_rate = {rate: rows.loc["CD"].xs(rate, level="ramp rate")["load at |gamma| = 0.0001"] for rate in (USUAL, USUAL / 2)}
    starts, exp = (by_rate[USUAL / 2] / by_rate[USUAL]).dropna(), np.exp
    even = rows["samples that strain"].xs(USUAL, level="ramp rate")
    evenness = (even["CD"] / even["MD"]).dropna()
    volume = rows.xs(("constant", USUAL), level=("stress path", "ramp rate"))
    volume = volume.rename(columns={"least volume strain": "least", "volume strain at the end": "end"})
    area = {"md": volume.loc["MD"], "cd_dense": volume.loc["CD", 0.0], "cd_loose": volume.loc["CD", 0.1]}
    logs, logs_beyond = (np.log(several).groupby(level=["preparation friction", "seed"]).mean() for several in (ratio, beyond))  # both stress paths
    assert (ratio.loc[0.0] > 1).all() and (every["gamma at the end"].abs() > 0.2).all()
    return locals() | {"SMOOTH": SMOOTH}
