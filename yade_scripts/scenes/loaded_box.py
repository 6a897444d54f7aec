"""Equal disks on a square grid in the biaxial box, whose walls are loaded by P0: every wall carries P0 over its length."""
import itertools
import math

from yade_scripts import parameters
from yade_scripts.scenes import Chart, Known

TITLE = "Square lattice in a loaded box"
KIND = "piles at rest"
HORIZON = "Any time: nothing moves."
LEFT_OUT = "gravity, which the balance of the walls does not need; MD starts with its springs compressed by P0"
DEFAULTS = dict(method="CD", disks=100, radius_spread=0.0, period=0.1, records_per_cycle=10, tolerance=1e-11, max_iterations=10**6)
CHART = Chart(sizes=(25, 100, 400, 1600, 6400))


def build(full, folder):
    """Build as many disks as fill a square, at most `disks`; the springs of MD are compressed by P0 from the start."""
    from yade_scripts.running import bodies, loading, stage, walls
    ground = stage.Ground(full)
    radius, rows, p0 = ground.radius, math.isqrt(full["disks"]), parameters.pressure(full)
    bodies.append_material("wall", 0.0, full)
    # Each of the rows + 1 contacts in a row is compressed by sag(F), F = P0 depth side/rows.
    side = 2 * radius * rows / (1 + ground.sag(p0 * full["depth"] / rows) * (rows + 1))
    sag = ground.sag(p0 * full["depth"] * side / rows)
    walls.append((side, side), full["depth"], "wall")
    places = [radius - sag + k * (2 * radius - sag) for k in range(rows)]
    for place in itertools.product(places, places):
        ground.disk(place)
    scene = stage.scene(full, known=[Known("worst_stress_error", "1", 0.0, lambda: walls.stress_error(p0),
                                           source="balance: each wall carries P0 on its length")])
    stage.load_walls(full, scene, loading.constant(p0))
    return scene
