"""A disk thrown flat on a floor slides, then rolls at 2/3 of its speed: its angular momentum about the contact point stays."""
from yade import O, utils

from yade_scripts import bodies
from yade_scripts.scenes import Known, small


def build(full, folder):
    """Disk of radius_mean at `speed` along +x; it rolls after speed/(3 mu g)."""
    radius, time = full["radius_mean"], full["period"] * full["cycles"]
    bodies.append_material("disk", full["friction"], full)
    length = 2 * full["speed"] * time + 10 * radius
    O.bodies.append(utils.box((0, -radius, 0), (length, radius, full["depth"] / 2), fixed=True, material="disk"))
    mass = bodies.disk_mass(radius, full)
    disk = bodies.append_disk((0, radius - bodies.sag(mass * full["gravity"], full)), radius, mass, "disk", (full["speed"], 0))
    state = O.bodies[disk].state
    return small(full, [
        Known("final_speed", "m/s", 2 / 3 * full["speed"], lambda: state.vel[0]),
        Known("slip", "m/s", 0.0, lambda: state.vel[0] + radius * state.angVel[2]),
    ])
