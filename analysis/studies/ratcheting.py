"""Strain a cycle against the load over the static limit, for springs of three stiffnesses and for rigid contacts on the same packings."""

import numpy as np

from analysis import cycles, limits, observables, style, summary
from analysis.style import plt
from yade_scripts.tables import product

TITLE = "Ratcheting: stiffness, or rearrangement?"
QUESTION = ("Strain a cycle of springs that are 1, 10 and 100 times as stiff, and of rigid contacts on the same packings: does MD's ratcheting go to zero with "
            "1/k_n, so that rigid grains do not ratchet, and how near to its static limit does a packing have to be loaded?")
ORDER = 8  # in the report
LOADING = dict(loading="cosine", period=0.5, records_per_cycle=20, wall_mass_ratio=1.0, cycles=20)
SPRINGS = dict(method="MD", md_dt_factor=0.3, md_walls="force", **LOADING)
RIGID = dict(method="CD", cd_dt=2.5e-3, tolerance=1e-8, method_cd="auto", **LOADING)
# The largest load on more packings, since it comes near their limits; the stiffest on fewer, since a cycle of springs costs the root of the stiffness.
SEEDS, MORE = range(1, 7), range(1, 11)
ROWS = {"quick": product(stiffening=(1, 10), seed=1, delta_sigma=0.5, **SPRINGS) + product(stiffening=(1, 10), seed=1, delta_sigma=0.5, **RIGID),
        "full": [row for setting in (SPRINGS, RIGID)
                 for row in product(stiffening=(1, 10), seed=SEEDS, delta_sigma=0.3, **setting) + product(stiffening=(1, 10), seed=MORE, delta_sigma=0.5, **setting)
                 + product(stiffening=100, seed=SEEDS[:4], delta_sigma=0.5, **setting)]
        # The solver's error: the same at a hundredth and a hundred times the tolerance.
        + product(stiffening=1, seed=SEEDS[:4], delta_sigma=0.3, **RIGID | dict(tolerance=1e-10)) + product(stiffening=1, seed=SEEDS[:4], delta_sigma=0.3, **RIGID | dict(tolerance=1e-6))}

# Share of the contacts that a packing still has at the last load maximum, of those of the first, above which it strains by its springs alone
# (type I of Combe and Roux 2000); below it has rearranged (type II).
KEPT = 0.99


def summarize(runs):
    """Return one row a run.

    limit: largest sigma2/P0 that the contacts can carry (yade_scripts/theory/statics.py). rate: mean change of gamma a cycle over the last half
    of the cycles. kept: share of the contacts loaded at the first load maximum that are loaded at the last one.
    """
    order = sorted(runs, key=lambda run: (run.method != "MD", *(run.parameters[name] for name in ("delta_sigma", "stiffening", "seed"))))
    return [_row(run) for run in order]


def _row(run):
    full, found = run.parameters, cycles.of(run)
    return {"method": run.method, "dSigma": full["delta_sigma"], "stiffening": full["stiffening"], "seed": full["seed"],
            "tolerance": full["tolerance"] if run.method == "CD" else "", "limit": limits.static_limit(run), "load over limit": limits.load_over_limit(run),
            "cycles": len(found.number) if found else 0, "first cycle": float(found.rate[0]) if found else np.nan, "rate": np.nan if run.collapsed else cycles.late_rate(found),
            "last quarter over the one before": cycles.last_quarter(found), "kept": _kept(run),
            "unsolved steps": observables.unconverged_steps(run) if run.method == "CD" else "", "balance error": float(observables.balance_error(run)),
            "outcome": run.outcome}


def _kept(run):
    """Return the share of the contacts loaded at the first load maximum that are loaded at the last one; NaN where a run has one only."""
    if len(run.snapshots) < 4:
        return np.nan
    first, last = observables.matched_forces(run.snapshots[1], run.snapshots[-2])
    return float(((first > 0) & (last > 0)).sum() / (first > 0).sum())


def draw(runs, rows, path):
    """Draw the strain a cycle against the load over the limit, and against the stiffness, packing by packing."""
    fig, (left, right) = plt.subplots(1, 2, figsize=(9.5, 4.2), sharey=True)
    look = style.shades(row["stiffening"] for row in rows)
    rows = [row for row in rows if row["tolerance"] in ("", RIGID["tolerance"]) and np.isfinite(row["rate"])]
    for (method, stiffening), part in summary.groups(rows, lambda row: (row["method"], row["stiffening"])).items():
        kept = [row["kept"] >= KEPT for row in part]
        for whole, face in ((True, look[stiffening]), (False, "none")):
            chosen = [row for row, same in zip(part, kept) if same == whole]
            left.plot([row["load over limit"] for row in chosen], [abs(row["rate"]) for row in chosen], ls="", marker=style.MARKER[method], ms=5,
                      color=look[stiffening], mfc=face)
    handles = [plt.Line2D([], [], ls="", marker=style.MARKER[method], color=colour, label=f"{method}, {stiffening:g} $k_n$")
               for method in ("MD", "CD") for stiffening, colour in look.items()]
    handles.append(plt.Line2D([], [], ls="", marker="o", color="0.4", mfc="none", label="contacts lost"))
    left.axvline(1, color="k", lw=0.7, ls=":")
    left.set(yscale="log", xlabel=r"largest $\sigma_2/\sigma_1$ over the static limit of the packing", ylabel=r"strain a cycle $|\Delta\gamma|$, second half of the cycles")
    left.legend(handles=handles, fontsize=7)
    highest = max((row["dSigma"] for row in rows), default=0.0)
    for (method, load, seed), part in summary.groups(rows, lambda row: (row["method"], row["dSigma"], row["seed"])).items():
        if load == highest:
            part = sorted(part, key=lambda row: row["stiffening"])
            right.plot([row["stiffening"] for row in part], [abs(row["rate"]) for row in part], color=style.COLOUR[method], marker=style.MARKER[method],
                       ms=4, lw=0.8, label=method if seed == 1 else None)
    ends = np.array(sorted({row["stiffening"] for row in rows}), float)
    soft = [abs(row["rate"]) for row in rows if row["method"] == "MD" and row["stiffening"] == 1 and row["dSigma"] == highest]
    if soft:
        right.plot(ends, np.median(soft) / ends, color="k", ls=":", lw=0.9, label="inverse to $k_n$")
    right.set(xscale="log", xlabel="stiffness of the springs over the softest", title=rf"$\Delta\sigma$ = {highest:g}, packing by packing")
    right.legend()
    style.finish(fig, path, f"Open: less than {100 * KEPT:g} % of the loaded contacts of the first load maximum are loaded at the last.", runs)


def exponents(table, name, load):
    """Return the exponent b of |name| ~ k_n^b of every packing of MD that has all stiffnesses under a load, by least squares."""
    md = table[(table.method == "MD") & (table.dSigma == load)].dropna(subset=[name])
    several = md.stiffening.nunique()
    return np.array([np.polyfit(np.log(part.stiffening.astype(float)), np.log(part[name].abs()), 1)[0]
                     for _, part in md.groupby("seed") if len(part) == several and several > 1])


ANSWER = """
Not run yet.
"""
GIVEN = ()
POINTS = ()


def numbers(table):
    """Return the numbers of the text, from the summary table."""
    return {}
