"""What breaks a rigid packing under a ramp: the load, against the initial force network, the packing, and limit analysis.

The static theorem (analysis/statics.py) gives the largest sigma2 at which the contacts of a packing admit any forces: a number of
its geometry and friction alone, from a linear programme that knows no dynamics, compared here with the load at which it moves.
"""

import numpy as np

from analysis import observables, statics, style
from analysis.style import plt

TITLE = "The critical load, and what it depends on"
QUESTION = ("Is Contact Dynamics' resistance to a collapse (Fig. 5) a matter of which of the admissible force networks it starts from? "
            "The ramp of eq. 1 from many networks of one packing, against the spread over packings and the ramp of MD.")
TABLES = {"quick": ("quick/critical_load.txt",), "full": ("critical_load.txt",)}

# |gamma| that counts as motion. CRITICAL is far above the solver's creep below the limit, and below what the contacts that close in
# a yielding packing can do for it.
THRESHOLDS = (1e-5, 1e-4, 1e-3, 1e-2)
CRITICAL = 1e-4
NEARLY = 0.95  # share of the limit load at which creep, and elastic strain, are read


def packing(run):
    """What names a prepared packing of this study."""
    return run.parameters["preparation_friction"], run.parameters["seed"]


def load(run):
    """sigma2/P0 asked for, sample by sample."""
    return run.values("sigma2_goal") / run.pressure


def summarize(runs):
    """One row a ramp."""
    first = {packing(run): run for run in reversed(runs) if run.method == "CD" and run.parameters["network_seed"] == 0}
    order = sorted(runs, key=lambda run: (run.method, *packing(run), run.parameters["network_seed"]))
    return [_row(run, first.get(packing(run))) for run in order]


def _row(run, other):
    """other: the CD run of the same packing that starts from the springs' own forces."""
    limit = statics.limit_loads(run.snapshots[0], run.pressure, run.attributes["depth"])[1]
    before = [snapshot for snapshot in run.snapshots if _at(run, snapshot) < limit]
    motion, change = zip(*(_between(a, b, run) for a, b in zip(before, before[1:]))) if len(before) > 1 else ((np.nan,), (np.nan,))
    nearest = min(run.snapshots, key=lambda snapshot: abs(_at(run, snapshot) - limit))
    contacts, disks, bound = statics.degrees_of_freedom(nearest, nearest["force_normal"] > 0)
    late = min(np.searchsorted(load(run), NEARLY * limit), len(load(run)) - 1)
    apart = _apart(run, other) if other is not None and other is not run and run.method == "CD" else []
    return {
        "method": run.method, "preparation mu": run.parameters["preparation_friction"], "seed": run.parameters["seed"],
        "network": run.parameters["network_seed"], "limit load": limit,
        **{f"load at {threshold:g}": observables.critical_load(run, threshold) for threshold in THRESHOLDS},
        f"gamma at {NEARLY:g} limit": float(np.abs(run.values("gamma"))[late]),
        "snapshot at": _at(run, nearest), "sliding there": int(observables.sliding(nearest).sum()), "2M-3N there": bound,
        "contacts there": contacts, "disks held": disks,
        "unconverged before": int(run.values("unconverged_steps")[late]) if run.method == "CD" else 0,
        "force change, median": float(np.median(change)), "force change, largest": float(np.max(change)),
        "motion over R, median": float(np.median(motion)),
        "networks apart at start": apart[0][1] if apart else np.nan, "networks apart at end": apart[-1][1] if apart else np.nan,
        "outcome": run.outcome}


def _at(run, snapshot):
    """sigma2/P0 asked for at a snapshot."""
    return float(np.interp(snapshot["time"], run.values("time"), load(run)))


def _rms_difference(first, second):
    """rms difference of the normal forces of two snapshots over their mean, contact by contact."""
    forces = observables.matched_forces(first, second)
    return float(np.sqrt(((forces[1] - forces[0])**2).mean()) / forces.mean())


