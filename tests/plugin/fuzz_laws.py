"""The laws that every step has to obey, checked on YADE's objects before and after it (Watch), each with a tolerance from its derivation.

h: the step; v, v': velocities before and after; P: contact impulses (YADE's forces times h); S: what acts on a body, the sum of its |P| and of its
external impulses. In a step that counts as converged every velocity change is right to the tolerance times S/m; `SLACK` bounds how far the errors
checked here may add up. Gaps count at the mid-configurations x + h/2 v, where the scheme requires contact. If the centre of a disk passes through a
face on its way there (with a velocity set by a user, or left by a step without a solution), its displacement ends at the face.
"""
import math

import numpy as np
import yade
from scipy.optimize import nnls
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from . import fuzz_geometry
from .fuzz_geometry import BOX, DISK, Picture

EPS = np.finfo(float).eps
SINGLE = 10        # error of one contact of an island with loops, over the typical one (cd_engine/core/error/residual.hpp)
SLACK = 10         # error of a contact, over what the tolerance allows its two bodies: the cone couples normal and tangential errors
# A body's error against the exact solution, in what acts on the most loaded body of its island: the errors of all contacts, of which there are up
# to 60, passed on through wedges, rows that roll together and such (270 has been met in a packing of equal masses). Free fall that counts as
# solved is off by all of what acts, 1/tolerance times as much as is allowed a single contact.
SLACK_WHOLE = 3000
ONLY_SLIDING = 1e-9  # distance from the cone at which "sliding" begins
VANISHES = 1e-100  # in SI units; numbers that decay to zero lose their digits, so an error below this counts as none
TOO_DEEP = "#.* overlap by|is behind Wall #"  # in the message that refuses overlaps too deep to be taken over
UNSURE = object()  # stands for an exact solution that round-off has spoilt
STATUS = {"converged", "fixed_iterations", "max_iterations", "stagnated", "no_solution"}


def tolerance_of(cd):
    """The tolerance of the last step; a test may pretend another one."""
    return cd.stepTolerance if cd.flowTolerance > 0 else cd.tolerance


class Broken(AssertionError):
    """A law that a step has broken."""


def engine():
    """The ContactDynamics among O.engines."""
    return next(e for e in yade.O.engines if type(e).__name__ == "ContactDynamics")


