"""What the studies share: columns of their tables, and groups of runs."""
import functools

import numpy as np

from analysis import cycles, limits, observables
from yade_scripts import parameters

# Columns that several tables have, as functions of a run; every other name is that of a parameter.
# static limit: largest sigma2/P0 that the packing's contacts can carry on the stress path (yade_scripts/theory/statics.py).
# load over limit: largest sigma2/sigma1 of repeated loading over the largest that the contacts can carry.
# cycles: completed ones; asked: those that the run was to have. late rate: strain a cycle over the last half of the cycles; see cycles.py for this
# and for the last quarter's rate.
COLUMNS = {
    "method": lambda run: run.method,
    "law": lambda run: run.parameters["tangential_law"],
    "mu": lambda run: run.parameters["friction"],
    "preparation mu": lambda run: run.parameters["preparation_friction"],
    "P0/k_n": lambda run: run.parameters["pressure_ratio"] / run.parameters["stiffening"],
    "k_n over the usual": lambda run: run.parameters["stiffening"],
    "dSigma": lambda run: run.parameters["delta_sigma"],
    "asked": lambda run: run.parameters["cycles"],
    "static limit": limits.static_limit,
    "load over limit": limits.load_over_limit,
    "cycles": lambda run: len(cycles.of(run).number),
    "first cycle": lambda run: cycles.of(run).first,
    "late rate": lambda run: np.nan if run.collapsed else cycles.of(run).late_rate,
    "last quarter's rate over the one before": lambda run: cycles.of(run).last_quarter,
    "collapses after": lambda run: run.values("cycle")[-1] if run.collapsed else np.nan,
    "gamma at the end": lambda run: run.values("gamma")[-1],
    "largest |gamma|": lambda run: np.abs(run.values("gamma")).max(),
    "unsolved steps": lambda run: observables.unconverged_steps(run) if run.method == "CD" else "",
    "balance error": observables.balance_error,
    "stress error/P0": observables.stress_error,
    "outcome": lambda run: run.outcome}


def columns(run, *names):
    """Return {name: value} of a run: columns of COLUMNS, or parameters, in whose names a blank stands for an underscore.

    Raise ParameterError for a name that is neither.
    """
    if unknown := [name for name in names if name not in COLUMNS and name.replace(" ", "_") not in run.parameters]:
        raise parameters.ParameterError(f"{', '.join(map(repr, unknown))}: no parameter of the scene {run.parameters['scene']} and no column; "
                                        f"columns are {', '.join(COLUMNS)}")
    return {name: COLUMNS[name](run) if name in COLUMNS else run.parameters[name.replace(" ", "_")] for name in names}


def each(row):
    """Decorate row(run): return a function summarize(runs) that returns one row for each run."""
    return functools.wraps(row)(lambda runs: [row(run) for run in runs])


def groups(items, key, ordered=True):
    """Return {key(item): [items]} in the order of the keys, or of the items."""
    found = {}
    for item in items:
        found.setdefault(key(item), []).append(item)
    return dict(sorted(found.items())) if ordered else found


def order(runs, *names):
    """Return the runs sorted by these columns, MD before CD."""
    return sorted(runs, key=lambda run: [value != "MD" if name == "method" else value for name, value in columns(run, *names).items()])


def by(runs, *names):
    """Return {value, or values, of these columns: [runs]}, in the order of `order`."""
    values = lambda run: tuple(columns(run, *names).values())
    return groups(order(runs, *names), values if len(names) > 1 else lambda run: values(run)[0], ordered=False)