def _between(first, second, run):
    """(largest displacement over the mean radius, force change) from one snapshot to the next."""
    moved = np.abs(second["position"] - first["position"]).max() / run.parameters["radius_mean"]
    return float(moved), _rms_difference(first, second)


def _apart(run, other):
    """[(sigma2/P0, difference of the normal forces from those of `other`)] at the loads below which neither has yielded."""
    end = min(observables.critical_load(run, CRITICAL), observables.critical_load(other, CRITICAL))
    return [(_at(run, a), _rms_difference(a, b)) for a, b in zip(run.snapshots, other.snapshots) if not _at(run, a) > end]


def draw(runs, rows, path):
    """gamma under the ramp; loads against the limit load; how far networks are from each other on the way."""
    fig, axes = plt.subplots(1, 3, figsize=(10.5, 4.2))
    main = packing(next((run for run in runs if run.parameters["network_seed"] > 0), runs[0]))
    mine = [run for run in runs if packing(run) == main]
    for method in ("CD", "MD"):
        for k, run in enumerate(run for run in mine if run.method == method):
            axes[0].semilogy(load(run)[1:], np.abs(run.values("gamma"))[1:] + 1e-12, color=style.COLOUR[method], lw=0.8,
                             label=f"{method}, {'all networks' if method == 'CD' else 'same packing'}" if k == 0 else None)
    limit = next(row["limit load"] for row in rows if (row["preparation mu"], row["seed"]) == main)
    axes[0].axvline(limit, color="0.4", ls=":", label="static limit of the geometry")
    axes[0].set(xlabel=r"$\sigma_2/P_0$", ylabel=r"$|\gamma|$", ylim=(1e-9, None))
    for method, threshold, marker in (("CD", CRITICAL, "o"), ("CD", 1e-2, "^"), ("MD", 1e-2, "D")):
        chosen = [row for row in rows if row["method"] == method]
        axes[1].plot([row["limit load"] for row in chosen], [row[f"load at {threshold:g}"] for row in chosen], ls="", marker=marker,
                     mfc="none" if threshold != CRITICAL else None, color=style.COLOUR[method], ms=5,
                     label=rf"{method}, $|\gamma|$ = {threshold:g}")
    ends = [min(row["limit load"] for row in rows), max(row["limit load"] for row in rows)]
    axes[1].plot(ends, ends, color="0.4", ls=":", label="equal")
    axes[1].set(xlabel=r"static limit $\sigma_2/P_0$ (linear programme)", ylabel=r"$\sigma_2/P_0$ at which $|\gamma|$ passes")
    start = next((run for run in mine if run.method == "CD" and run.parameters["network_seed"] == 0), None)
    for k, run in enumerate(run for run in mine if run.parameters["network_seed"] > 0 and start):
        at, apart = zip(*_apart(run, start))
        axes[2].plot(at, apart, color=style.COLOUR["CD"], lw=0.8, label="CD networks from the springs' own" if k == 0 else None)
    for method, ls in (("CD", "--"), ("MD", "-")):
        run = next((run for run in mine if run.method == method and run.parameters["network_seed"] == 0), None)
        if run is not None:
            steps = [(a, b) for a, b in zip(run.snapshots, run.snapshots[1:]) if not _at(run, b) > limit]
            axes[2].plot([_at(run, b) for _, b in steps], [_rms_difference(a, b) for a, b in steps], color="0.3", ls=ls,
                         label=f"{method}: change from snapshot to snapshot")
    axes[2].axvline(limit, color="0.4", ls=":")
    axes[2].set(xlabel=r"$\sigma_2/P_0$", ylabel="rms difference of normal forces over their mean", ylim=(0, None))
    for axis in axes:
        axis.legend(loc="best", fontsize=6.5)
    style.finish(fig, runs, path, f"Left and right: the packing of seed {main[1]} prepared with $\\mu$ = {main[0]:g}.", foot=0.13)


