"""Draws plane scenes at random: their bodies, loads and steps; lengths in m, times in s, masses in kg."""
import math

import yade
from yade import utils

from . import fuzz_geometry, plane

LARGEST = 0.1   # radius
METHODS = ("auto", "accelerated", "nsgs", "newton")


class Scene:
    """A scene as drawn: settings of the engine, gravity, and the scale of its numbers."""

    def __init__(self, r):
        self.r = r
        self.smallest = LARGEST / 10 ** r.uniform(0, 2)
        self.masses = r.choice(("one", "area", "any", "any"))
        self.spread = 10 ** r.uniform(0, 6)
        self.mu = r.choice((0, 0.3, 2, None))  # None: every body has its own
        self.speed = 10 ** r.uniform(-1.5, 0.7)
        size = r.choice((0, 9.81, 9.81, 9.81))
        turn = r.choice((0, 0, r.uniform(-0.6, 0.6)))
        self.gravity = (size * math.sin(turn), -size * math.cos(turn), 0)
        self.dt = 10 ** r.uniform(-3.7, -1.7)
        self.settings = settings(r) | {"gravity": self.gravity}
        self.permanent = {}  # permanent forces, which YADE does not save

    def radius(self):
        return self.smallest * (LARGEST / self.smallest) ** self.r.random()

    def mass(self, radius):
        return {"one": 1.0, "area": 1000 * math.pi * radius ** 2, "any": 1e-3 * self.spread ** self.r.random()}[self.masses]

    def material(self):
        return plane.material(self.r.choice((0, 0.1, 0.5, 1, 2)) if self.mu is None else self.mu)

    def velocity(self):
        return self.r.gauss(0, self.speed / 2), self.r.gauss(0, self.speed / 2)

    def disk(self, place=None, radius=None, still=False):
        """Append a disk; without `place` at a random place where it touches nothing. Return its id, or None if there is no such place."""
        radius = radius or self.radius()
        k = plane.disk(place or (0, 0), radius, mass=self.mass(radius), velocity=(0, 0) if still else self.velocity(),
                       spin=0 if still else self.r.gauss(0, self.speed / radius), mat=self.material())
        if not place:
            return k if self.put_free(k) else None
        if gaps_of(k).min(initial=1) < -1e-9 * radius:
            yade.O.bodies.erase(k)
            return None
        return k

    def put_free(self, k):
        """Move body k to a free place, or erase it if none is found. Return whether it still exists."""
        body = yade.O.bodies[k]
        for _ in range(30):
            body.state.pos = (self.r.uniform(-0.35, 0.35), self.r.uniform(0, 0.6), 0)
            if gaps_of(k).min(initial=1) > 0:
                return True
        yade.O.bodies.erase(k)
        return False


def settings(r):
    """Settings of the engine; mostly those of a user, now and then others."""
    rarely = lambda usual, *others: r.choice(others) if r.random() < 0.12 else usual
    drawn = {"tolerance": 10 ** r.uniform(-8, -4), "method": r.choice(METHODS), "reduce": rarely(True, False), "warmStart": rarely(True, False),
             "maxIterations": rarely(20000, 1, 50), "fixedIterations": rarely(0, 30), "gapCorrection": rarely(0, 0.2, 1.0),
             "seed": rarely(0, 5), "searchMargin": r.choice((0.1, 0.1, 0.02, 1.0))}
    # No draws of their own: the scenes of all seeds stay.
    return drawn | {"allowedOverlap": 1e-3 if drawn["searchMargin"] == 0.1 else 0.0,
                    "flowTolerance": 1e-3 if drawn["searchMargin"] == 0.02 else 0.0}


def gaps_of(k):
    """Distances of the surfaces of body k and of all others, walls in the way included."""
    p = fuzz_geometry.Picture((0, 0, 0))
    p.w[:] = 1  # whether they can move or not
    a, b = p.pairs()
    with_k = (a == k) | (b == k)
    return fuzz_geometry.touch(p, p.x, a[with_k], b[with_k])[1]


def build(r):
    """Build a scene in an empty YADE. Return the Scene that was drawn."""
    scene = Scene(r)
    yade.O.dt = scene.dt
    for make in r.sample(BOUNDARIES, r.randrange(1, 5)):
        make(scene)
    r.choice(DISKS)(scene)
    return scene


def wall(scene, axis, place, sense):
    return yade.O.bodies.append(utils.wall(place, axis=axis, sense=sense, material=scene.material()))


def floor(scene):
    if scene.r.random() < 0.5:
        wall(scene, 1, 0, scene.r.choice((0, 1)))
    else:
        plane.box((0, -0.02), (0.9, 0.02), mat=scene.material())


