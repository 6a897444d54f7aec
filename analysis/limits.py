"""The limits of a run's packing: the largest load that the contacts it starts with can carry, and those of load cycles.

Forces in balance stay in balance if all are multiplied by one number, so the contacts limit the ratio sigma2/sigma1. This ratio does not depend on
which stress is held constant while sigma2 rises; the load sigma2/P0 at which a run reaches it does.
"""
import numpy as np

from yade_scripts import parameters
from yade_scripts.errors import ResultError
from yade_scripts.theory import shakedown, statics

_known = {}  # results of linear programmes that take a second or more; many runs start from one packing


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


def of_cycles(run):
    """Return the shakedown.Limits of the packing that a run starts from, each as dSigma of the run's stress path.

    Only `static` holds for rigid contacts; the others are those of springs of the row's k_t/k_n that carry the forces of the first snapshot.
    Raise ResultError if the run has no such packing.
    """
    if not run.snapshots:
        raise ResultError(run.path, "it has no snapshot of the packing at its start", "run it again")
    packing, ratio, path = run.snapshots[0], run.parameters["kt_over_kn"], run.parameters["stress_path"]
    arrays = (packing[name].tobytes() for name in ("box", "contact_point", "contact_friction", "force_normal", "force_tangential"))
    key = *arrays, run.pressure, ratio, path
    if key not in _known:
        try:
            _known[key] = shakedown.limits(packing, run.pressure, run.attributes["depth"], ratio, path)
        except ResultError as error:
            raise ResultError(run.path, error.what, error.remedy) from None
    return _known[key]


def over_limit(run, load):
    """Return sigma2/sigma1 at sigma2 = load P0 over the largest that the packing's contacts can carry."""
    path = run.parameters["stress_path"]
    return stress_ratio(load, path) / stress_ratio(static_limit(run), path)


def load_over_limit(run):
    """Return the largest sigma2/sigma1 of the loading over the largest that the packing's contacts can carry."""
    return over_limit(run, parameters.highest_load(run.parameters))
