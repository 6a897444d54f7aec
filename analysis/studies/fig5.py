"""Fig. 5: gamma under a load that rises until the sample collapses, and the load at which it yields."""
import numpy as np
import pandas

from analysis import limits, observables, style, summary
from analysis.style import plt
from yade_scripts.tables import product
from yade_scripts.theory import statics

TITLE = "Fig. 5: the ramp, up to collapse"
QUESTION = ("Under sigma2 = P0 (1 + alpha t), does MD strain from the start and then collapse, while CD rests up to a critical load and then yields "
            "smoothly? At which load do the packings yield, and how much does this load differ between packings and between the methods?")
ORDER = 3  # in the report
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
        "largest sliding/bound": used.max(), **summary.columns(run, "balance error", "unsolved steps", "outcome")}


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
    entries += [dict(color="#444444", marker="x", ls="none", label="collapsed")] * any(run.collapsed for run in runs)
    style.legend(axes[-1], entries, loc="lower right", fontsize=7)
    style.finish(fig, path, f"{words} packings, a line each; inset: CD alone, enlarged. Right: grey lines join MD and CD on one packing; "
                 "open: the mean stress held. Not drawn: other rates and 10 $k_n$.", runs)


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
            axis.plot(pair.place, pair[name], color="#AAAAAA", linewidth=0.6, zorder=1)
            for method in style.MARKER:
                style.points(axis, pair[pair.method == method], "place", name, method, ms=4, mfc="none" if stress_path == "mean" else None)
    axis.axhline(1, color="k", lw=0.7, ls=":")
    axis.set_xticks(range(len(THRESHOLDS)), [f"{threshold:g}" for threshold in THRESHOLDS])
    axis.set(xlabel=r"$|\gamma|$ that defines the critical load", ylabel=r"$\sigma_2/\sigma_1$ over its static limit",
             xlim=(-0.5, len(THRESHOLDS) - 0.5))
    axis.grid(axis="y")


