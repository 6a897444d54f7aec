"""Fig. 3: strain rate per cycle against accumulated strain for MD and CD, with sliding contacts, dissipation and contacts in an appendix."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D

from analysis import cycles, observables, style
from analysis import summary
from yade_scripts.results.reader import ResultError
from yade_scripts.tables import product
from yade_scripts.theory import statics

TITLE = "Fig. 3: strain per cycle under repeated loading"
QUESTION = ("Which loads shake down, which ratchet at a constant rate and which collapse, in MD as the paper reports and in CD, of which the paper "
            "reports no cycles; and do the sliding contacts vanish, return in every cycle or grow with it?")
ORDER = 2  # in the report
# Period 0.5 s and a step of 0.3 sqrt(m/k_n) move MD's strain after 30 cycles by less than 2 % (study influence). Dense packings are prepared
# without friction, loose ones with the paper's own mu = 0.1 throughout. Walls of both methods are pushed by forces; they are light, so that their
# inertia does not pass for a collapse. The paper gives sigma2 only: sigma1 = P0, as in its eq. 1, or the mean stress P0 are both read from it.
LOADING = dict(loading="cosine", period=0.5, records_per_cycle=20, wall_mass_ratio=1.0)
SPRINGS = dict(method="MD", md_dt_factor=0.3, md_walls="force", **LOADING)
RIGID = dict(method="CD", cd_dt=2.5e-3, tolerance=1e-8, method_cd="auto", **LOADING)
LOADS = {"mean": (0.1, 0.2, 0.3, 0.4, 0.5), "constant": (0.1, 0.2, 0.3, 0.4, 0.5, 0.8, 1.2)}
SEEDS = range(1, 6)
# Cycles after which runs of both methods are compared: as many as the shorter ones have.
COMPARED = 20


def _paths(loads=LOADS, **settings):
    return [row for path, several in loads.items() for row in product(stress_path=path, delta_sigma=several, **settings)]


SERVO = SPRINGS | {"md_walls": "servo"}
ROWS = {"quick": [row for setting in (SPRINGS, RIGID | {"tolerance": 1e-7, "max_iterations": 2000})
                  for row in _paths({"mean": (0.1, 0.4), "constant": (0.4,)}, cycles=COMPARED, seed=1, **setting)],
        # Of the dense packings the first is continued to twice its length. Loose ones, of which CD has to solve every step near the limit, get less.
        "full": [row for setting, most in ((SPRINGS, 40), (RIGID, COMPARED))
                 for row in _paths(cycles=2 * most, seed=1, **setting) + _paths(cycles=most, seed=SEEDS[1:], **setting)]
        + _paths(cycles=COMPARED, seed=SEEDS, preparation_friction=0.1, **SPRINGS)
        + _paths({"mean": LOADS["mean"]}, cycles=COMPARED, seed=SEEDS, preparation_friction=0.1, **RIGID)
        + _paths({"mean": LOADS["mean"]}, cycles=COMPARED, seed=SEEDS, **SERVO)
        + _paths({"mean": LOADS["mean"][1:4]}, cycles=10, seed=SEEDS[:3], **SPRINGS | {"period": 2.0})}


def summarize(runs):
    """Return one row a run: when it collapses, how it strains, what slides, dissipates and touches.

    static limit: largest sigma2/P0 that the packing's contacts can carry on the stress path (yade_scripts/theory/statics.py).
    """
    limits = {}
    return [_row(run, _limit(run, limits)) for run in sorted(runs, key=_order)]


def _limit(run, known):
    key = run.attributes["state_sha256"], run.parameters["stress_path"]
    if key not in known:
        known[key] = statics.limit_loads(run.snapshots[0], run.pressure, run.attributes["depth"], key[1])[1]
    return known[key]


def kind(run):
    """Return the method, with the walls where they are a servo and the period where it is not 0.5 s."""
    row = run.parameters
    return run.method + ", servo" * (run.method == "MD" and row["md_walls"] == "servo") + f", {row['period']:g} s" * (row["period"] != LOADING["period"])


def _order(run):
    row = run.parameters
    return (*_group(run), row["period"], row["stress_path"], row["delta_sigma"], row["seed"])


def _group(run):
    """Return the panel of a run, for sorting: MD before CD, then by the friction during the preparation."""
    return run.method != "MD", run.parameters["preparation_friction"]


def _row(run, limit):
    found, regime, full = _cycles(run), cycles.regime(run), run.parameters
    row = {"kind": kind(run), "stress path": full["stress_path"], "preparation friction": full["preparation_friction"], "dSigma": full["delta_sigma"],
           "seed": full["seed"], "static limit": limit, "load over limit": (1 + full["delta_sigma"]) / limit, "cycles": len(found.number) if found else 0,
           "collapses in cycle": int(run.values("cycle")[-1]) + 1 if run.collapsed else "", "gamma at the end": float(run.values("gamma")[-1]),
           f"gamma after {COMPARED}": float(found.permanent[COMPARED - 1]) if found and len(found.number) >= COMPARED else np.nan,
           "late rate": float(regime.late_rate), "decay p": float(regime.decay), "noise of the rate": float(regime.noise),
           "last quarter's rate over the one before": cycles.last_quarter(run),
           f"rate of cycles {COMPARED // 2 + 1} to {COMPARED}": float(found.rates([(COMPARED // 2 + 1, COMPARED)])[0])
           if found and len(found.number) >= COMPARED else np.nan,
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
    """Return the run's Cycles; None if it collapsed in the first."""
    try:
        return cycles.of(run)
    except ResultError:
        return None


