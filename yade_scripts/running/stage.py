"""Helps to build scenes in O: Ground places disks and boxes; `small` sets time step and engines, `load_walls` those of the biaxial box."""
import functools
import math
import random

from yade import O, Quaternion, Vector3, utils

from yade_scripts import parameters
from yade_scripts.running import bodies, deposit, md, walls
from yade_scripts.scenes import Scene, method


class Ground:
    """Places disks and boxes of the material `disk`, which has the row's friction.

    full: {name: value} of all parameters. radius [m], mass [kg]: of a disk of radius_mean, in space of a sphere. time [s]: length of the
    run. draw: random.Random of the seed.
    """

    def __init__(self, full):
        self.full, self.radius, self.time = full, full["radius_mean"], full["period"] * full["cycles"]
        self.mass = parameters.sphere_mass(full) if parameters.in_space(full) else bodies.disk_mass(self.radius, full)
        bodies.append_material("disk", full["friction"], full)

    @functools.cached_property
    def draw(self):  # made when it is used, so that a seed without effect can be noticed
        return random.Random(self.full["seed"])

    def disk(self, place, velocity=(0, 0), blocked="zXY", radius=None, mass=None):
        """Append a disk at (x, y) [m], of radius_mean and the mass of its radius unless said otherwise. Return the body."""
        radius = radius or self.radius
        return O.bodies[bodies.append_disk(place, radius, mass or bodies.disk_mass(radius, self.full), "disk", velocity, blocked)]

    def sphere(self, place, velocity=(0, 0, 0), spin=(0, 0, 0)):
        """Append a sphere of radius_mean at (x, y, z) [m], of this velocity [m/s] and spin [rad/s]. Return the body."""
        body = O.bodies[bodies.append_sphere(place, self.radius, "disk", velocity)]
        body.state.angVel = spin
        body.state.angMom = body.state.inertia[0] * Vector3(*spin)
        return body

    def wall(self, place, axis):
        """Append an endless fixed wall across an axis (0, 1, 2) at `place` [m]. Return its id."""
        return O.bodies.append(utils.wall(place, axis=axis, material="disk", color=(0.4, 0.4, 0.4)))

    def facets(self, triangles):
        """Append fixed triangles, each three points (x, y, z) [m]."""
        for triangle in triangles:
            O.bodies.append(utils.facet([Vector3(*point) for point in triangle], material="disk", color=(0.4, 0.4, 0.4)))

    def box(self, centre, half, angle=0.0, material="disk"):
        """Append a fixed box at (x, y) [m] of half sides (x, y) [m], as deep as the disks, turned by `angle` [rad] about z. Return its id."""
        return O.bodies.append(utils.box((*centre, 0), (*half, self.full["depth"] / 2), Quaternion((0, 0, 1), angle), fixed=True, material=material,
                                         color=(0.4, 0.4, 0.4)))

    def floor(self, length=None):
        """Append a floor with its surface at y = 0, `length` [m] to either side (default: ten mean radii). Return its id."""
        return self.box((0, -self.radius), (length or 10 * self.radius, self.radius))

    def draw_radius(self):
        """Return the radius [m] of the next disk, uniform within radius_mean (1 +- radius_spread)."""
        return self.radius * (1 + self.full["radius_spread"] * self.draw.uniform(-1, 1))

    def deposit(self, width):
        """Append all disks of the row, deposited at rest between walls at x = 0 and `width` [m] on a floor at y = 0. Return their ids."""
        radii = [self.draw_radius() for _ in range(self.full["disks"])]
        places = deposit.deposit(radii, width, self.draw.random).tolist()
        return [self.disk(place, radius=radius).id for place, radius in zip(places, radii)]

    def sag(self, force):
        """Return the overlap [m] of a contact that carries `force` [N] at rest: that of the spring, 0 of rigid contacts."""
        return force / parameters.stiffness(self.full) if parameters.has_springs(self.full) else 0.0


def scene(full, lightest=None, **more):
    """Set O.dt for the bodies in O. Return a Scene that lasts for the cycles of the row.

    lightest: mass [kg] that limits the step of the springs, by default that of the lightest body that can move. more: further attributes of the
    Scene.
    """
    largest = full["cd_dt"]
    if full["method"] == "MD":
        lightest = lightest or min(b.state.mass for b in O.bodies if b.state.blockedDOFs != "xyzXYZ")
        largest = full["md_dt_factor"] * math.sqrt(lightest / parameters.stiffness(full))
    every, O.dt = parameters.steps(full, largest)
    return Scene(every=every, samples=full["records_per_cycle"] * full["cycles"], **more)


def load_walls(full, scene, load):
    """Set O.engines of the row's method for a scene in the biaxial box, whose walls are loaded by PlateLoads of these settings (`loading`).

    Walls x+ and y+ become free unless a servo moves them.
    """
    if full["method"] == "CD" or full["md_walls"] == "force":
        walls.set_free(full["wall_mass_ratio"] * bodies.mean_mass())
    _damp(full)
    method(full).set_engines(full, scene, load)


def _damp(full):
    """Give the springs the damping of the row; what was prepared has that of the preparation."""
    if full["method"] == "MD" and full["damping_factor"] != 1:
        md.set_damping(md.damping(full))


def small(full, known, **more):
    """Set time step and engines for the bodies in O. Return a Scene without loaded walls. known: list of Known. more: its further attributes."""
    built = scene(full, known=known, **more)
    _damp(full)
    method(full).set_engines(full, built)
    return built
