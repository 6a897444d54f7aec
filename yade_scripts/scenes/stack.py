"""Disks on top of each other: every contact carries the weight above it."""
from yade import O, utils

from yade_scripts import bodies
from yade_scripts.scenes import Known, small


def build(full, folder):
    """`disks` equal disks, the springs of MD compressed by the weights from the start."""
    radius, count = full["radius_mean"], full["disks"]
    bodies.append_material("disk", full["friction"], full)
    O.bodies.append(utils.box((0, -radius, 0), (10 * radius, radius, full["depth"] / 2), fixed=True, material="disk"))
    mass = bodies.disk_mass(radius, full)
    weights = [(count - k) * mass * full["gravity"] for k in range(count)]
    height = 0.0
    for weight in weights:
        bodies.append_disk((0, height + radius - bodies.sag(weight, full)), radius, mass, "disk")
        height = O.bodies[-1].state.pos[1] + radius

    def worst():
        return max(abs(O.interactions[k, k + 1].phys.normalForce.norm() / weight - 1) for k, weight in enumerate(weights))

    return small(full, [Known("worst_force_error", "1", 0.0, worst)])