def _last_cycle(run, back):
    """Return the sliding share through the last completed cycle, or the one `back` - 1 before it."""
    at = cycles.ends(run)
    return cycles.sliding_share(run)[at[-1 - back]:at[-back] + 1]


def _sliding_change(run):
    """Return how much the sliding share differs between the last two cycles: rms over its mean; NaN where there are no two."""
    if len(cycles.ends(run)) < 3:
        return float("nan")
    last, before = _last_cycle(run, 1), _last_cycle(run, 2)
    return float(np.sqrt(np.mean((last - before)**2)) / last.mean()) if len(last) == len(before) and last.mean() else float("nan")


def draw(runs, rows, path):
    """Draw the strain rate against the strain of dense packings, a panel a stress path, both methods on the same axes; beside them, when packings
    collapse. What slides, dissipates and touches is a figure of its own."""
    look = style.shades(run.parameters["delta_sigma"] for run in runs)
    usual = [run for run in runs if kind(run) in LINES]
    dense = [run for run in usual if run.parameters["preparation_friction"] == 0]
    paths = summary.groups(dense, lambda run: -list(LOADS)[::-1].index(run.parameters["stress_path"]))
    fig, axes = plt.subplots(1, len(paths) + 1, figsize=(2 + 3.5 * (len(paths) + 1), 4), squeeze=False)
    for axis in axes[0, 1:-1]:
        axis.sharex(axes[0, 0])
        axis.sharey(axes[0, 0])
    for axis, own in zip(axes[0], paths.values()):
        for (method, load), same in summary.groups(own, lambda run: (run.method, run.parameters["delta_sigma"])).items():
            _rates(axis, same, look[load], method)
        axis.set(xscale="log", yscale="log", xlabel=r"accumulated strain $|\gamma|$", title=TITLES[own[0].parameters["stress_path"]])
        axis.grid(color="#DDDDDD", linewidth=0.5)
    axes[0, 0].set_ylabel(r"strain rate $|\Delta\gamma|$ a cycle")
    handles = [Line2D([], [], color=colour, label=rf"$\Delta\sigma$ = {load:g}") for load, colour in look.items()]
    handles += [Line2D([], [], color="#444444", linestyle=line, marker=style.MARKER[method], markersize=4, label=method)
                for method, line in LINES.items() if any(run.method == method for run in dense)]
    axes[0, -2].legend(handles=handles, fontsize=6.5, loc="lower right", ncol=2)
    _collapses(axes[0, -1], [row for row in rows if row["kind"] in LINES])
    style.finish(fig, path, "Left: dense packings, medians; a cross is a collapse. CD's strain at rest is the error of its solver. Right: all packings; "
                 "open: no collapse in so many cycles.", runs)
    _appendix([run for run in usual if run.parameters["stress_path"] == "mean"], look, path.with_name(f"{path.stem}-cycles.png"))


