"""Equal disks on a square grid in the biaxial box, its walls loaded by P0: every wall carries P0 L."""
import math

from yade_scripts import bodies, parameters, walls
from yade_scripts.scenes import Known, Scene, largest_step, load_walls, set_step


def build(full, folder):
    """As many disks as fill a square, at most `disks`; the springs of MD compressed by P0 from the start."""
    radius, rows, p0 = full["radius_mean"], math.isqrt(full["disks"]), parameters.pressure(full)
    bodies.append_material("wall", 0.0, full)
    bodies.append_material("disk", full["friction"], full)
    # Each of the rows + 1 contacts in a row is compressed by sag(F), F = P0 depth side/rows.
    side = 2 * radius * rows / (1 + bodies.sag(p0 * full["depth"] / rows, full) * (rows + 1))
    sag = bodies.sag(p0 * full["depth"] * side / rows, full)
    walls.append(side, full["depth"], "wall")
    mass = bodies.disk_mass(radius, full)
    places = [radius - sag + k * (2 * radius - sag) for k in range(rows)]
    for x in places:
        for y in places:
            bodies.append_disk((x, y), radius, mass, "disk")
    scene = Scene(every=set_step(full, largest_step(full)), samples=full["records_per_cycle"] * full["cycles"])
    load_walls(full, scene, lambda t: (p0, p0))

    def worst():
        return max(abs(stress / p0 - 1) for pair in walls.stresses() for stress in pair)

    scene.known.append(Known("worst_stress_error", "1", 0.0, worst))
    return scene
