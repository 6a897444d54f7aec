"""The paper's experiment with spheres in space: one cycle (Fig. 4) and a rising load (Fig. 5) by three methods, and the static limit of packings."""
import numpy as np

from analysis import loops, observables, style, summary
from analysis.studies.implicit import COLOUR, MARKER, MD, RIGID, SPRINGS, kind
from analysis.style import plt
from yade_scripts.errors import ResultError
from yade_scripts.tables import product
from yade_scripts.theory import cone_limits

TITLE = "Is it the same for spheres in space?"
QUESTION = "MD's springs, the same springs in Contact Dynamics, and rigid contacts, from the same packings of spheres."
ORDER = 5.5  # in the report
SPACE = dict(scene="triaxial")
METHODS = (dict(method="MD", md_walls="force"), dict(method="CD", cd_contacts="springs"), dict(method="CD"))
CYCLE = SPACE | dict(loading="cosine", delta_sigma=0.2)
RAMP = SPACE | dict(loading="ramp", cycles=9, records_per_cycle=20)
LARGE, SMALL = dict(disks=2000), dict(disks=500)
SLOWER = dict(ramp_rate=0.35, cycles=15)  # half as fast
ROWS = {"quick": [row for method in METHODS for row in (CYCLE | dict(disks=200) | method, RAMP | dict(disks=200, ramp_rate=2.0, cycles=4) | method)],
        "full": [row for method in METHODS for row in product(**CYCLE | LARGE | method, seed=range(1, 4))]
        + [row for method in METHODS for row in product(**RAMP | SMALL | method, seed=range(1, 6))]
        + product(**RAMP | SMALL | METHODS[2] | SLOWER, seed=range(1, 6))
        + [RAMP | LARGE | method | dict(seed=1) for method in METHODS]}
THRESHOLDS = (1e-4, 1e-3, 1e-2, 1e-1)  # of |gamma|
LIMIT_UP_TO = 500  # spheres: a larger packing takes a quarter of an hour
_limits = {}  # of the packings


def static_limit(run):
    """Return two bounds of the largest sigma2/P0 that the contacts at the start can carry; NaN if there is none, and for large packings."""
    if run.parameters["disks"] > LIMIT_UP_TO:
        return np.nan, np.nan
    packing = run.snapshots[0]
    key = packing["contact_point"].tobytes()
    if key not in _limits:
        try:
            _limits[key] = cone_limits.limit_load(packing, run.pressure)
        except ResultError:
            _limits[key] = np.nan, np.nan
    return _limits[key]


def load_at(threshold):
    return f"load at |gamma| = {threshold:g}"


def over(threshold):
    return f"over the limit at |gamma| = {threshold:g}"


@summary.each
def summarize(run):
    """Return the row of a run: of a cycle its loop, of a ramp sigma2/P0, also over the static limit, where |gamma| passes a threshold."""
    row, ramp = run.parameters, run.parameters["loading"] == "ramp"
    found = {"experiment": "ramp" if ramp else "cycle", "medium": kind(run), "spheres": row["disks"], "packing": row["seed"],
             "ramp_rate": row["ramp_rate"] if ramp else np.nan}
    if ramp:
        below, limit = static_limit(run)
        found |= {"static limit": limit, "static limit, lower bound": below}
        loads = {threshold: observables.critical_load(run, threshold) for threshold in THRESHOLDS}
        found |= {load_at(threshold): load for threshold, load in loads.items()}
        found |= {over(threshold): load / limit for threshold, load in loads.items()}
    else:
        found |= loops.of(run)
    return found | {"contacts a sphere": 2 * run.values("contacts")[0] / row["disks"], "seconds": float(run.values("processor_time")[-1]),
                    **summary.columns(run, "unsolved steps", "outcome")}


def draw(runs, rows, path):
    """Draw the loop of one packing, its ramp, and the loads at which all packings pass a strain, over their limits."""
    fig, (cycle, ramp, loads) = plt.subplots(1, 3, figsize=(12, 4))
    shown = {which: max(run.parameters["disks"] for run in runs if (run.parameters["loading"] == "ramp") == (which is ramp)
                        and (which is cycle or run.parameters["disks"] <= LIMIT_UP_TO)) for which in (cycle, ramp)}
    for run in runs:
        row, look = run.parameters, dict(color=COLOUR[kind(run)]) | (dict(lw=4, alpha=0.5) if run.method == "MD" else dict(lw=1.4))
        which = ramp if row["loading"] == "ramp" else cycle
        if row["seed"] != 1 or row["disks"] != shown[which] or row["ramp_rate"] == SLOWER["ramp_rate"]:
            continue
        if which is ramp:
            ramp.plot(observables.load(run), np.abs(run.values("gamma")), label=kind(run), **look)
            limit = static_limit(run)[1]
        else:
            cycle.plot(-run.values("gamma") * 1e4, observables.load(run), **look)
    ramp.axvline(limit, color="k", lw=0.8, ls=":", label="static limit")
    cycle.set(xlabel=r"strain $-\gamma$  [$10^{-4}$]", ylabel=r"stress $\sigma_2/P_0$", title="one cycle")
    ramp.set(yscale="log", ylim=(1e-6, 0.3), xlabel=r"stress $\sigma_2/P_0$", ylabel=r"strain $|\gamma|$", title="rising load")
    ramp.legend()
    for row in rows:
        if row["experiment"] == "ramp":
            slow = row["ramp_rate"] == SLOWER["ramp_rate"]
            shift = {MD: -0.3, SPRINGS: -0.05, RIGID: 0.2}[row["medium"]] + 0.12 * slow
            loads.plot(np.arange(len(THRESHOLDS)) + shift, [row[over(threshold)] for threshold in THRESHOLDS], ls="", marker=MARKER[row["medium"]],
                       color=COLOUR[row["medium"]], ms=5, mfc="none" if slow else None)
    loads.axhline(1, color="k", lw=0.8, ls=":")
    loads.set_xticks(range(len(THRESHOLDS)), [f"{threshold:g}" for threshold in THRESHOLDS])
    loads.set(xlabel=r"strain $|\gamma|$ that is passed", ylabel=r"$\sigma_2/P_0$ over its static limit", title="all packings")
    style.finish(fig, path, f"Left: one packing of {shown[cycle]} spheres. Middle: one of {shown[ramp]}. Right: each point is a packing of "
                 f"{shown[ramp]}; open: a ramp half as fast.", runs)


def quantities(table):
    cycle, ramp = (table[table.experiment == which] for which in ("cycle", "ramp"))
    loop = {medium: own.set_index("packing") for medium, own in cycle.groupby("medium")}
    usual = ramp[ramp.ramp_rate > SLOWER["ramp_rate"]].set_index(["spheres", "packing"])
    passed = {medium: usual[usual.medium == medium] for medium in (MD, SPRINGS, RIGID)}
    slower = ramp[ramp.ramp_rate == SLOWER["ramp_rate"]].set_index(["spheres", "packing"])
    pace = slower[load_at(1e-4)] / passed[RIGID][load_at(1e-4)].loc[slower.index]
    same = loop[SPRINGS].largest / loop[MD].largest
    apart = (1 - ramp["static limit, lower bound"] / ramp["static limit"]).max()
    first, later, md, springs, rigid = over(1e-4), load_at(1e-2), MD, SPRINGS, RIGID
    return locals()
