"""How the limit, the strength and the strain under cycles depend on the number of grains."""

import matplotlib.pyplot as plt
import numpy as np

from analysis import cycles, limits, observables, style, summary
from yade_scripts.tables import product

TITLE = "The number of grains"
QUESTION = "Do the static limit, the load at which both methods yield, and MD's strain a cycle far below the limit depend on the number of disks?"
ORDER = 11  # in the report
WALLS = dict(wall_mass_ratio=1.0)
RAMP = dict(loading="ramp", ramp_rate=0.1, period=1.0, cycles=9, records_per_cycle=50, **WALLS)
CYCLES = dict(loading="cosine", delta_sigma=0.3, period=0.5, records_per_cycle=20, cycles=20, **WALLS)
SPRINGS = dict(method="MD", md_dt_factor=0.3, md_walls="force")
SIZES = {100: range(1, 11), 400: range(1, 11), 1600: range(1, 5), 6400: (1,)}


def _rows(sizes):
    return [row for disks, seeds in sizes.items() for method, step in ((SPRINGS, {}), (dict(method="CD", method_cd="auto"), {}))
            for loading, own in ((RAMP, dict(cd_dt=2e-3, tolerance=1e-7)), (CYCLES, dict(cd_dt=2.5e-3, tolerance=1e-8)))
            for row in product(disks=disks, seed=seeds, **loading | method | (own if method["method"] == "CD" else {}))]


ROWS = {"quick": _rows({100: (1, 2)}), "full": _rows(SIZES)}
YIELD = 1e-2  # |gamma| that counts as yielding


def summarize(runs):
    """Return one row a packing: its limit, the loads at which the methods yield, and the mean change of gamma a cycle over the last half of the cycles."""
    packings = summary.groups(runs, lambda run: (run.parameters["disks"], run.parameters["seed"]))
    return [_row(*key, several) for key, several in packings.items()]


def _row(disks, seed, several):
    found = {"disks": disks, "seed": seed, "static limit": limits.static_limit(several[0])}
    for run in several:
        if run.parameters["loading"] == "ramp":
            found[f"yields at, {run.method}"] = observables.critical_load(run, YIELD)
        else:
            made = cycles.of(run)
            found |= {f"first cycle, {run.method}": float(made.rate[0]) if made else np.nan, f"rate, {run.method}": np.nan if run.collapsed else cycles.late_rate(made)}
        if run.method == "CD":
            found["unsolved steps"] = max(found.get("unsolved steps", 0), observables.unconverged_steps(run))
    return found


def draw(runs, rows, path):
    """Draw limit and strength, and the strain a cycle, against the number of disks."""
    fig, (left, right) = plt.subplots(1, 2, figsize=(9.5, 4))
    disks = np.array([row["disks"] for row in rows], float)
    for name, marker, colour, shift in (("static limit", "_", "k", 1), ("yields at, MD", style.MARKER["MD"], style.COLOUR["MD"], 0.93),
                                        ("yields at, CD", style.MARKER["CD"], style.COLOUR["CD"], 1.07)):
        left.plot(shift * disks, [row.get(name, np.nan) for row in rows], ls="", marker=marker, ms=9 if marker == "_" else 4, color=colour,
                  label={"static limit": "static limit"}.get(name, f"{name[-2:]}: |gamma| = {YIELD:g}".replace("|gamma|", r"$|\gamma|$")))
    left.set(xscale="log", xlabel="disks", ylabel=r"$\sigma_2/P_0$")
    left.legend()
    for method in ("MD", "CD"):
        right.plot(disks, [abs(row.get(f"rate, {method}", np.nan)) for row in rows], ls="", marker=style.MARKER[method], ms=4, color=style.COLOUR[method], label=method)
    right.set(xscale="log", yscale="log", xlabel="disks", ylabel=r"strain a cycle $|\Delta\gamma|$, cycles 11 to 20")
    right.legend()
    style.finish(fig, path, r"A point a packing. Right: cycles of $\Delta\sigma$ = 0.3 at constant $\sigma_1$.", runs)


ANSWER = """
Not run yet.
"""
GIVEN = ()
POINTS = ()


def numbers(table):
    """Return the numbers of the text, from the summary table."""
    return {}
