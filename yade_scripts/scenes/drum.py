"""A drum half full of disks turns: how steep is the surface?

The drum is a ring of flat sides that turns about its axis; the disks are placed in rows at rest and settle while it turns. The slope follows
from the centre of mass of the bed: in a half-full drum the normal of the surface runs from it to the axis. The result is the mean slope
over the second half of the run, in degrees.
"""
import math

from yade_scripts import parameters
from yade_scripts.parameters import Parameter
from yade_scripts.scenes import Chart, converged

TITLE = "Rotating drum"
KIND = "flow"
HORIZON = "The mean over the second half of the run, and over seeds; one run is off by the spread."
LEFT_OUT = "the third dimension; the curvature between the flat sides of the drum, of which there is one for about every two disks at the rim"
DEFAULTS = dict(method="CD", disks=500, friction=0.5, radius_spread=0.2, kn=2e7, beta_n=0.9, gravity=9.81, period=3.0, cd_dt=1e-3,
                records_per_cycle=30, tolerance=1e-3, max_iterations=2000)
PARAMETERS = (Parameter("froude", 0.01, "1", "Froude number of the drum, omega^2 R/g, where R is its inner radius", low=1e-6, high=1),)
CHART = Chart(physics=("beta_n",), rolling=True)

EVERY = 0.01              # s between two measurements of the slope
# Found with the parameters of SAME. scenes.converged explains the form.
CONVERGED = {500: ({"slope": (26.5, 0.7)}, "CD, restitution 0, cd_dt 2.5e-4, tolerance 1e-3, seeds 1 to 8")}
SAME = dict(froude=0.01, friction=0.5, radius_spread=0.2, period=3.0, cycles=1)


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
        raise parameters.ParameterError(f"disks = {full['disks']}: so many disks, in loose rows, do not fit into a drum of their size; take more "
                                        "disks, or radius_spread below 0.3")
    ids = [ground.disk(place, radius=ground.draw_radius()).id for place in places[:full["disks"]]]  # from the lowest row upwards
    slopes, half_time = [], full["period"] * full["cycles"] / 2

    def look():
        if O.time >= half_time:
            x, y = bodies.centre_of_mass(ids)
            slopes.append(math.degrees(math.atan2(x, -y)))

    def slope():
        return sum(slopes) / len(slopes) if slopes else math.nan

    scene = stage.small(full, converged(full, CONVERGED, SAME, "degree", lambda name: slope()), kept={"slopes": slopes},
                        extra={"slope": ("degree", "slope of the bed, mean over the second half of the run", slope)})
    turn = RotationEngine(ids=ring, rotationAxis=(0, 0, 1), angularVelocity=math.sqrt(full["froude"] * full["gravity"] / inner),
                          rotateAroundZero=True, zeroPoint=(0, 0, 0))
    mover = [type(engine).__name__ for engine in O.engines].index("ContactDynamics" if full["method"] == "CD" else "NewtonIntegrator")
    O.engines = O.engines[:mover] + [turn] + O.engines[mover:] + [hooks.runner(look, virtPeriod=EVERY, label=hooks.MEASURING)]
    return scene