ANSWER = """
Where motion begins depends on sigma2/sigma1 over the largest ratio that the contacts of the packing can carry. In these units the two stress paths
give nearly the same curves: with the mean stress held |gamma| = 1e-4 is passed at 1.00 to 1.01 times the ratio with sigma1 held, 1e-2 at 0.94 to 1.04
times. MD strains from the start of the ramp. Dense packings, prepared without friction, pass |gamma| = 1e-4 in MD at 0.72 of the limit with sigma1
held and at 0.72 with the mean stress held (medians of 5), loose ones at 0.87 and 0.87. CD rests up to the limit, which a linear programme computes
beforehand: it passes |gamma| = 1e-4 at 0.986 to 1.022 of it in 30 ramps from 10 packings, and at 0.989 to 1.025 on 5 packings of 10 k_n.

At yield the methods nearly agree. CD reaches |gamma| = 1e-2 at 1.05 times the stress ratio of MD on dense packings (median of 10 ramps at the usual
rate, 0.1 per second, on 5 packings; 1.02 to 1.06, on all of them at a higher ratio than MD), and at 1.02 times on loose ones (0.97 to 1.08; both
stress paths taken together, higher on 3 of 5 packings). But at the static limit springs have already strained, by 3.2e-3 to 1.8e-2 on dense packings
and 3.6e-3 to 7.5e-3 on loose ones (rigid contacts by 1.4e-3 at most). If 1e-2 is counted from the strain at the limit, CD needs 1.03 times the ratio
of MD on dense packings (0.94 to 1.05; higher on 3 of 5) and 0.97 times on loose ones (0.82 to 1.07; higher on 1 of 5). Over all 10 packings CD needs
1.033 times the ratio of MD for 1e-2 (geometric mean; standard error 0.008), and 0.996 times (0.013) for 1e-2 from the strain at the limit. So which
method yields first depends on what is called yield. With stiffer springs the difference nearly vanishes at this strain: on dense packings prepared
with springs of 10 k_n, with sigma1 held, MD passes |gamma| = 1e-4 at 0.88 of the limit, and at 1e-2 CD needs 1.003 times the ratio of MD (medians of
5 packings; 0.998 to 1.011; more on 3). These packings have other contacts: rigid contacts on the packings of k_n need 1.03 times the ratio of springs
of 10 k_n (median; 0.992 to 1.051).

All 70 runs reach |gamma| = 0.2. A ramp twice as fast changes the load at |gamma| = 1e-2 by at most 3.3 %, one half as fast by at most 1.0 %; in the
slowest ramps CD reaches it at 1.02 to 1.06 times the ratio of MD (5 dense packings). Beyond that strain the samples collapse, and the methods cannot
be ranked: CD reaches 0.1 at 0.88 to 1.06 times the ratio of MD, at a higher ratio in 15 of 20 ramps at the usual rate. There dense and loose packings
carry the same load, since they have made new contacts: 1.67 and 1.65 P0 in MD, 1.68 and 1.67 P0 in CD (sigma1 held, medians), while their static
limits are 1.49 and 1.19 P0. MD's energies balance to 0.3 % of the work.
"""
GIVEN = ("1e-4", "1e-3", "1e-2", "0.1", "0.2", "2700")
POINTS = (
    (7, "In the MD simulation, the system starts expanding slowly.", "section 3, Fig. 5", "agrees in part",
     "MD strains from the start: dense packings pass |gamma| = 1e-4 at 1.07 P0 and 1e-2 at 1.49 P0 with sigma1 held (medians). If \"expanding\" "
     "refers to the area, the sample first shrinks, in 20 of 20 runs; the paper plots gamma."),
    (8, "A sudden compression is perceived [...], after which the deformation rate seems to grow in each cycle.", "section 3, Fig. 5",
     "not decided",
     "Not compared: the paper names N = 2700 and cycles here, but refers to the ramp of its eq. 1, which has none."),
    (9, "In this range of values, however, the CD simulated sample seems to remain unaltered.", "section 3, Fig. 5", "disagrees",
     "The range, by the sentences before, goes up to the collapse of MD. There CD does not remain unaltered: when MD reaches 0.2, CD has passed 1e-2 "
     "in 29 and 0.1 in 21 of 30 pairs, and reaches 0.2 at 1.01 times the load of MD (median; 0.96 to 1.11). At small strains it agrees: when MD "
     "passes 1e-3, CD is below 1e-4 in 30 of 30 pairs."),
    (10, "In the CD simulation, the response is smoother than in the MD case.", "section 3, Fig. 5", "not decided",
     "Up to the static limit CD rests; beyond it its curves have steps as those of MD have (see the figure). How smooth they are was not measured."),
    (11, "At a first stage, the system seems not to be affected by the imposed loading. There is however a critical load, beyond which, the system "
     "expands.", "section 3, Fig. 5", "agrees",
     "CD stays below |gamma| = 1e-4 up to 0.986 to 1.022 of the static limit (30 ramps). Beyond it strains; if expanding means the area, it has "
     "grown in the end in 30 of 30 runs."),
    (12, "this expansion is carried out without any collapse or breakage of the physical structure of the grains.", "section 3, Fig. 5",
     "agrees in part",
     "Below |gamma| = 1e-2 nothing breaks suddenly; in the end 30 of 30 runs of CD reach |gamma| = 0.2. The paper does not say how far its ramp "
     "went."),
    (14, "The response of the material is more apparent in the MD simulation, while CD is much more resistant to collapse.", "section 4",
     "agrees in part",
     "Not under a ramp: there both methods yield at nearly the same load. CD reaches |gamma| = 1e-2 at 1.05 times the ratio of MD "
     "on dense packings and 1.02 times on loose ones; counted from the strain at the static limit, 1.03 and 0.97 times. What differs is the strain "
     "on the way."),
)


