"""The geometry of a scene that Contact Dynamics needs, computed anew from YADE's objects alone: nothing here calls the engine."""
import math

import numpy as np
import yade

DISK, BOX, WALL = range(3)
KINDS = {"Sphere": DISK, "Box": BOX, "Wall": WALL}


def motion(n):
    """Return the places and velocities of bodies 0 to n - 1, (n, 3) each: x, y, and rotation about z."""
    x, v = np.zeros((n, 3)), np.zeros((n, 3))
    for b in yade.O.bodies:
        s = b.state
        q = s.ori
        x[b.id] = s.pos[0], s.pos[1], 2 * math.atan2(q[2], q[3])
        v[b.id] = s.vel[0], s.vel[1], s.angVel[2]
    return x, v


def forces(n):
    """Return what O.forces holds for them, (n, 3): x, y, and the torque about z."""
    total = np.zeros((n, 3))
    for b in yade.O.bodies:
        f, t = yade.O.forces.f(b.id, True), yade.O.forces.t(b.id, True)
        total[b.id] = f[0], f[1], t[2]
    return total


class Picture:
    """All bodies at one moment, as arrays over the ids; what has been erased has no kind (-1).

    x (n, 3): place and rotation about z; v (n, 3): velocities and spin; w (n, 3): inverse masses, 0 where a freedom is blocked;
    m (n, 3): masses, 0 there, too; arm (n, 3): 1, 1 and the largest arm of a contact's force;
    push (n, 3): dt times force and torque of everything but contacts, weight included, 0 where a freedom is blocked.
    """

    def __init__(self, gravity):
        scene = yade.O
        n = len(scene.bodies)
        self.dt = scene.dt
        self.kind = np.full(n, -1)
        self.x, self.v = motion(n)
        self.forces = forces(n)
        self.w = np.zeros((n, 3))
        self.mass, self.radius, self.mu, self.size = (np.zeros(n) for _ in range(4))
        self.half = np.zeros((n, 2))
        self.axis, self.sense = np.zeros(n, int), np.zeros(n, int)
        for b in scene.bodies:
            k, s, shape = b.id, b.state, b.shape
            self.kind[k] = KINDS[type(shape).__name__]
            blocked, mass = s.blockedDOFs, s.mass
            self.mass[k] = mass if "x" not in blocked or "y" not in blocked else 0
            self.w[k] = [0 if dof in blocked else 1 / m for dof, m in zip("xyZ", (mass, mass, s.inertia[2]))]
            self.mu[k] = math.tan(b.mat.frictionAngle)
            if self.kind[k] == DISK:
                self.radius[k] = self.size[k] = shape.radius
            elif self.kind[k] == BOX:
                self.half[k] = shape.extents[0], shape.extents[1]
                self.size[k] = math.hypot(*self.half[k])
            else:
                self.axis[k], self.sense[k] = shape.axis, shape.sense
        self.m = np.where(self.w > 0, 1 / np.where(self.w > 0, self.w, 1), 0)
        self.arm = np.stack([np.ones(n), np.ones(n), self.size], axis=1)
        self.push = self.dt * (self.forces + self.mass[:, None] * np.array([gravity[0], gravity[1], 0])) * (self.w > 0)

    def pairs(self, fixed=False):
        """All pairs (boundary or disk, disk) of which one at least can move; with `fixed` the others, too."""
        disks, boundaries = np.flatnonzero(self.kind == DISK), np.flatnonzero(self.kind > DISK)
        i, j = np.triu_indices(len(disks), 1)
        a = np.concatenate([disks[i], np.repeat(boundaries, len(disks))])
        b = np.concatenate([disks[j], np.tile(disks, len(boundaries))])
        free = self.w.any(axis=1)
        some = free[a] | free[b] | fixed
        return a[some], b[some]

    def ahead(self, time):
        """Places after `time` [s] at the present velocities."""
        return self.x + time * self.v


def touch(picture, x, a, b):
    """Normals (a -> b) and distances of surfaces of pairs, where bodies stand at x; contact points midway between the surfaces."""
    d = x[b, :2] - x[a, :2]
    normal, distance = np.zeros((len(a), 2)), np.zeros(len(a))
    kind = picture.kind[a]
    for k, foot in ((DISK, _foot_on_disk), (BOX, _foot_on_box), (WALL, _foot_on_wall)):
        some = kind == k
        if some.any():
            normal[some], distance[some] = foot(picture, x, a[some], d[some])
    gap = distance - picture.radius[b]
    return normal, gap, x[b, :2] - (picture.radius[b] + gap / 2)[:, None] * normal


def _foot_on_disk(picture, _, a, d):
    r = np.hypot(d[:, 0], d[:, 1])
    return d / r[:, None], r - picture.radius[a]


def _foot_on_wall(picture, _, a, d):
    along = d[np.arange(len(a)), picture.axis[a]]
    side = np.where(picture.sense[a] != 0, picture.sense[a], np.copysign(1, along))
    normal = np.zeros((len(a), 2))
    normal[np.arange(len(a)), picture.axis[a]] = side
    return normal, side * along


