"""At which load does a rigid packing yield under a ramp? Compared with the initial force network, the packing, and limit analysis.

The static theorem (yade_scripts/theory/statics.py) gives the largest sigma2 at which the contacts of a packing can be in balance. It depends only on
friction and on which contacts touch, and comes from a linear programme without dynamics. Here it is compared with the load at which the packing
moves.
"""
import numpy as np
import pandas

from analysis import observables, style, summary
from analysis.style import plt
from yade_scripts.tables import product
from yade_scripts.theory import statics

TITLE = "Do the forces at the start decide when rigid grains yield?"
QUESTION = "Packings are loaded from several sets of admissible contact forces each."
ORDER = 6  # in the report
RAMP = dict(tolerance=1e-8, md_walls="force", loading="ramp", ramp_rate=0.2, period=6.0, cd_dt=5e-3, collapse_strain=0.02)
SMALL = RAMP | dict(disks=200, records_per_cycle=300)
FULL = RAMP | dict(records_per_cycle=600)
ROWS = {"quick": product(method="CD", seed=1, network_seed=(0, 1, 2), **SMALL) + product(method="CD", seed=2, **SMALL)
        + product(method="MD", seed=(1, 2), **SMALL),
        "full": product(method="CD", seed=1, network_seed=range(11), **FULL) + product(method="CD", seed=range(2, 7), **FULL)
        + product(method="CD", preparation_friction=0.1, seed=(1, 2, 3), network_seed=(0, 1), **FULL)
        + product(method="MD", seed=range(1, 7), **FULL) + product(method="MD", preparation_friction=0.1, seed=(1, 2, 3), **FULL)}

# |gamma| that counts as motion. CRITICAL is far above the creep by solver error below the limit, and below the strain at which contacts
# that close strengthen a yielding packing.
THRESHOLDS = (1e-5, 1e-4, 1e-3, 1e-2)
CRITICAL = 1e-4
NEARLY = 0.95  # share of the limit load at which creep, and elastic strain, are read


def packing(run):
    """Return what names a prepared packing of this study."""
    return run.parameters["preparation_friction"], run.parameters["seed"]


def summarize(runs):
    """Return one row a ramp."""
    first = {packing(run): run for run in reversed(runs) if run.method == "CD" and run.parameters["network_seed"] == 0}
    order = sorted(runs, key=lambda run: (run.method, *packing(run), run.parameters["network_seed"]))
    return [_row(run, first.get(packing(run))) for run in order]


def _row(run, other):
    """Return one row. other: the CD run of the same packing that starts from the springs' own forces, in which all contacts that touch carry."""
    limit = statics.limit_loads((other or run).snapshots[0], run.pressure, run.attributes["depth"])[1]
    before = [snapshot for snapshot in run.snapshots if _at(run, snapshot) < limit]
    steps = list(zip(before, before[1:]))
    motion = [np.abs(b["position"] - a["position"]).max() / run.parameters["radius_mean"] for a, b in steps] or [np.nan]
    change = [_rms_difference(a, b) for a, b in steps] or [np.nan]
    nearest = min(run.snapshots, key=lambda snapshot: abs(_at(run, snapshot) - limit))
    contacts, disks, bound = statics.degrees_of_freedom(nearest, nearest["force_normal"] > 0)
    late = min(np.searchsorted(observables.load(run), NEARLY * limit), len(observables.load(run)) - 1)
    apart = [way for _, way in _apart(run, other)] if other is not None and other is not run and run.method == "CD" else []
    return {
        **summary.columns(run, "method", "preparation mu", "seed"), "network": run.parameters["network_seed"], "limit load": limit,
        **{f"load at {threshold:g}": observables.critical_load(run, threshold) for threshold in THRESHOLDS},
        f"gamma at {NEARLY:g} limit": np.abs(run.values("gamma"))[late],
        "snapshot at": _at(run, nearest), "sliding there": observables.sliding(nearest).sum(), "2M-3N there": bound,
        "contacts there": contacts, "disks held": disks,
        "unconverged before": int(run.values("unconverged_steps")[late]) if run.method == "CD" else 0,
        **summary.columns(run, "unsolved steps"),
        "force change, median": np.median(change), "force change, largest": np.max(change), "motion over R, median": np.median(motion),
        "networks apart at start": apart[0] if apart else np.nan, "networks apart at end": apart[-1] if apart else np.nan,
        "outcome": run.outcome}


def _at(run, snapshot):
    """Return sigma2/P0 asked for at a snapshot."""
    return float(np.interp(snapshot["time"], run.values("time"), observables.load(run)))


def _rms_difference(first, second):
    """Return the rms difference of the normal forces of two snapshots over their mean, contact by contact."""
    forces = observables.matched_forces(first, second)
    return float(np.sqrt(((forces[1] - forces[0])**2).mean()) / forces.mean())


