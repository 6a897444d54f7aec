"""Three numbers that describe one loading and unloading, for one packing and for several."""
from dataclasses import dataclass

import numpy as np

from analysis import observables


@dataclass(frozen=True)
class Loop:
    """The loop of the first cycle; strains are gamma [1].

    largest: |gamma| where it is largest. width: loop_width. remanent: |permanent_strain|.
    """
    largest: float
    width: float
    remanent: float


QUANTITIES = {"largest": r"largest $|\gamma|$", "width": "width of the loop", "remanent": r"remanent $|\gamma|$"}


def of(run):
    part = observables.cycle_range(run)
    gamma = run.values("gamma")[part] - run.values("gamma")[part][0]
    return Loop(float(np.abs(gamma).max()), observables.loop_width(gamma, run.values("sigma2")[part]),
                float(abs(observables.permanent_strain(gamma))))


def spread(runs, scale=1.0):
    """Return {quantity: mean, quantity_low, quantity_high} of the runs' loops, strains times `scale`."""
    found, loops = {}, [of(run) for run in runs]
    for name in QUANTITIES:
        values = scale * np.array([getattr(loop, name) for loop in loops])
        found |= {name: float(values.mean()), f"{name}_low": float(values.min()), f"{name}_high": float(values.max())}
    return found


def draw_spread(axes, x, rows, name, **style):
    """Draw the quantity of the rows against x with the range over the packings, on `axes`."""
    middle, low, high = (np.array([row[column] for row in rows]) for column in (name, f"{name}_low", f"{name}_high"))
    axes.errorbar(x, middle, yerr=[np.maximum(middle - low, 0), np.maximum(high - middle, 0)], capsize=2, **style)