TITLES = {"mean": r"$(\sigma_1+\sigma_2)/2 = P_0$", "constant": r"$\sigma_1 = P_0$"}


def _collapses(axis, rows):
    """Draw the cycle in which a packing collapses, or as many as it stands, against the load over its static limit."""
    for method in LINES:
        for collapsed in (True, False):
            part = [row for row in rows if row["kind"] == method and (row["collapses in cycle"] != "") == collapsed]
            axis.plot([row["load over limit"] for row in part], [row["collapses in cycle"] if collapsed else row["cycles"] for row in part], ls="",
                      marker=style.MARKER[method], ms=4.5, color=style.COLOUR[method], mfc=None if collapsed else "none",
                      label=f"{method}: {'collapses' if collapsed else 'stands'}")
    axis.axvline(1, color="k", lw=0.7, ls=":")
    axis.set(yscale="log", xlabel=r"largest $\sigma_2$ over the static limit", ylabel="cycles", title="collapse")
    axis.legend(fontsize=6.5)


LINES = {"MD": "-", "CD": "--"}


def _rates(axis, runs, colour, method):
    """Draw medians over the packings of strain and rate, over windows that grow with the number of the cycle; a cross where a sample collapses."""
    strains = []
    for run in runs:
        found = _cycles(run)
        if run.collapsed:
            end = run.values("gamma")[-1]
            axis.plot(abs(end), abs(end - found.permanent[-1] if found else end), "x", color=colour, markersize=6)
        if found is not None:
            windows = cycles.windows(len(found.number))
            strains.append(np.stack([np.abs(found.permanent[[last - 1 for _, last in windows]]), np.abs(found.rates(windows))]))
    if strains:
        shortest = min(strain.shape[1] for strain in strains)
        axis.plot(*np.median([strain[:, :shortest] for strain in strains], axis=0), color=colour, linestyle=LINES[method], marker=style.MARKER[method],
                  markersize=3.5)


def _appendix(runs, look, path):
    """Draw cycle by cycle the most sliding contacts, the energy dissipated, and the contacts; a column a method and preparation."""
    groups = summary.groups(runs, _group)
    fig, axes = plt.subplots(3, len(groups), figsize=(1 + 2.6 * len(groups), 7.5), squeeze=False, sharex=True, sharey="row")
    labels = (("sliding_max", "most contacts at the Coulomb\nlimit / contacts"), ("dissipated", "dissipated in a cycle\n/ $P_0V_0$"), ("contacts", "contacts $2M/N$"))
    for column, ((rigid, friction), own) in enumerate(groups.items()):
        axes[0, column].set_title(f"{'CD' if rigid else 'MD'}, prepared with $\\mu$ = {friction:g}", fontsize=9)
        for load, same in summary.groups(own, lambda run: run.parameters["delta_sigma"]).items():
            several = [found for run in same if (found := _cycles(run))]
            count = min((len(found.number) for found in several), default=0)
            for axis, (name, label) in zip(axes[:, column], labels):
                if count:
                    median = np.median([getattr(found, name)[:count] for found in several], axis=0)
                    axis.plot(np.arange(1, count + 1), np.where((median > 0) | (name != "dissipated"), median, np.nan), color=look[load],
                              label=rf"$\Delta\sigma$ = {load:g}")
                axis.set_xscale("log")
                axis.grid(color="#DDDDDD", linewidth=0.5)
                if column == 0:
                    axis.set_ylabel(label)
        axes[1, column].set_yscale("log")
        axes[2, column].set_xlabel("cycle")
    axes[0, -1].legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    style.finish(fig, path, "Median over the packings.", runs)


