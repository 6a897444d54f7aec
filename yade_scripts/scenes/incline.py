"""A block (a disk that may not turn) on a slope: it slides at g (sin t - mu cos t), or rests where tan t <= mu."""
import math

from yade import O, Quaternion, utils

from yade_scripts import bodies
from yade_scripts.scenes import Known, small


def build(full, folder):
    """Block of radius_mean on a slope that falls towards +x."""
    t, radius = math.radians(full["slope"]), full["radius_mean"]
    bodies.append_material("disk", full["friction"], full)
    length, thickness = 20 * full["gravity"] * (full["period"] * full["cycles"])**2 + 10 * radius, radius
    O.bodies.append(utils.box((0, 0, 0), (length, thickness, full["depth"] / 2), Quaternion((0, 0, 1), -t), fixed=True, material="disk"))
    mass = bodies.disk_mass(radius, full)
    height = thickness + radius - bodies.sag(mass * full["gravity"] * math.cos(t), full)
    block = bodies.append_disk((height * math.sin(t), height * math.cos(t)), radius, mass, "disk", blocked="zXYZ")

    def acceleration():
        velocity = O.bodies[block].state.vel
        return (velocity[0] * math.cos(t) - velocity[1] * math.sin(t)) / O.time

    driving, holding = math.sin(t), full["friction"] * math.cos(t)
    exact = full["gravity"] * math.copysign(max(abs(driving) - holding, 0), driving)
    return small(full, [Known("acceleration", "m/s^2", exact, acceleration)])