def _foot_on_box(picture, x, a, d):
    c, s = np.cos(x[a, 2]), np.sin(x[a, 2])
    local = _turned(x[a, 2], d)
    half = picture.half[a]
    beyond = local - np.clip(local, -half, half)
    corner = (beyond != 0).all(axis=1)
    out = np.abs(local) - half
    face = np.zeros_like(local)
    side = np.argmax(out, axis=1)
    rows = np.arange(len(a))
    face[rows, side] = np.copysign(1, local[rows, side])
    far = np.hypot(beyond[:, 0], beyond[:, 1])
    n = np.where(corner[:, None], beyond / np.where(far > 0, far, 1)[:, None], face)
    return np.stack([c * n[:, 0] - s * n[:, 1], s * n[:, 0] + c * n[:, 1]], axis=1), np.where(corner, far, out.max(axis=1))


def faces_met(picture, start, end, a, b):
    """Whether the centre of disk b, outside boundary a when bodies stand at `start`, has come in or right through when they stand at `end`; the
    outward normals of the faces by which, and the centre's distances from these.

    Straight on in the boundary's axes: cut with the two strips whose common part a box is (Liang & Barsky 1984), or with a wall.
    """
    met, normal, distance = np.zeros(len(a), bool), np.zeros((len(a), 2)), np.zeros(len(a))
    before, after = start[b, :2] - start[a, :2], end[b, :2] - end[a, :2]
    rows = np.flatnonzero(picture.kind[a] == WALL)
    axis, sense = picture.axis[a[rows]], picture.sense[a[rows]]
    p, q = before[rows, axis], after[rows, axis]
    met[rows] = (p * q < 0) & (sense * p >= 0)
    normal[rows, axis], distance[rows] = np.sign(p), np.sign(p) * q
    rows = np.flatnonzero(picture.kind[a] == BOX)
    p, q = (_turned(x[a[rows], 2], d[rows]) for x, d in ((start, before), (end, after)))
    half, way = picture.half[a[rows]], q - p
    with np.errstate(divide="ignore", invalid="ignore"):
        first, last = np.sort([(-half - p) / way, (half - p) / way], axis=0)
    within = np.abs(p) <= half
    first, last = (np.where(way == 0, np.where(within, -s, s) * np.inf, t) for s, t in ((1, first), (-1, last)))
    come, axis = first.max(axis=1), first.argmax(axis=1)
    met[rows] = ~within.all(axis=1) & (come >= 0) & (come <= 1) & (come <= last.min(axis=1))
    face = np.zeros((len(rows), 2))
    k = np.arange(len(rows))
    face[k, axis] = np.sign(p[k, axis])
    normal[rows], distance[rows] = _turned(-end[a[rows], 2], face), np.sign(p[k, axis]) * q[k, axis] - half[k, axis]
    return met, normal, distance


def _turned(angle, d):
    """Vectors d in axes turned by an angle."""
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([c * d[:, 0] + s * d[:, 1], -s * d[:, 0] + c * d[:, 1]], axis=1)


def rows(picture, normal, point, x, a, b):
    """Rows of the relative velocity at contact points, of b against a: normal and tangential, over (pair, side a or b, freedom)."""
    made = []
    for direction in (normal, np.stack([-normal[:, 1], normal[:, 0]], axis=1)):
        row = np.zeros((len(a), 2, 3))
        for side, (body, sign) in enumerate(((a, -1), (b, 1))):
            arm = point - x[body, :2]
            row[:, side, :2] = sign * direction
            row[:, side, 2] = sign * (arm[:, 0] * direction[:, 1] - arm[:, 1] * direction[:, 0])
        # The impulse passes through a disk's centre.
        if direction is normal:
            row[:, :, 2][np.stack([picture.kind[a] == DISK, picture.kind[b] == DISK], axis=1)] = 0
        made.append(row)
    return made


def closest(picture, x, v, a, b, time):
    """Smallest distance of surfaces while all bodies go straight on at v for `time` [s].

    In the frame of what does not turn it is a convex function of time, since bodies are convex: found by golden section; beside a turning box
    by 64 looks.
    """
    def gap(t):
        return touch(picture, x + np.asarray(t)[:, None, None] * v if np.ndim(t) > 1 else x + t * v, a, b)[1]

    turns = (picture.kind[a] == BOX) & (v[a, 2] != 0)
    least = np.minimum(gap(0.0), gap(time))
    if turns.any():
        for t in np.linspace(0, time, 66)[1:-1]:
            least[turns] = np.minimum(least[turns], touch(picture, x + t * v, a[turns], b[turns])[1])
    a, b = a[~turns], b[~turns]
    if len(a):
        least[~turns] = np.minimum(least[~turns], _golden(picture, x, v, a, b, time))
    return least


def _golden(picture, x, v, a, b, time):
    """The smallest distance of each pair on straight ways, each pair at its own time."""
    ratio = (math.sqrt(5) - 1) / 2
    low, high = np.zeros(len(a)), np.full(len(a), time)

    def gap(t):
        pair = np.arange(len(a))
        both = np.concatenate([x[a] + t[:, None] * v[a], x[b] + t[:, None] * v[b]])
        return touch(_Some(picture, a, b), both, pair, pair + len(a))[1]

    least = np.full(len(a), np.inf)
    for _ in range(32):
        p, q = high - ratio * (high - low), low + ratio * (high - low)
        at_p, at_q = gap(p), gap(q)
        least = np.minimum(least, np.minimum(at_p, at_q))
        left = at_p < at_q
        high, low = np.where(left, q, high), np.where(left, low, p)
    return least


class _Some:
    """The bodies of some pairs, a's before b's, in the form that `touch` reads."""

    def __init__(self, picture, a, b):
        both = np.concatenate([a, b])
        for name in ("kind", "radius", "half", "axis", "sense"):
            setattr(self, name, getattr(picture, name)[both])