def numbers(table):
    keys, end = ["preparation friction", "stress path", "ramp rate", "seed"], "load at the end"
    stiffer, table = table[table["k_n over the usual"] > 1], table[table["k_n over the usual"] == 1]
    first, last = "over the limit at |gamma| = 0.0001", "over the limit at |gamma| = 0.01"
    rows = table.set_index(["method", *keys]).sort_index()
    md, cd = rows.loc["MD"], rows.loc["CD"]
    start = md[first].groupby(level=keys[:3]).median()
    held, constant = (rows.xs(path, level="stress path") for path in ("mean", "constant"))
    paths = {name: (held[name] / constant[name]).dropna() for name in (first, last)}
    rates = {rate: rows.xs(rate, level="ramp rate")["load at |gamma| = 0.01"] for rate in (0.05, 0.1, 0.2)}
    change = lambda rate: 100 * (rates[rate] / rates[0.1] - 1).abs().max()
    rests = [md[f"load at |gamma| = {level}"] < cd[f"load at |gamma| = {lower}"] for level, lower in (("0.001", "0.0001"), ("0.01", "0.001"))]
    ratio, further = ((cd[name] / md[name]).xs(0.1, level="ramp rate") for name in (last, "over the limit at |gamma| = 0.1"))
    slowest = (cd[last] / md[last]).xs(0.05, level="ramp rate")
    dense, loose, usual = ratio.loc[0.0], ratio.loc[0.1], md.loc[0.0, "constant", 0.1]
    higher = [(np.log(own).groupby(level="seed").mean() > 0) for own in (dense, loose)]
    hard_md, hard_cd = (stiffer[stiffer.method == method].set_index(keys) for method in ("MD", "CD"))
    hard, yields = hard_cd[last] / hard_md[last], "load at |gamma| = 0.01"
    soft = cd[yields] / hard_md[yields]  # sigma1 is held, so the load is the ratio
    steady = table[(table["stress path"] == "constant") & (table["ramp rate"] == 0.1)].groupby(["method", "preparation friction"])
    flows, limit = steady["load at |gamma| = 0.1"].median(), steady["static limit"].median()["MD"]
    beyond = (cd[MORE] / md[MORE]).xs(0.1, level="ramp rate")
    firmly = [(np.log(beyond.loc[kind]).groupby(level="seed").mean() > 0).sum() for kind in (0.0, 0.1)]
    whole = {name: np.log(pairs).groupby(level=["preparation friction", "seed"]).mean() for name, pairs in ((last, ratio), (MORE, beyond))}
    mean_and_error = lambda own: (np.exp(own.mean()), own.std(ddof=1) / np.sqrt(len(own)))
    strained = md["|gamma| at the limit"].xs(0.1, level="ramp rate")
    ends = cd[end] / md[end]
    assert (dense > 1).all() and (table["gamma at the end"].abs() > 0.2).all() and (stiffer["gamma at the end"].abs() > 0.2).all()
    return {**summary.stated("1.00 1.01", paths[first]), **summary.stated("0.94 1.04", paths[last]),
            "0.72": [start[0.0, "constant", 0.1], start[0.0, "mean", 0.1]], "5": [len(usual), len(hard), len(slowest), higher[0].sum()],
            "0.87": [start[0.1, "constant", 0.1], start[0.1, "mean", 0.1]], **summary.stated("0.986 1.022", cd[first]),
            "30": [len(cd), rests[0].sum(), (cd["volume strain at the end"] > 0).sum(), cd.outcome.str.startswith("collapsed").sum()],
            "10": [len(dense), len(loose), len(md.groupby(level=["preparation friction", "seed"])), *stiffer["k_n over the usual"].unique()],
            **summary.stated("0.989 1.025", hard_cd[first]),
            "1.05": dense.median(), "1.02": [dense.min(), loose.median(), slowest.min()], "1.06": [dense.max(), further.max(), slowest.max()],
            "0.97": loose.min(), "1.08": loose.max(), "3": [higher[1].sum(), firmly[0], (hard > 1).sum()],
            **summary.stated("3.2e-3 1.8e-2", strained.loc[0.0]),
            **summary.stated("3.6e-3 7.5e-3", strained.loc[0.1]), "1.4e-3": cd["|gamma| at the limit"].xs(0.1, level="ramp rate").max(),
            "1.03": [beyond.loc[0.0].median(), soft.median()], "0.94": [paths[last].min(), beyond.loc[0.0].min()], "0.82": beyond.loc[0.1].min(),
            "1.07": [beyond.loc[0.1].max(), usual["load at |gamma| = 0.0001"].median()], "1": firmly[1],
            **dict(zip(("1.033", "0.008"), mean_and_error(whole[last]))), **dict(zip(("0.996", "0.013"), mean_and_error(whole[MORE]))),
            "0.88": [hard_md[first].median(), further.min()],
            **summary.stated("1.003 0.998 1.011", hard, "median min max"),
            **summary.stated("0.992 1.051", soft.dropna()), "70": len(table) + len(stiffer),
            "3.3": change(0.2), "1.0": change(0.05), "15": (further > 1).sum(),
            "20": [len(further), (md["least volume strain"].loc[:, "constant"] < -1e-5).sum(), len(rests[1].loc[0.0])],
            "1.67": [flows["MD", 0.0], flows["CD", 0.1]], "1.65": flows["MD", 0.1], "1.68": flows["CD", 0.0],
            "1.49": [limit[0.0], usual["load at |gamma| = 0.01"].median()], "1.19": limit[0.1], "0.3": 100 * md["balance error"].abs().max(),
            "29": (cd["load at |gamma| = 0.01"] < md[end]).sum(), "21": (cd["load at |gamma| = 0.1"] < md[end]).sum(), "0.96": ends.min(),
            "1.11": ends.max()}
