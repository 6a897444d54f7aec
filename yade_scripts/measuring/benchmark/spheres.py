"""Makes packings of spheres at rest under the load of three walls, and contact problems of their next step. Needs no YADE.

Spheres of radius 0.7 to 1.3 are pushed apart at random places and then pressed together in steps of Contact Dynamics, with the friction PREPARED,
until the walls do not move any more. They are about as loose as this friction allows: hardly more contacts than equilibrium needs, and many of them
about to slide. x+, y+ and z+ carry the same load on each unit of area and have the mass of 2 N^(2/3) mean spheres; the walls are smooth. The problem
is a step at rest with the load of y+ larger by MORE; its first guess is the solution without.
"""
from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from cd_engine import core

PREPARED = 0.3      # friction
RADII = 0.7, 1.3
FRACTION = 0.48     # of solid, before the walls move
APART = 200         # rounds of pushing apart, at most
STEPS = 120         # at most
FREE = 0.2          # how far a wall would move in a step from rest if nothing resisted
KEPT = 0.5          # of the velocities, from one step to the next
REST = 5e-4         # largest displacement of a wall in a step at rest
ACCURATE = 1e-3     # error of the steps
MOST_SWEEPS = 300   # in a step
SOFT = 1e-3         # compliance of the contacts in these steps, which then push overlaps apart; a mean sphere has the inverse mass 1
REACH = 0.2         # gap up to which two bodies may touch in a step
TOUCHING = 1e-3     # gap that counts as closed in the problem
MORE = 0.002        # rise of the load of y+
GUESSED = 1e-5      # error of the first guess


def packing(count, seed):
    """Return radii, centres (N, 3) and the sides of the box."""
    draw = np.random.default_rng(seed)
    radii = draw.uniform(*RADII, count)
    sides = np.full(3, (4 / 3 * np.pi * np.sum(radii**3) / FRACTION)**(1 / 3))
    x = draw.uniform(radii[:, None], sides - radii[:, None])
    for _ in range(APART):
        i, j, way, distance = _near(x, radii, 0)
        if not len(i) or np.max(radii[i] + radii[j] - distance) < 0.01:
            break
        push = way * (0.55 * ((radii[i] + radii[j]) / distance - 1))[:, None]
        x = np.clip(x + _added(i, j, push, count), radii[:, None], sides - radii[:, None])
    impulses, moved = {}, np.zeros((count + 6, 6))
    for _ in range(STEPS):
        problem, pairs = _step(x, radii, sides, PREPARED, REACH)
        problem.free_velocities += KEPT * moved
        guess = np.array([impulses.get(pair, (0, 0, 0)) for pair in pairs]).ravel() if impulses else None
        report = core.solve(problem, "accelerated", ACCURATE, MOST_SWEEPS, guess)
        impulses = {pair: p for pair, p in zip(pairs, report.impulses.reshape(-1, 3)) if p[0] > 0}
        moved = problem.body_velocities(report.impulses)
        x = x + np.clip(moved[6:, :3], -REACH, REACH)
        change = moved[[1, 3, 5], [0, 1, 2]]
        sides = sides + change
        if np.abs(change).max() < REST:
            break
    return radii, x, sides


def problem(packed, mu):
    """Return the problem of a packing with this friction, with its first guess."""
    rest, _ = _step(packed[1], packed[0], packed[2], mu, TOUCHING, closed=True)
    guess = core.solve(rest, "accelerated", GUESSED).impulses
    velocities = rest.free_velocities.copy()
    velocities[3, 1] *= 1 + MORE
    return replace(rest, free_velocities=velocities, impulses=guess)


def _near(x, radii, gap):
    i, j = cKDTree(x).query_pairs(2 * radii.max() + gap, output_type="ndarray").T
    way = x[j] - x[i]
    distance = np.linalg.norm(way, axis=1)
    near = distance < radii[i] + radii[j] + gap
    return i[near], j[near], way[near], distance[near]


def _added(i, j, push, count):
    return np.stack([np.bincount(j, push[:, k], count) - np.bincount(i, push[:, k], count) for k in range(3)], axis=1)


def _step(x, radii, sides, mu, reach, closed=False):
    """Return the problem of a step of length 1 from rest, and the pairs of its contacts. closed: rigid contacts whose gaps count as closed."""
    i, j, way, distance = _near(x, radii, reach)
    order = np.lexsort((np.maximum(i, j), np.minimum(i, j)))
    i, j, way, distance = (array[order] for array in (i, j, way, distance))
    pairs, normals, gaps = [np.stack([i, j], axis=1) + 6], [way / distance[:, None]], [distance - radii[i] - radii[j]]
    for wall in range(6):  # x-, x+, y-, y+, z-, z+
        axis, high = divmod(wall, 2)
        gap = (sides[axis] - x[:, axis] if high else x[:, axis]) - radii
        near = np.flatnonzero(gap < reach)
        pairs.append(np.stack([np.full(len(near), wall), near + 6], axis=1))
        normals.append(np.repeat((-1 if high else 1) * np.eye(3)[[axis]], len(near), axis=0))
        gaps.append(gap[near])
    pairs, normals, gaps = np.concatenate(pairs), np.concatenate(normals), np.concatenate(gaps)
    order = np.lexsort((pairs[:, 0], np.maximum(x[pairs[:, 1] - 6, 2] // 2, 0)))  # near each other in the list, layer by layer
    pairs, normals, gaps = pairs[order], normals[order], gaps[order]
    mass = np.concatenate([np.full(6, 2 * len(x)**(2 / 3) * np.mean(radii**3)), radii**3])
    inverse = np.repeat(1 / mass[:, None], 3, axis=1)
    inverse[:6] = 0
    velocities = np.zeros((len(mass), 6))
    for wall, axis in ((1, 0), (3, 1), (5, 2)):
        inverse[wall, axis] = 1 / mass[wall]
        velocities[wall, axis] = -FREE * sides.prod()**(1 / 3) / sides[axis]
    radius = np.concatenate([np.zeros(6), radii])
    arms = np.hstack([radius[pairs[:, :1]] * normals, -radius[pairs[:, 1:]] * normals])
    spin = np.concatenate([np.zeros(6), 2.5 / (radii**3 * radii**2)])
    friction = np.where(pairs[:, 0] < 6, 0, mu)
    soft = np.tile([0 if closed else SOFT, 0], (len(gaps), 1))
    bias = np.zeros(len(gaps)) if closed else np.maximum(gaps, -REACH)
    return core.SpaceBodyProblem(inverse, spin, velocities, pairs, normals, arms, bias, friction, soft), list(map(tuple, pairs.tolist()))
