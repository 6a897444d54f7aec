"""Loose rows of disks fall into a box: how high do they stand in it at rest?

The rows are placed above the floor, with gaps of a tenth of a diameter between the largest disks and with random shifts; all start to fall at time
0. The height is twice that of the centre of mass, over the height at which the disks would fill the box without pores. So it is the inverse of the
solid fraction.
"""
import math

from yade_scripts import parameters
from yade_scripts.parameter import Parameter
from yade_scripts.scenes import Chart
from yade_scripts.scenes._converged import converged

TITLE = "Filling of a box"
KIND = "flow"
HORIZON = "At rest, about five times the fall from the highest row on, and as a mean over seeds; one run is off by the spread."
LEFT_OUT = "the third dimension and air; the way in which a real box is filled, since all rows fall at once"
DEFAULTS = dict(method="CD", disks=500, friction=0.5, radius_spread=0.2, kn=2e7, beta_n=0.9, gravity=9.81, records_per_cycle=20, tolerance=1e-3,
                max_iterations=2000)
POSITIVE = ("gravity",)
PARAMETERS = (Parameter("box_aspect", 1.0, "1", "height of the filling over its width, about", low=0.1, high=10),)
CHART = Chart(physics=("beta_n",), rolling=True)

# Found with the parameters of SAME. _converged.py explains the form.
CONVERGED = {500: ({"height": (1.287, 0.010)}, "CD, restitution 0, cd_dt 2.5e-4, tolerance 1e-3, seeds 1 to 8")}
SAME = dict(box_aspect=1.0, friction=0.5, radius_spread=0.2, period=1.0, cycles=1, gravity=9.81, radius_mean=0.01)


def build(full, folder):
    """Build the rows above a floor at y = 0, between walls at x = 0 and at the width of the box."""
    from yade_scripts.running import bodies, stage
    ground = stage.Ground(full)
    radius = ground.radius
    pitch = 2.2 * radius * (1 + full["radius_spread"])
    columns = max(2, round(parameters.width(full, full["box_aspect"]) / pitch))
    span, rows = columns * pitch, math.ceil(full["disks"] / columns)
    ground.box((span / 2, -radius), (span / 2 + 2 * radius, radius))
    for x in (-radius, span + radius):
        ground.box((x, rows * pitch / 2), (radius, rows * pitch / 2 + 2 * radius))
    ids = []
    for k in range(full["disks"]):
        r = ground.draw_radius()
        place = [pitch * (n + 0.5) + ground.draw.uniform(-1, 1) * (pitch / 2 - r) for n in (k % columns, k // columns)]
        ids.append(ground.disk(place, radius=r).id)
    solid = bodies.mean_mass() * len(ids) / (full["density"] * full["depth"] * span)  # height without pores [m]

    def height():
        return 2 * bodies.centre_of_mass(ids)[1] / solid

    extra = {"height": ("1", "twice the height of the centre of mass over that of the disks without pores", height)}
    return stage.small(full, converged(full, CONVERGED, SAME, extra), kept={}, extra=extra)
