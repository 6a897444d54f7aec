"""Spheres on each other in a square tube without friction: each is pushed to two walls by its neighbours, with forces known by hand."""
import math

from yade_scripts import parameters
from yade_scripts.errors import ParameterError
from yade_scripts.parameter import Parameter
from yade_scripts.scenes import Chart, Known

TITLE = "Spheres in a square tube"
KIND = "spheres in space"
HORIZON = "Any time: nothing moves once springs have come to rest."
LEFT_OUT = "friction, with which the walls would carry a part of the weight that depends on the past"
DEFAULTS = dict(method="CD", disks=20, radius_spread=0.0, friction=0.0, gravity=9.81, beta_n=0.5, period=0.2, records_per_cycle=10, tolerance=1e-12,
                max_iterations=10**6)
POSITIVE = ("gravity",)
IN_SPACE = True
PARAMETERS = (Parameter("tube_width", 3.0, "1", "inner width of the tube over the radius", above=2, high=3.2),)
CHART = Chart(sizes=(4, 16, 64))


def check(full):
    """Check that the forces are those known by hand."""
    for name in ("friction", "restitution"):
        if full[name]:
            raise ParameterError(f"{name} = {full[name]}: the forces in the tube are known without it only: set {name} = 0")
    if full["disks"] < 2:
        raise ParameterError(f"disks = {full['disks']}: a tube needs two spheres at least")
    if full["disks"] * parameters.sphere_sags(full) > 0.1 * full["radius_mean"]:
        raise ParameterError(f"kn = {full['kn']}: the weight of all spheres would compress a spring by more than a tenth of a radius; take "
                             "stiffer ones")


def build(full, folder):
    """Build the spheres in opposite corners in turn. A contact below the weight W pushes its two spheres to the walls by W 2 d/rise along x and
    along z, with centres that are 2 d apart along each. Springs are compressed by these forces from the start."""
    from yade_scripts.running import bodies, stage
    ground = stage.Ground(full)
    radius, half = ground.radius, full["tube_width"] * ground.radius / 2
    d = half - radius
    rise = math.sqrt(4 * radius**2 - 8 * d**2)
    walls = {(axis, side): ground.wall(side * half, axis) for axis in (0, 2) for side in (-1, 1)}
    floor, count = ground.wall(0, 1), full["disks"]
    weight = ground.mass * full["gravity"]
    above = [weight * (count - 1 - k) for k in range(count)]  # what the contact of sphere k with the next carries
    side = [2 * d / rise * (carried + before) for carried, before in zip(above, [0.0, *above])]

    aside, height, ids = [d + ground.sag(force) for force in side], radius - ground.sag(count * weight), []
    for k in range(count):
        corner = aside[k] if k % 2 else -aside[k]
        ids.append(ground.sphere((corner, height, corner)).id)
        if k + 1 < count:
            height += math.sqrt((2 * radius - ground.sag(above[k] * 2 * radius / rise))**2 - 2 * (aside[k] + aside[k + 1])**2)

    def worst():
        """Return the largest error of a wall's force on a sphere, over its exact value."""
        return max(abs(bodies.normal_force(walls[axis, 1 if k % 2 else -1], body) / side[k] - 1) for k, body in enumerate(ids) for axis in (0, 2))

    return stage.small(full, [
        Known("worst_force_error", "1", 0.0, worst, source="balance of each sphere"),
        Known("on_the_floor", "N", count * weight, lambda: bodies.normal_force(floor, ids[0]), source="the weight of all")])