ANSWER = """
On the same packings and under the same loads MD goes on straining in 22 of 50 cases after 20 cycles, CD in 1; in all others the strain settles
(shakedown). Of dense packings, prepared without friction, MD ratchets only at dSigma of 0.4 and 0.5 (7 of 10 runs, by the end of 100 cycles);
loose ones, prepared with mu = 0.1, ratchet at every load (12 of 25). No sample collapses at dSigma of 0.4 or 0.5, unlike the paper's. The verdicts
are of finite runs: 39 of 50 longer runs kept their verdict of 20 cycles. CD ran at a tolerance of 1e-7 and 29 of its runs have steps that missed
it, at most 1502. The walls are a servo in MD and pushed by forces in CD.
"""
GIVEN = ("0.1", "0.4", "0.5", "2", "20", "100", "1e-7")
POINTS = (
    (0, "If the loadings are low enough, the excitations shakedown in the material. [...] there will be practically no accumulation of permanent strain.",
     "section 3, Fig. 3", "agrees", "At dSigma = 0.1, 8 of 10 MD runs shake down."),
    (1, "This is related to the disappearance of sliding contacts in the sample.", "section 3, Fig. 3", "disagrees",
     "Of 31 MD runs that shake down none has lost its sliding contacts: within the last cycle up to 14 % of the contacts (median) are at the "
     "Coulomb limit. They slide to and fro and dissipate without straining the sample."),
    (2, "the strain rate does not apparently diminish, leading to a fast failure of the material. This incremental collapse can be seen in cases "
     "dSigma = 0.40 and dSigma = 0.50 of the figure.", "section 3, Fig. 3", "disagrees", "None of 20 MD runs at these loads collapses."),
    (3, "For loads above the shakedown limit but far from collapse, the material accumulates permanent strain at a constant but very small rate. This "
     "behavior is associated to a quasi-periodic response of the sliding contacts [...].", "section 3, Fig. 3", "agrees in part",
     "19 of 50 MD runs ratchet, at 6.2e-5 a cycle (median). In 7 of them the rate changes by less than a factor of 2 from the third to the last "
     "quarter of the cycles."),
    (13, "A different behavior of the plastic response of a system simulated by a MD algorithm and a CD algorithm has been shown.", "section 4",
     "agrees in part", "The methods differ in 21 of 50 cases: MD ratchets and CD shakes down."),
)


def numbers(table):
    """Return the numbers of the text, from the summary table."""
    md, cd = (table[table.method == method] for method in ("MD", "CD"))
    ratchets, after = md[md.regime == "ratcheting"], f"regime after {COMPARED}"
    keys = ["preparation friction", "dSigma", "seed"]
    pairs = md.merge(cd, on=keys, suffixes=(" MD", " CD"))
    dense = md["preparation friction"] == 0
    high, longer, still = md.dSigma >= 0.4, md[md.cycles > COMPARED], md[md.regime == "shakedown"]
    missed = cd["unsolved steps"].astype(float)
    constant = ratchets["last quarter's rate over the one before"].between(0.5, 2)
    return {"22": (pairs[f"{after} MD"] == "ratcheting").sum(), "50": [len(pairs), len(md), len(longer)],
            "1": (pairs[f"{after} CD"] == "ratcheting").sum(),
            "7": [len(ratchets[(ratchets["preparation friction"] == 0) & (ratchets.dSigma >= 0.4)]), constant.sum()], "10": [len(md[dense & high]), len(md[md.dSigma == 0.1])],
            "12": len(ratchets[ratchets["preparation friction"] == 0.1]), "25": len(md[~dense]), "39": (longer.regime == longer[after]).sum(), "29": (missed > 0).sum(), "1502": missed.max(),
            "8": (md[md.dSigma == 0.1].regime == "shakedown").sum(), "31": len(still), "14": 100 * still["sliding at most, last cycle"].median(),
            "20": high.sum(), "19": len(ratchets), "6.2e-5": ratchets["late rate"].abs().median(),
            "21": ((pairs[f"{after} MD"] == "ratcheting") & (pairs[f"{after} CD"] == "shakedown")).sum()}
