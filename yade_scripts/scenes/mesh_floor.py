"""A sphere rolls over a floor of random triangles, slivers and T-junctions among them, as over a plane: at the same speed, and straight on.

Springs meet two triangles at their common edge and take both for contacts (known of YADE's facets); Contact Dynamics knows the surface.
"""
import random

from yade_scripts.errors import ParameterError
from yade_scripts.parameter import Parameter
from yade_scripts.scenes import Chart, Known

TITLE = "Sphere that rolls over triangles"
KIND = "spheres in space"
HORIZON = "Any time before it reaches the rim of the floor, after 3 m."
LEFT_OUT = "rolling friction, which rigid round contacts do not have"
DEFAULTS = dict(method="CD", friction=0.5, gravity=9.81, period=2.0, records_per_cycle=10, tolerance=1e-13)
POSITIVE = "gravity", "friction"
IN_SPACE = True
PARAMETERS = (Parameter("corners", 60, "1", "corners of the triangles on 4 m by 1 m", low=4, high=10000),)
CHART = Chart()


def check(full):
    """Check that the sphere stays on the floor."""
    way = full["speed"] * full["period"] * full["cycles"]
    if way > 3:
        raise ParameterError(f"speed = {full['speed']}: the sphere would roll {way:.3g} m and leave the floor after 3 m; take a shorter period")


def triangles(count, draw):
    """Return triangles (3 points each) that cover 4 m by 1 m in the plane y = 0: Delaunay's, some of them slivers; some are cut in two at an edge
    whose other side is not."""
    from scipy.spatial import Delaunay
    places = [(draw.uniform(0, 4), draw.uniform(-0.5, 0.5)) for _ in range(count)] + [(x, z) for x in (0, 4) for z in (-0.5, 0.5)]
    places += [(x + 1e-4 * draw.random(), z + 1e-4 * draw.random()) for x, z in places[:count // 5]]
    found = [[places[k] for k in corners] for corners in Delaunay(places).simplices]
    cut = []
    for a, b, c in found[:len(found) // 3]:
        share = draw.uniform(0.2, 0.8)
        middle = tuple(p + share * (q - p) for p, q in zip(a, b))
        cut += [(a, middle, c), (middle, b, c)]
    return [[(x, 0, z) for x, z in corners] for corners in cut + found[len(found) // 3:]]


def build(full, folder):
    """Build the floor and a sphere that rolls along x at `speed`, where it will cross many edges."""
    from yade_scripts.running import stage
    ground = stage.Ground(full)
    ground.facets(triangles(full["corners"], random.Random(full["seed"])))
    speed, radius = full["speed"], ground.radius
    height = radius - ground.sag(ground.mass * full["gravity"])
    state = ground.sphere((0.5, height, 0.01), (speed, 0, 0), (0, 0, -speed / radius)).state
    return stage.small(full, [
        Known("speed", "m/s", speed, lambda: state.vel[0], source="nothing slows a sphere that rolls on a plane"),
        Known("aside", "m/s", 0.0, lambda: state.vel[2], scale=speed, source="nothing turns it aside"),
        Known("height", "m", height, lambda: state.pos[1], scale=radius, source="the plane")])