def _apart(run, other):
    """Return [(sigma2/P0, difference of the normal forces from those of `other`)] at the loads below which neither has yielded."""
    end = min(observables.critical_load(run, CRITICAL), observables.critical_load(other, CRITICAL))
    return [(_at(run, a), _rms_difference(a, b)) for a, b in zip(run.snapshots, other.snapshots) if not _at(run, a) > end]


def draw(runs, rows, path):
    """Draw gamma under the ramp; the loads against the limit load; how far networks are from each other on the way."""
    fig, axes = plt.subplots(1, 3, figsize=(10.5, 4.2))
    table = pandas.DataFrame(rows)
    main = packing(next((run for run in runs if run.parameters["network_seed"] > 0), runs[0]))
    mine = [run for run in runs if packing(run) == main]
    own = {run.method: run for run in mine if run.parameters["network_seed"] == 0}
    limit = table[(table["preparation mu"] == main[0]) & (table.seed == main[1])]["limit load"].iloc[0]
    for method, words in (("CD", "CD, all networks"), ("MD", "MD, same packing")):
        for run in (run for run in mine if run.method == method):
            axes[0].semilogy(observables.load(run)[1:], np.abs(run.values("gamma"))[1:] + 1e-12, color=style.COLOUR[method], lw=0.8, label=words)
            words = None
    axes[0].axvline(limit, color="0.4", ls=":", label="static limit")
    axes[0].set(xlabel=r"$\sigma_2/P_0$", ylabel=r"$|\gamma|$", ylim=(1e-7, None))
    for method, threshold, marker in (("CD", CRITICAL, "o"), ("CD", 1e-2, "^"), ("MD", 1e-2, "D")):
        style.points(axes[1], table[table.method == method], "limit load", f"load at {threshold:g}", method, marker=marker, ms=5,
                     mfc="none" if threshold != CRITICAL else None, label=rf"{method}, $|\gamma|$ = {threshold:g}")
    ends = [table["limit load"].min(), table["limit load"].max()]
    axes[1].plot(ends, ends, color="0.4", ls=":", label="equal")
    axes[1].set(xlabel=r"static limit $\sigma_2/P_0$ (linear programme)", ylabel=r"$\sigma_2/P_0$ at which $|\gamma|$ passes the value in the legend")
    words = "CD: difference from the springs' network"
    for run in (run for run in mine if run.parameters["network_seed"] > 0 and "CD" in own):
        axes[2].plot(*zip(*_apart(run, own["CD"])), color=style.COLOUR["CD"], lw=0.8, label=words)
        words = None
    for method, ls in (("CD", "--"), ("MD", "-")):
        if run := own.get(method):
            steps = [(_at(run, b), _rms_difference(a, b)) for a, b in zip(run.snapshots, run.snapshots[1:]) if not _at(run, b) > limit]
            axes[2].plot(*zip(*steps), color="0.3", ls=ls, label=f"{method}: change from snapshot to snapshot")
    axes[2].axvline(limit, color="0.4", ls=":")
    axes[2].set(xlabel=r"$\sigma_2/P_0$", ylabel="rms difference of normal forces over their mean", ylim=(0, None))
    for axis in axes:
        axis.legend(loc="best", fontsize=6.5)
    style.finish(fig, path, f"Left and right: one packing, of seed {main[1]}, prepared with mu = {main[0]:g}; below 1e-7 the strain is the "
                 "error of the solver. Middle: each point is a run; on the dotted line it yields at its static limit.", runs)


POINTS = (
    (2, "in MD, [the packing's] choice is restricted, because the forces can only be modified by small motions of the grains.",
     "sections 2.3 and 4", "agrees"),
    (19, "This behavior is probably related to the indeterminacy of the forces in the CD method.", "section 4", "agrees in part"),
    (20, "The system can jump from one force configuration to another without any movement of the particles.", "section 4", "agrees in part"),
)


def quantities(table):
    cd, md = (table[table.method == method] for method in ("CD", "MD"))
    packing = ["preparation mu", "seed"]
    several = cd[cd.network > 0].groupby(packing).size()
    same = cd.set_index(packing).loc[several.idxmax()]  # one packing, from the most networks
    own = cd[cd.network == 0]  # one run a packing, from the springs' own forces
    alike = own[own["preparation mu"] == same.index[0][0]]
    over = cd["load at 0.0001"] / cd["limit load"]
    others = cd.groupby(packing)["load at 0.0001"].agg(lambda loads: loads.max() - loads.min())
    pairs = others[several[several < several.max()].index]
    apart, end = cd["networks apart at start"].dropna(), cd["networks apart at end"].dropna()
    assert not cd["unconverged before"].any() and (several[several < several.max()] == 1).all()
    return locals()
