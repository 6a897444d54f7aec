"""The static limit of a run's packing: the largest sigma2/P0 that the contacts it starts with can carry on the run's stress path."""

import numpy as np

from yade_scripts.results.reader import ResultError
from yade_scripts.theory import statics

_known = {}  # linear programmes of a second each; many runs start from one packing


def static_limit(run):
    """Return the limit (yade_scripts/theory/statics.py); NaN where the contacts do not hold the walls at all."""
    first, path = run.snapshots[0], run.parameters["stress_path"]
    key = first["contact_point"].tobytes(), run.pressure, path
    if key not in _known:
        try:
            _known[key] = statics.limit_loads(first, run.pressure, run.attributes["depth"], path)[1]
        except ResultError:
            _known[key] = np.nan
    return _known[key]


def load_over_limit(run):
    """Return the largest sigma2 of repeated loading over that limit."""
    return (1 + run.parameters["delta_sigma"]) / static_limit(run)