def trough(scene):
    wall(scene, 1, 0, 0)
    for side in (-1, 1):
        if scene.r.random() < 0.5:
            wall(scene, 0, 0.45 * side, scene.r.choice((0, -side)))
        else:
            plane.box((0.47 * side, 0.4), (0.02, 0.6), angle=scene.r.uniform(-0.3, 0.3), mat=scene.material())


def moving_plate(scene):
    """At a prescribed velocity, as fast as the disks."""
    r = scene.r
    k = plane.box((r.uniform(-0.5, 0.5), 0.8), (r.uniform(0.02, 0.3), 10 ** r.uniform(-3, -1.5)), angle=r.uniform(-1, 1), mat=scene.material())
    yade.O.bodies[k].state.vel = (*scene.velocity(), 0)


def moving_wall(scene):
    k = wall(scene, 0, -0.5, scene.r.choice((0, 1)))
    yade.O.bodies[k].state.vel = (scene.r.choice((0.3, -0.3, 1)) * scene.speed, 0, 0)


def paddle(scene):
    """Turns at a prescribed rate."""
    r = scene.r
    k = plane.box((r.uniform(-0.3, 0.3), r.uniform(0.3, 0.7)), (r.uniform(0.05, 0.25), 10 ** r.uniform(-3, -1.5)), angle=r.uniform(-3, 3),
                  mat=scene.material())
    yade.O.bodies[k].state.angVel = (0, 0, r.choice((-1, 1)) * 10 ** r.uniform(-1, 0.7) * min(scene.speed / 0.2, 0.3 / scene.dt))


def piston(scene):
    """Moves along y alone, pushed down by a permanent force."""
    k = plane.box((0, 0.75), (0.4, 0.03), blocked="xzXYZ", mass=scene.mass(LARGEST), mat=scene.material())
    load(scene, k, (0, -scene.r.choice((1, 100)) * yade.O.bodies[k].state.mass * 9.81, 0))


def loaded_wall(scene):
    k = wall(scene, 0, 0.5, scene.r.choice((0, -1)))
    yade.O.bodies[k].state.blockedDOFs, yade.O.bodies[k].state.mass = "yzXYZ", scene.mass(LARGEST)
    load(scene, k, (-scene.r.choice((0.3, 10)) * yade.O.bodies[k].state.mass * 9.81, 0, 0))


def bar(scene):
    """A box free to move and to turn."""
    r = scene.r
    half = (r.uniform(0.05, 0.2), r.uniform(0.01, 0.05))
    mass = scene.mass(LARGEST)
    k = plane.box((r.uniform(-0.3, 0.3), 0.95), half, angle=r.uniform(-2, 2), blocked="zXY", mass=mass,
                  inertia=mass * (half[0] ** 2 + half[1] ** 2) / 3, mat=scene.material())
    yade.O.bodies[k].state.vel = (*scene.velocity(), 0)


def load(scene, k, force):
    scene.permanent[k] = force
    yade.O.forces.setPermF(k, force)


BOUNDARIES = (floor, floor, trough, moving_plate, moving_wall, paddle, piston, loaded_wall, bar)


def cloud(scene):
    for _ in range(scene.r.randrange(4, 24)):
        scene.disk()


def columns(scene):
    """Columns of touching disks on the floor y = 0, heavy on light and light on heavy."""
    for k in range(scene.r.randrange(1, 4)):
        height = 0.0
        for _ in range(scene.r.randrange(1, 5)):
            radius = scene.radius()
            scene.disk((0.25 * k - 0.25, height + radius), radius, still=True)
            height += 2 * radius


def layers(scene):
    """Rows of equal disks, each in the gaps of the row below, at the distance of their rows or a little farther."""
    r = scene.r
    radius, wide = r.uniform(0.02, 0.06), r.choice((1, 1, 1.0001, 1.02))
    for row in range(r.randrange(1, 5)):
        for k in range(r.randrange(1, 6)):
            scene.disk((radius * wide * (2 * k + row % 2), radius * (1 + math.sqrt(3) * row * wide)), radius, still=r.random() < 0.9)


def pair(scene):
    """Two disks, one as small as may be, meeting."""
    big = scene.disk((0, 0.5), LARGEST)
    small = scene.disk((0.3, 0.5 + scene.r.uniform(-0.1, 0.1)), scene.smallest)
    if small is not None:
        yade.O.bodies[small].state.vel = (-scene.speed * 3, 0, 0)
    if big is not None and scene.r.random() < 0.3:
        yade.O.bodies[big].state.blockedDOFs = "xyzXYZ"


DISKS = (cloud, cloud, columns, layers, pair)
