"""Three numbers that describe one loading and unloading, for one packing and for several."""
import numpy as np

from analysis import cycles, observables
from yade_scripts.errors import ResultError

QUANTITIES = {"largest": r"largest $|\gamma|$", "width": "width of the loop", "remanent": r"remanent $|\gamma|$"}


def of(run):
    """Return the QUANTITIES of the loop of the first cycle: strains gamma [1]."""
    if len(ends := cycles.ends(run)) < 2:
        raise ResultError(run.path, "its first cycle is not complete", "run longer")
    part = slice(0, ends[1] + 1)
    gamma = run.values("gamma")[part] - run.values("gamma")[part][0]
    return {"largest": np.abs(gamma).max(), "width": observables.loop_width(gamma, run.values("sigma2")[part]),
            "remanent": abs(gamma[-1])}


def spread(runs, scale=1.0):
    """Return {quantity: mean, quantity_low, quantity_high} of the runs' loops, strains times `scale`."""
    found, loops = {}, [of(run) for run in runs]
    for name in QUANTITIES:
        values = scale * np.array([loop[name] for loop in loops])
        found |= {name: values.mean(), f"{name}_low": values.min(), f"{name}_high": values.max()}
    return found


def draw_spread(axes, table, x, name, **style):
    """Draw a quantity against the column x of a pandas table, with the range over the packings, on `axes`."""
    middle = table[name]
    axes.errorbar(table[x], middle, yerr=[(middle - table[f"{name}_low"]).clip(lower=0), (table[f"{name}_high"] - middle).clip(lower=0)],
                  capsize=2, **style)
