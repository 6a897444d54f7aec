"""A disk hits a floor without gravity and leaves it with a known share of its speed."""
import math

from yade import O, utils

from yade_scripts import bodies
from yade_scripts.scenes import Known, small


def build(full, folder):
    """CD: Newton's restitution. MD: the damped oscillator of eq. 5 over the half period of a contact."""
    radius = full["radius_mean"]
    bodies.append_material("disk", full["friction"], full)
    O.bodies.append(utils.box((0, -radius, 0), (10 * radius, radius, full["depth"] / 2), fixed=True, material="disk"))
    height = radius + full["speed"] * full["period"] * full["cycles"] / 4
    disk = bodies.append_disk((0, height), radius, bodies.disk_mass(radius, full), "disk", (0, -full["speed"]))
    state, beta = O.bodies[disk].state, full["beta_n"]
    exact = full["restitution"] if full["method"] == "CD" else math.exp(-math.pi * beta / math.sqrt(1 - beta**2))
    return small(full, [Known("restitution", "1", exact, lambda: state.vel[1] / full["speed"])])
