"""The static limit of a run's packing: the largest load that the contacts it starts with can carry.

Forces in balance stay in balance if all are multiplied by one number, so the contacts limit the ratio sigma2/sigma1. This ratio does not depend on
which stress is held constant while sigma2 rises; the load sigma2/P0 at which a run reaches it does.
"""
import numpy as np

from yade_scripts import parameters
from yade_scripts.errors import ResultError
from yade_scripts.theory import statics

_known = {}  # results of linear programmes that take a second each; many runs start from one packing


def stress_ratio(load, stress_path):
    """Return sigma2/sigma1 where sigma2 = load P0: sigma1 is P0 on the path "constant", 2 P0 - sigma2 on "mean"."""
    return load / (2 - load) if stress_path == "mean" else load


def static_limit(run, snapshot=0):
    """Return the largest sigma2/P0 on the run's stress path that the contacts of a snapshot can carry (yade_scripts/theory/statics.py).

    NaN if they cannot hold the walls, or if there are no loaded walls.
    """
    contacts, path = run.snapshots[snapshot], run.parameters["stress_path"]
    key = contacts["contact_point"].tobytes(), contacts["contact_friction"].tobytes(), run.pressure, path
    if key not in _known:
        try:
            _known[key] = statics.limit_loads(contacts, run.pressure, run.attributes["depth"], path)[1]
        except ResultError:
            _known[key] = np.nan
    return _known[key]


def over_limit(run, load):
    """Return sigma2/sigma1 at sigma2 = load P0 over the largest that the packing's contacts can carry."""
    path = run.parameters["stress_path"]
    return stress_ratio(load, path) / stress_ratio(static_limit(run), path)


def load_over_limit(run):
    """Return the largest sigma2/sigma1 of the loading over the largest that the packing's contacts can carry."""
    return over_limit(run, parameters.highest_load(run.parameters))
