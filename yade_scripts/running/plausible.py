"""Warns of rows that can be run but are probably a mistake, such as values in mm instead of m. Needs no YADE.

A warning does not stop the run.
"""
import math

from yade_scripts import parameters
from yade_scripts.theory import spring_limits

# Name: (least, most, hint). The ranges cover grains from dust to boulders, solids and foams, and gravity from asteroids to centrifuges.
USUAL = {
    "radius_mean": (1e-5, 5.0, "is it in mm? The unit is m"),
    "density": (50.0, 25000.0, "is it in g/cm^3? The unit is kg/m^3"),
    "depth": (1e-4, 100.0, "is it in mm? The unit is m"),
    "gravity": (1e-3, 1e4, "the unit is m/s^2: 9.81 on earth, 0 for no gravity"),
    "cd_dt": (1e-9, 0.1, "is it in ms? The unit is s"),
    "kn": (1e1, 1e12, "is it in MPa? The unit is N/m, the paper's 2 MPa at a depth of 1 m being 2e6"),
}
RADIANS = 1.6  # a slope below this value, but not 0, may be in radians
BLOW = 3.0  # smallest period, in units of the time in which P0 moves a grain by its size; below it inertia carries the load. Studies use 3.4 and more
IN_VAIN = "has no effect in the scene"  # batch.py finds these warnings in the logs of runs


def doubts(full):
    """Return warnings about a full row: sentences, each with name, value and remedy."""
    found = [f"{name} = {full[name]:g} {parameters.REGISTRY[name].unit} is unusual (usual: {least:g} to {most:g}): {remedy}"
             for name, (least, most, remedy) in USUAL.items() if full[name] and not least <= full[name] <= most]
    if 0 < abs(full["slope"]) < RADIANS:
        found.append(f"slope = {full['slope']:g} degree is nearly flat: is it in radians? The unit is degree")
    if full["scene"] == "biaxial" and full["loading"] != "ramp":
        grain = 2 * full["radius_mean"] * math.sqrt(full["density"] / parameters.pressure(full))
        if full["period"] < BLOW * grain:
            found.append(f"period = {full['period']:g} s is {full['period'] / grain:.2g} times the {grain:.2g} s in which P0 moves a grain by its "
                         f"size: the load acts like an impact; use at least {BLOW * grain:.2g} s")
    if full["method"] == "MD" and full["md_dt_factor"] > (limit := spring_limits.oscillator_limit(full["beta_n"] * full["damping_factor"])):
        found.append(f"md_dt_factor = {full['md_dt_factor']:g} is above {limit:.2g}, the limit of a single contact of such damping: impacts are "
                     "wrong")
    if full["method"] == "MD" and full["tangential_damping"] and not full["beta_n"] * full["damping_factor"]:
        found.append(f"tangential_damping = {full['tangential_damping']:g} has no effect without normal dashpots (beta_n, damping_factor), over "
                     "which it is given")
    if full["method"] == "CD":
        interval, usual = full["period"] / full["records_per_cycle"], parameters.defaults(full["scene"])
        if full["cd_dt"] != usual["cd_dt"] and full["cd_dt"] > interval:
            found.append(f"cd_dt = {full['cd_dt']:g} s is longer than the {interval:g} s between two samples, which is the step that is taken: lower "
                         "records_per_cycle for a longer one")
        if full["fixed_iterations"]:
            found += [f"{name} = {full[name]} has no effect with fixed_iterations = {full['fixed_iterations']}"
                      for name in ("method_cd", "max_iterations", "flow_tolerance") if full[name] != usual[name]]
    return found


class Watched(dict):
    """A full row that notes in `read` which of its values are read."""

    def __init__(self, full, read=None):
        super().__init__(full)
        self.read = set() if read is None else read

    def __getitem__(self, name):
        self.read.add(name)
        return super().__getitem__(name)

    def __or__(self, other):
        return Watched(dict(self) | other, self.read)


def ignored(full):
    """Return warnings about values of a Watched row that nothing has read in a run of its method, and that differ from the default of the scene."""
    usual = parameters.defaults(full["scene"])
    return [f"{name} = {value} {IN_VAIN} {full['scene']}" for name, value in parameters.read_by_method(full).items()
            if name not in full.read and value != usual[name]]


def unread(rows):
    """Return warnings about values in full rows that differ from the default of the scene, while the method of none of the rows reads them."""
    read, found = {name for full in rows for name in parameters.read_by_method(full)}, {}
    for full in rows:
        usual, legal = parameters.defaults(full["scene"]), parameters.registry(full["scene"])
        found |= {name: f"{name} = {value} has no effect: only method={legal[name].method} reads it" for name, value in full.items()
                  if name not in read and value != usual[name]}
    return list(found.values())