class Watch:
    """Checks every step. references: the overlaps taken over from springs, by pair of ids."""

    def __init__(self):
        self.references = {}
        self.steps = self.unsolved = self.loaded = self.exact = 0
        self.worst = {}  # by law: the largest error found, over its tolerance
        self.wrong = None

    def before(self):
        cd = engine()
        self.restarted = cd.handover
        self.picture = Picture(cd.gravity)
        self.dissipated = cd.dissipatedEnergy

    def after(self):
        try:
            self._look(engine())
        except Broken as broken:
            self.wrong = self.wrong or broken
            raise

    def hold(self, law, found, allowed, what):
        """Raise Broken where |found| exceeds `allowed`; both are arrays, what(i) names the body or contact number i."""
        found, allowed = np.abs(np.atleast_1d(found)), np.atleast_1d(allowed) + VANISHES
        if found.size == 0:
            return
        share = np.where(found > 0, found / np.maximum(allowed, np.finfo(float).tiny), 0)
        worst = int(np.argmax(np.where(np.isnan(share), np.inf, share)))
        self.worst[law] = max(self.worst.get(law, 0), share[worst])
        if not share[worst] <= 1:
            cd = engine()
            raise Broken(f"{law}: {what(worst)}: {found[worst]:.3g}, allowed {allowed[worst]:.3g}; step {yade.O.iter}, dt {self.picture.dt:g}, "
                         f"{cd.method}, tolerance {tolerance_of(cd):g}, status {cd.status}, error {cd.residual:.3g}")

    def _look(self, cd):
        self.steps += 1
        p = self.picture
        self.body = lambda k: f"body #{k} ({'disk box wall'.split()[p.kind[k]]})"
        self.x, self.v = fuzz_geometry.motion(len(p.kind))
        if not (np.isfinite(self.v).all() and np.isfinite(self.x).all()):
            raise Broken(f"a number that is not finite at step {yade.O.iter}, status {cd.status}")
        solved = max(cd.residual, cd.bodyError) <= tolerance_of(cd) if cd.fixedIterations > 0 else cd.status == "converged"
        if cd.status not in STATUS or (cd.converged and not solved) or (cd.fixedIterations == 0 and cd.converged != solved):
            raise Broken(f"status {cd.status}, converged {cd.converged}, error {cd.residual:.3g} do not agree at step {yade.O.iter}")
        # A solution that closes contacts which were left out is solved again with them, with a tenth more iterations (README).
        most = cd.fixedIterations or cd.maxIterations + 1 + cd.maxIterations // 10
        if cd.iterations > most:
            raise Broken(f"bound of work: {cd.iterations} iterations of {most} at step {yade.O.iter}")
        self._find_pairs(cd)
        self._read_contacts()
        self._cone()
        self._momentum(cd)
        if cd.gapCorrection == 0:
            self._motion()
        self.hold("maxPenetration tells of the deepest overlap", max(0, self.deepest - cd.maxPenetration), 64 * EPS * self.extent,
                  lambda _: "overlap")
        if cd.converged and cd.restitution == 0:
            self._contact_law(cd)
            self._penetration(cd)
            self._exact(cd)
            if cd.gapCorrection == 0:
                self._energy(cd)
        if cd.converged and not cd.residual <= tolerance_of(cd) * (1 + 1e-6):  # parts at the limit: their sum is rounded
            raise Broken(f"converged with the error {cd.residual:.3g}, tolerance {tolerance_of(cd):.3g}, {cd.method}, at step {yade.O.iter}")
        self.unsolved += not cd.converged

    def _find_pairs(self, cd):
        """All pairs that could touch, whether the engine knows them or not, at the mid-configuration."""
        p = self.picture
        a, b = self.a, self.b = p.pairs()
        self.mid = p.ahead(p.dt / 2)
        self._stop_at_faces()
        if self.restarted:
            every = p.pairs(fixed=True)  # what cannot move now may be set free later
            overlaps = -fuzz_geometry.touch(p, p.x, *every)[1]
            self.references = {(i, j): o for i, j, o in zip(*every, overlaps) if o > 0}
        self.normal, self.gap, self.point = fuzz_geometry.touch(p, self.mid, a, b)
        if self.references:
            held = tuple(np.array(list(self.references)).T)
            apart = fuzz_geometry.touch(p, self.mid, *held)[1] >= 0
            for i, j in zip(held[0][apart].tolist(), held[1][apart].tolist()):
                del self.references[i, j]
        self.reference = np.array([self.references.get(pair, 0.) for pair in zip(a, b)]) if self.references else np.zeros(len(a))
        self.gap = self.gap + self.reference
        self.extent = np.abs(self.mid[:, :2]).max() + p.size.max()
        self.least = np.where(p.kind[a] == DISK, np.minimum(p.radius[a], p.radius[b]), p.radius[b])
        self.bias = np.maximum(self.gap, 0) / p.dt
        self.rows = fuzz_geometry.rows(p, self.normal, self.point, self.mid, a, b)
        self.inverse = np.stack([p.w[a], p.w[b]], axis=1)  # (pair, side, freedom)
        self.wn, self.wt = ((row ** 2 * self.inverse).sum(axis=(1, 2)) for row in self.rows)
        # If neither body can move along the normal, except for the last digit of a sine, the contact carries nothing: the bodies pass each other.
        self.gives = self.wn > 1e-20 * np.maximum(self.inverse.max(axis=(1, 2)), 1e-300)
        self.deepest = max(0, -self.gap[self.gives].min(initial=0))
        self.number = {pair: k for k, pair in enumerate(zip(a.tolist(), b.tolist()))}

    def _stop_at_faces(self):
        """Find the disks whose displacement ended at a face: those whose place now does not follow from their velocities.

        This may happen only to a disk whose centre entered a boundary; then it touches the face from outside, or another boundary moves it on.
        """
        p, h, a, b = self.picture, self.picture.dt, self.a, self.b
        self.stop = np.zeros_like(p.x)
        met = fuzz_geometry.faces_met(p, p.x, self.mid, a, b)[0]
        for k in set(b[met]):
            straight = self.mid[k, :2].copy()
            stop = self.x[k, :2] - p.x[k, :2] - 0.5 * h * (p.v + self.v)[k, :2]
            size = (np.abs(p.x) + np.abs(self.x) + h * (np.abs(p.v) + np.abs(self.v)))[k, :2].max() + p.radius[k]
            at, by, places = self.mid.copy(), (b == k) & (p.kind[a] != DISK), [straight]
            for place in places:
                if np.abs(place - straight - stop).max() <= 64 * EPS * size:
                    self.stop[k, :2], self.mid[k, :2] = stop, place
                    break
                at[k, :2] = place
                met, normal, distance = fuzz_geometry.faces_met(p, p.x, at, a[by], b[by])
                ways = ((p.radius[k] - distance)[:, None] * normal)[met]
                places += [place + way for way in ways if len(places) < 100]
    def _read_contacts(self):
        """Impulses of YADE's real interactions, and what acts on every body."""
        p = self.picture
        self.pn, self.pt = np.zeros(len(self.a)), np.zeros(len(self.a))
        self.total = np.zeros_like(p.x)
        self.acts = np.hypot(p.push[:, 0], p.push[:, 1]) + np.abs(p.push[:, 2]) / np.where(p.size > 0, p.size, 1)
        self.count = np.zeros(len(p.kind))
        for i in yade.O.interactions:
            if not i.isReal:
                continue
            g, f = i.geom, i.phys
            first, second = i.id1, i.id2
            n, fn, ft, c = g.normal, f.normalForce, f.shearForce, g.contactPoint
            sign = 1
            if (first, second) not in self.number:
                first, second, sign = second, first, -1
            k = self.number.get((first, second))
            if k is None:
                if p.w[[first, second]].any() or fn.norm() > 0 or ft.norm() > 0:
                    raise Broken(f"a contact between #{i.id1} and #{i.id2}, of which one is gone or both are boundaries, at step {yade.O.iter}")
                continue
            n = sign * np.array(n)[:2]
            impulse = sign * p.dt * np.array(fn + ft)[:2]
            self.hold("normal of a contact", np.hypot(*(n - self.normal[k])), 64 * EPS * (1 + self.extent / p.radius[second]) + 1e-12,
                      lambda _: f"#{first}, #{second}")
            self.pn[k], self.pt[k] = sign * p.dt * np.dot(np.array(fn)[:2], n), sign * p.dt * (n[0] * ft[1] - n[1] * ft[0])
            size = np.hypot(*impulse)
            for body, way in ((first, -1), (second, 1)):
                arm = np.array(c)[:2] - self.mid[body, :2]
                self.total[body] += way * np.array([*impulse, arm[0] * impulse[1] - arm[1] * impulse[0]])
                self.acts[body] += size
                self.count[body] += 1
        self.loaded += int((self.pn > 0).sum())

    def pair(self, k):
        return f"{self.body(self.a[k])} and #{self.b[k]}"

    def _cone(self):
        """No tension; |p_t| <= mu p_n, mu the smaller friction of the two at the time of the step."""
        p = self.picture
        mu = np.minimum(p.mu[self.a], p.mu[self.b])
        self.mu = mu
        self.hold("no tension", np.minimum(self.pn, 0), 0 * mu, self.pair)
        self.hold("Coulomb's cone", np.maximum(0, np.abs(self.pt) - mu * self.pn * (1 + ONLY_SLIDING)), 16 * EPS * self.pn, self.pair)

    def _momentum(self, cd):
        """m (v' - v) = external impulse + P, linear and angular, to the round-off of the sums; and O.forces says the same.

        Only what is at rest before and after, and stays so since an island sleeps, has forces that balance to the tolerance instead.
        """
        p = self.picture
        free, m, arm = p.w > 0, p.m, p.arm
        size = self.acts[:, None] * arm + m * (np.abs(p.v) + np.abs(self.v))
        # Arms are differences of places.
        size[:, 2] += self.acts * self.extent
        allowed = 8 * (4 + self.count)[:, None] * EPS * size
        rests = (self.v == 0).all(axis=1)
        allowed[rests] += max(cd.tolerance, cd.flowTolerance) * (self.acts[:, None] * arm)[rests]
        off = (m * (self.v - p.v) - p.push - self.total) * free
        self.hold("balance of momentum", off.ravel(), allowed.ravel(), lambda k: f"{self.body(k // 3)}, {'x y turn'.split()[k % 3]}")
        self.hold("a prescribed velocity", (self.v - p.v)[~free], 0 * p.v[~free], lambda k: "one of the bodies")
        total = fuzz_geometry.forces(len(p.kind))
        weight = p.mass[:, None] * np.array([cd.gravity[0], cd.gravity[1], 0])
        size = (np.abs(p.forces) + np.abs(weight)) * p.dt + self.acts[:, None] * arm
        size[:, 2] += self.acts * self.extent
        allowed = 8 * (4 + self.count)[:, None] * EPS * size
        self.hold("O.forces holds the total", (p.dt * (total - p.forces - weight) - self.total).ravel(), allowed.ravel(),
                  lambda k: f"{self.body(k // 3)}, {'x y turn'.split()[k % 3]}")

    def _motion(self):
        """x' = x + h (v + v')/2, but for the disks that were stopped."""
        p = self.picture
        off = self.x - p.x - self.stop - 0.5 * p.dt * (p.v + self.v)
        off[:, 2] = (off[:, 2] + math.pi) % (2 * math.pi) - math.pi
        size = np.abs(p.x) + np.abs(self.x) + p.dt * (np.abs(p.v) + np.abs(self.v))
        size[:, 2] += math.pi
        self.hold("positions follow velocities", off.ravel(), (16 * EPS * size).ravel(), lambda k: self.body(k // 3))

    def _relative(self, row, v):
        return (row[:, 0] * v[self.a]).sum(axis=1) + (row[:, 1] * v[self.b]).sum(axis=1)

    def _typical(self):
        """By pair: of an island whose contacts make loops, the velocity S' to which its contacts are relative (core/error/residual.hpp); else
        0."""
        p, k = self.picture, np.flatnonzero(self.near)
        n, free = len(p.kind), p.w.any(axis=1)
        both = k[free[self.a[k]] & free[self.b[k]]]
        island = connected_components(coo_matrix((np.ones(len(both)), (self.a[both], self.b[both])), (n, n)), directed=False)[1]
        of = island[np.where(free[self.a], self.a, self.b)]
        s = np.hypot(*(p.w * p.push)[:, :2].T)
        for row, size in zip(self.rows, (self.pn, np.abs(self.pt))):
            for side, body in ((0, self.a), (1, self.b)):
                np.add.at(s, body, (row[:, side] ** 2 * self.inverse[:, side]).sum(axis=1) * size)
        mass = np.where(free & (s > 0), 1 / np.maximum(p.w[:, :2].max(axis=1), 1e-300), 0)
        count = lambda where, what: np.bincount(where, what, minlength=n)
        touched = np.zeros(n)
        touched[np.concatenate([self.a[k], self.b[k]])] = 1
        loops = count(of[k], np.ones(len(k))) - count(island, touched * free)
        mean = (count(island, touched * mass * np.sqrt(s)) / np.maximum(count(island, touched * mass), 1e-300)) ** 2
        return (mean * np.clip(loops / 200, 0, 1))[of]

    def _allowed(self, cd, row, coupling):
        """Error of a relative velocity that the tolerance allows, and its round-off: of velocities, and of gaps over the step.

        A contact that misses the velocity g, of the projection on the cone, misses each of the two laws by `coupling` times that at most.
        """
        p = self.picture
        acts = np.stack([self.acts[self.a], self.acts[self.b]], axis=1)
        given = ((row ** 2 * self.inverse).sum(axis=2) * acts).sum(axis=1)
        size = sum((np.abs(row) * np.stack([u[self.a], u[self.b]], axis=1)).sum(axis=(1, 2)) for u in (np.abs(p.v), np.abs(self.v)))
        missed = np.maximum(SLACK * given, SINGLE * coupling * self.typical)
        return tolerance_of(cd) * missed + 64 * EPS * (size + given + np.abs(self.bias) + self.extent / p.dt)

    def _contact_law(self, cd):
        """Signorini's and Coulomb's law in the velocities after the step: of each pair of complementary numbers one is zero to the tolerance."""
        p = self.picture
        h = p.dt
        row_n, row_t = self.rows
        free_v = p.v + p.w * p.push
        self.free_v = free_v
        way = h * np.maximum(np.hypot(p.v[:, 0], p.v[:, 1]), np.hypot(free_v[:, 0], free_v[:, 1]))
        self.near = (self.gap <= 2 * (way[self.a] + way[self.b]) + 1e-3 * self.least) | (self.pn > 0)
        self.un, self.ut = self._relative(row_n, self.v) + self.bias, self._relative(row_t, self.v)
        self.near &= self.gives
        self.typical = self._typical()
        self.allow_n = self._allowed(cd, row_n, 1 + self.mu)
        self.allow_t = self._allowed(cd, row_t, (1 + self.mu) * np.maximum(1, self.wt / np.where(self.wn > 0, self.wn, 1)))
        # Beside a box that turns the engine adds to the gap what the turning makes of it, to second order; `penetration` watches those.
        turns = (p.kind == BOX) & ((p.v[:, 2] != 0) | (self.v[:, 2] != 0))
        beside = turns[self.a] | turns[self.b]
        self.some_turn = bool((self.near & beside).any())
        self.near &= ~beside
        off = np.where(self.near, np.minimum(self.pn * self.wn, self.un), 0)
        self.hold("gap closed or force zero", off, self.allow_n, self.pair)
        limit = self.mu * self.pn
        wt = np.where(self.wt > 0, self.wt, 1)
        off = np.where(self.pn > 0, (self.pt - np.clip(self.pt - self.ut / wt, -limit, limit)) * self.wt, 0)
        self.hold("sticks, or slides against the velocity", off, self.allow_t, self.pair)

    def _penetration(self, cd):
        """No pair overlaps more, or passes through, on the straight ways to the next mid-configuration.

        Distances to convex bodies are convex, so a gap that closes by its velocity at most stays open all the way, but for what the turning of a box
        bends of it.
        """
        p = self.picture
        h, a, b = p.dt, self.a, self.b
        speed = np.hypot(self.v[:, 0], self.v[:, 1])
        reach = h * (speed[a] + speed[b] + self._spin() * np.hypot(*(self.mid[b, :2] - self.mid[a, :2]).T))
        geometric = self.gap - self.reference
        before = np.maximum(0, np.maximum(-geometric, self.reference))
        bend = self._bend()
        acts = np.stack([self.acts[a], self.acts[b]], axis=1)
        missed = np.maximum(SLACK * (acts * self.inverse.max(axis=2)).sum(axis=1), SINGLE * (1 + self.mu) * self.typical)
        allowed = h * tolerance_of(cd) * missed + 64 * EPS * (self.extent + reach)
        # The others stay above their tangent.
        tangent = geometric + h * np.minimum(0, self._relative(self.rows[0], self.v))
        some = np.flatnonzero((geometric < reach) & (tangent < -before - allowed) & self.gives)
        if not len(some):
            return
        least = fuzz_geometry.closest(p, self.mid, self.v, a[some], b[some], h)
        off, allowed = np.maximum(0, -least - before[some]), allowed + bend
        self.hold("no penetration", off, allowed[some], lambda k: self.pair(some[k]))

    def _spin(self):
        """By pair: the rate at which its box turns after the step, or would without contacts, by which the engine foresees it."""
        p, a = self.picture, self.a
        return np.where(p.kind[a] == BOX, np.maximum(np.abs(p.v + p.w * p.push)[a, 2], np.abs(self.v[a, 2])), 0)

    def _bend(self):
        """By how much the way of a disk bends in the frame of a box that turns: h^2/2 (spin^2 r + 2 spin |u|)."""
        a, b, h, spin = self.a, self.b, self.picture.dt, self._spin()
        speed = np.hypot(self.v[:, 0], self.v[:, 1])
        along = speed[a] + speed[b]
        far = np.hypot(*(self.mid[b, :2] - self.mid[a, :2]).T)
        return 0.5 * h * h * (spin ** 2 * (far + h * (along + spin * far)) + 2 * spin * along)

    def _exact(self, cd):
        """Velocities against the exact ones of the same contacts.

        With tangential impulses of sliding contacts held fast and the others sticking, the law is a convex quadratic problem, whose velocities are
        unique: the least kinetic energy of the change under u_n >= -gap/h, u_t = 0 (least distance programming, Lawson & Hanson 1974, ch. 23).
        """
        p = self.picture
        k = np.flatnonzero(self.near)
        if not len(k) or len(k) > 80 or self.some_turn:
            return
        row_n, row_t = (row[k] for row in self.rows)
        limit = self.mu[k] * self.pn[k]
        sticks = limit - np.abs(self.pt[k]) > SLACK * tolerance_of(cd) * np.minimum(
            *(np.where(p.w[body[k]].any(axis=1), self.acts[body[k]], np.inf) for body in (self.a, self.b)))
        given = np.where(sticks, 0, self.pt[k])
        start = self.free_v.copy()
        for side, body in ((0, self.a[k]), (1, self.b[k])):
            np.add.at(start, body, p.w[body] * row_t[:, side] * given[:, None])
        normal_only = self._least_distance(k, row_n, -(self._of(k, row_n, start) + self.bias[k]))
        if normal_only is UNSURE:
            return
        if normal_only is None:
            pushing = ", ".join(self.pair(i) for i in k if self.pn[i] > 0)
            raise Broken(f"converged where no solution is: bodies cannot give way, step {yade.O.iter}, contacts {pushing[:200]}")
        if sticks.any():
            needs = [-(self._of(k, row_n, start) + self.bias[k]), -self._of(k, row_t, start)[sticks], self._of(k, row_t, start)[sticks]]
            change = self._least_distance(np.concatenate([k, k[sticks], k[sticks]]), np.concatenate([row_n, row_t[sticks], -row_t[sticks]]),
                                          np.concatenate(needs))
            if change is None or change is UNSURE:
                return  # sticking everywhere is impossible to the last digit, though not to the tolerance
        else:
            change = normal_only
        self.exact += 1
        m = p.m
        off = m * (self.v - start - np.sqrt(p.w) * change)
        largest = max(np.abs(change).max(), (np.sqrt(m) * np.abs(start)).max())
        typical = np.zeros(len(p.kind))  # what bears nothing may be missed by that
        for body in (self.a, self.b):
            np.maximum.at(typical, body[k], self.typical[k])
        acts = np.maximum(self._acts_nearby(), m[:, :2].max(axis=1) * typical)
        allowed = SLACK_WHOLE * tolerance_of(cd) * acts[:, None] * p.arm + 1e-9 * np.sqrt(m) * largest
        self.hold("the exact velocity", off.ravel(), allowed.ravel(), lambda i: f"{self.body(i // 3)}, {'x y turn'.split()[i % 3]}")

    def _acts_nearby(self):
        """The most that acts on any body of the same island: bodies that move on together share the error of those that bear most."""
        free = self.picture.w.any(axis=1)
        k = np.flatnonzero((self.pn > 0) & free[self.a] & free[self.b])
        most, before = self.acts.copy(), None
        while before is None or (most != before).any():
            before = most.copy()
            both = np.maximum(most[self.a[k]], most[self.b[k]])
            np.maximum.at(most, self.a[k], both)
            np.maximum.at(most, self.b[k], both)
        return most

    def _of(self, k, row, v):
        return (row[:, 0] * v[self.a[k]]).sum(axis=1) + (row[:, 1] * v[self.b[k]]).sum(axis=1)

    def _least_distance(self, k, row, needed):
        """The shortest x with G x >= needed, G the rows over the roots of the masses; None if there is none.

        UNSURE where it is not known to nine digits: x = G' y, y >= 0, with y > 0 only where G x = needed, is what makes it the shortest.
        """
        p = self.picture
        n = len(p.kind)
        matrix = np.zeros((len(k), n, 3))
        for side, body in ((0, self.a[k]), (1, self.b[k])):
            matrix[np.arange(len(k)), body] += row[:, side] * np.sqrt(p.w[body])
        matrix = matrix.reshape(len(k), -1)
        length = np.sqrt((matrix ** 2).sum(axis=1))
        moves = length > 0
        if not moves.any():
            return np.zeros((n, 3))
        matrix, needed = matrix[moves] / length[moves, None], needed[moves] / length[moves]
        scale = needed.max()
        # What has decayed to zero but for its last digits asks for no change that `hold` could see, and has no quotient with the other numbers.
        if scale <= VANISHES ** 2:
            return np.zeros((n, 3))
        columns = np.flatnonzero(matrix.any(axis=0))
        tall = np.vstack([matrix[:, columns].T, needed / scale])
        target = np.zeros(len(columns) + 1)
        target[-1] = 1
        u, distance = nnls(tall, target, maxiter=30 * tall.shape[1])
        if distance < 1e-7:
            return None
        x, active, rows = np.zeros(3 * n), u > 0, tall[:-1].T
        # The quotients that give x from u lose digits where the distance is small; the active rows do not.
        x[columns] = short = np.linalg.lstsq(rows[active], needed[active], rcond=None)[0]
        closed = rows @ short - needed
        if max(-closed.min(), np.abs(closed[active]).max()) > 1e-9 * scale or nnls(rows[active].T, short)[1] > 1e-9 * np.hypot.reduce(short):
            return UNSURE
        return x.reshape(n, 3)

    def _energy(self, cd):
        """Contacts create no energy except by the scheme's mean: Sum P.(u + u')/2 <= Sum (h F)^2/(8 m), since P.u' <= 0 and (u + u')/2 = u' - (W P +
        h H' F/M)/2. At a turning box u' may equal the bend of the path over h. The engine's own sum must agree if no disk is stopped."""
        p = self.picture
        mean = 0.5 * (p.v + self.v)
        un, ut = self._relative(self.rows[0], mean), self._relative(self.rows[1], mean)
        given = float((self.pn * un + self.pt * ut).sum())
        own = float((p.push ** 2 * p.w).sum()) / 8
        error = float((2 * self.pn * self.allow_n + 2 * np.abs(self.pt) * self.allow_t).sum())
        bent = float((self.pn * self._bend()).sum()) / p.dt
        self.hold("no energy from contacts", max(0, given), own + error + bent, lambda _: "all contacts")
        if not ((self.v == 0) & (p.v != 0) & (p.w > 0)).any():
            size = float((self.pn * np.abs(un) + np.abs(self.pt * ut)).sum()) + abs(self.dissipated)
            self.hold("dissipatedEnergy", cd.dissipatedEnergy - self.dissipated + given, 1e-10 * size + error, lambda _: "all contacts")
