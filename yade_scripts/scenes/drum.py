"""A drum half full of disks turns: how steep is the surface?

The drum is a ring of flat sides that turns about its axis; the disks are placed in rows at rest and settle while it turns. The slope follows
from the centre of mass of the bed: in a half-full drum the normal of the surface runs from it to the axis. The result is the mean slope
over the second half of the run, in degrees, and the mean profile of velocity in the middle of the bed. For the profile the disks nearer than R/4 to
the line from the axis through the centre of mass are sorted by their depth below the axis along this line, in layers one mean diameter thick. `speed`
is the mean velocity down the slope of all disks found in a layer, over omega R; in a bed that turns with the drum it is -depth/R. The layers begin
four diameters above the axis. Those at the surface and at the drum are filled in part: the mean depth of their disks is not that of their middle.
"""
import math

import numpy as np

from yade_scripts.errors import ParameterError
from yade_scripts.parameter import Parameter
from yade_scripts.scenes import Chart
from yade_scripts.scenes._converged import converged

TITLE = "Rotating drum"
KIND = "flow"
HORIZON = "The mean over the second half of the run, and over seeds; one run is off by the spread."
LEFT_OUT = "the third dimension; the curvature between the flat sides of the drum, of which there is one for about every two disks at the rim"
DEFAULTS = dict(method="CD", disks=500, friction=0.5, radius_spread=0.2, kn=2e7, beta_n=0.9, gravity=9.81, period=3.0, cd_dt=1e-3,
                records_per_cycle=30, tolerance=1e-3, max_iterations=2000)
POSITIVE = ("gravity",)
PARAMETERS = (Parameter("froude", 0.01, "1", "Froude number of the drum, omega^2 R/g, where R is its inner radius", low=1e-6, high=1),)
CHART = Chart(physics=("beta_n",), rolling=True)

EVERY = 0.01              # s between two measurements of the slope, or more if a step does not fit
SELDOM = 5                # measurements of the slope for one of the profile
ABOVE = 4                 # layers of the profile that lie above the axis
# Found with the parameters of SAME. _converged.py explains the form.
CONVERGED = {500: ({"slope": (26.5, 0.7)}, "CD, restitution 0, cd_dt 2.5e-4, tolerance 1e-3, seeds 1 to 8")}
SAME = dict(froude=0.01, friction=0.5, radius_spread=0.2, period=3.0, cycles=1, gravity=9.81, radius_mean=0.01)


def build(full, folder):
    """Build the drum about the origin, with the disks in rows in its lower part."""
    from yade import O
    from yade.wrapper import RotationEngine
    from yade_scripts.running import bodies, hooks, stage
    ground = stage.Ground(full)
    radius = ground.radius
    inner = radius * math.sqrt(2 * full["disks"] * (1 + full["radius_spread"]**2 / 3) / 0.8)  # half full at a solid fraction of 0.8
    sides = max(16, round(math.pi * inner / (2 * radius)))
    thick, half = 2 * radius, 1.02 * (inner + 2 * radius) * math.tan(math.pi / sides)
    ring = [ground.box(((inner + thick) * math.cos(angle), (inner + thick) * math.sin(angle)), (thick, half), angle)
            for angle in (2 * math.pi * k / sides for k in range(sides))]
    largest = radius * (1 + full["radius_spread"])
    pitch = 2.05 * largest
    most = int(inner / pitch) + 1
    places = [(pitch * i, pitch * j) for j in range(-most, most) for i in range(-most, most) if math.hypot(i, j) * pitch < inner - 1.1 * largest]
    if len(places) < full["disks"]:
        raise ParameterError(f"disks = {full['disks']}: so few do not fit, in loose rows, into a drum that they fill by half; take more "
                             f"disks, or a radius_spread below {full['radius_spread']:g}")
    ids = [ground.disk(place, radius=ground.draw_radius()).id for place in places[:full["disks"]]]  # from the lowest row upwards
    half_time, omega = full["period"] * full["cycles"] / 2, math.sqrt(full["froude"] * full["gravity"] / inner)
    depths = (np.arange(-ABOVE, math.ceil(inner / (2 * radius))) + 0.5) * 2 * radius / inner
    slopes, found, moved = [], [0.0] * len(depths), [0.0] * len(depths)  # found, moved: disks seen in each layer, and the sum of their speeds

    def look():
        if O.time < half_time:
            return
        x, y = bodies.centre_of_mass(ids)
        slopes.append(math.degrees(math.atan2(x, -y)))
        if len(slopes) % SELDOM == 1:
            _add_speeds([O.bodies[disk].state for disk in ids], np.array((x, y)) / math.hypot(x, y), inner / 4, depths * inner, found, moved)

    def slope():
        return sum(slopes) / len(slopes) if slopes else math.nan

    def speed():
        return np.divide(moved, found, out=np.full(len(depths), math.nan), where=np.array(found) > 0) / (omega * inner)

    extra = {"slope": ("degree", "slope of the bed, mean over the second half of the run", slope),
             "depth": ("R", "depth of the middle of each layer below the axis", depths),
             "seen": ("1", "disks in each layer, summed over all looks", lambda: np.array(found)),
             "speed": ("omega R", "mean velocity down the slope in each layer, over the second half of the run", speed)}
    scene = stage.small(full, converged(full, CONVERGED, SAME, extra), kept={"slopes": slopes, "found": found, "moved": moved}, extra=extra)
    turn = RotationEngine(ids=ring, rotationAxis=(0, 0, 1), angularVelocity=omega, rotateAroundZero=True, zeroPoint=(0, 0, 0))
    mover = [type(engine).__name__ for engine in O.engines].index("ContactDynamics" if full["method"] == "CD" else "NewtonIntegrator")
    O.engines = O.engines[:mover] + [turn] + O.engines[mover:] + [hooks.runner(look, virtPeriod=EVERY, label=hooks.MEASURING)]
    return scene


def _add_speeds(states, deep, reach, depths, found, moved):
    """Add 1 to `found` and the velocity down the slope [m/s] to `moved`, at its layer, for every disk nearer than `reach` [m] to the middle line.

    states: of the disks. deep: unit vector from the axis to the centre of mass. depths: of the middles of the layers [m].
    """
    place = np.array([(state.pos[0], state.pos[1]) for state in states])
    velocity = np.array([(state.vel[0], state.vel[1]) for state in states])
    down = np.array((deep[1], -deep[0]))
    layer = np.rint((place @ deep - depths[0]) / (depths[1] - depths[0])).astype(int)
    middle = (abs(place @ down) < reach) & (layer >= 0) & (layer < len(depths))
    for sums, weights in (found, None), (moved, (velocity @ down)[middle]):
        sums[:] = (sums + np.bincount(layer[middle], weights, len(depths))).tolist()