def _column(rows, name):
    return np.array([row[name] for row in rows])


def _span(rows, name, digits=3):
    values = _column(rows, name)
    return f"{np.nanmin(values):.{digits}f} to {np.nanmax(values):.{digits}f}"


def answer(rows):
    """Networks against packings, against the static limit, against MD; and what moves below it."""
    cd, md = ([row for row in rows if row["method"] == method] for method in ("CD", "MD"))
    if not cd:
        return "No ramp of CD has finished."
    name, creep = f"load at {CRITICAL:g}", f"gamma at {NEARLY:g} limit"
    other = next((row for row in cd if row["network"] > 0), cd[0])
    same = [row for row in cd if (row["preparation mu"], row["seed"]) == (other["preparation mu"], other["seed"])]
    alike = [row for row in cd if row["network"] == 0 and row["preparation mu"] == same[0]["preparation mu"]]
    ratio = _column(cd, name) / _column(cd, "limit load")
    text = [
        f"From {len(same)} force networks of one packing CD passes |gamma| = {CRITICAL:g} at sigma2/P0 = {np.nanmean(_column(same, name)):.4f} "
        f"with a standard deviation of {np.nanstd(_column(same, name)):.4f}; from {len(alike)} packings prepared alike it does so at "
        f"{_span(alike, name)}.",
        f"A linear programme gives the largest load under which the contacts of a packing, as prepared, admit any forces at all: CD's critical "
        f"load is {np.nanmin(ratio):.3f} to {np.nanmax(ratio):.3f} of that limit in {len(cd)} runs"
        + (": geometry and friction set it, not the network at the start." if np.nanmax(np.abs(ratio - 1)) < 0.05 else "."),
        f"At {NEARLY:g} of the limit CD has strained by {np.nanmedian(_column(cd, creep)):.0e} (median, the solver's creep)"
        + (f", MD by {np.nanmedian(_column(md, creep)):.0e}." if md else "."),
        f"At the snapshot nearest the limit sliding contacts over the bound 2M - 3N are {_sliding(cd)} in CD"
        + (f", {_sliding(md)} in MD." if md else "."),
        f"Below it the normal forces of CD change by {100 * np.nanmedian(_column(cd, 'force change, median')):.1f} % of their mean from snapshot to "
        f"snapshot (median of the rms), at most by {100 * np.nanmax(_column(cd, 'force change, largest')):.0f} %, while the grain that moves "
        f"most moves by {np.nanmedian(_column(cd, 'motion over R, median')):.0e} R (median)"
        + (f"; MD's by {100 * np.nanmedian(_column(md, 'force change, median')):.1f} % with "
           f"{np.nanmedian(_column(md, 'motion over R, median')):.0e} R." if md else ".")]
    apart = [row for row in cd if np.isfinite(row["networks apart at start"])]
    if apart:
        text.append(f"Networks that are {100 * np.median(_column(apart, 'networks apart at start')):.0f} % of the mean force apart at the start are "
                    f"{100 * np.median(_column(apart, 'networks apart at end')):.0f} % apart at the last snapshot before the packing yields: the "
                    "set of admissible forces shrinks under them.")
    text.append(f"Thresholds, for the one packing: {', '.join(f'{np.nanmedian(_column(same, _name(t))):.3f} at {t:g}' for t in THRESHOLDS)}. What "
                "comes after the first motion belongs to new contacts. Evidence: one ramp rate; "
                f"{int(_column(cd, 'unconverged before').sum())} steps missed the solver's tolerance before {NEARLY:g} of the limit; "
                "the limit takes Coulomb's friction as if it were associated, and is an upper bound.")
    return " ".join(text)


def _name(threshold):
    return f"load at {threshold:g}"


def _sliding(rows):
    shares = [row["sliding there"] / row["2M-3N there"] for row in rows if row["2M-3N there"] > 0]
    return f"{np.median(shares):.2f} (median; {min(shares):.2f} to {max(shares):.2f})" if shares else "not defined"
