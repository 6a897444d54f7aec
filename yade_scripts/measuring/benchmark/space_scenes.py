"""Random contact problems in space between spheres, boxes or capsules: the contacts of a heap in a box, with directions, masses and inertias drawn at
random. At rest nothing closes, so each has a solution. Needs no YADE."""
import numpy as np
from scipy.spatial import cKDTree, transform

from cd_engine import core
from cd_engine.core.files.space_bodies import tangents

# Of two bodies that touch: how many contacts share a normal, and how far they lie from their middle, in radii.
POINTS = {"spheres": (1, 0.0), "capsules": (2, 0.7), "boxes": (4, 0.6)}


def scene(kind, bodies, mu, seed, ratio=1.0):
    """Return the SpaceBodyProblem of a step in which gravity adds the speed 1; the radii are 1, `ratio`: of the largest to the smallest mass."""
    draw = np.random.default_rng(seed)
    side = 1.8 * (1.2 * bodies)**(1 / 3)
    x = _apart(draw.uniform(0, side, (bodies, 3)), side)
    pairs = cKDTree(x).query_pairs(2.02, output_type="ndarray")
    normals = x[pairs[:, 1]] - x[pairs[:, 0]]
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    middles = x[pairs].mean(axis=1)
    for axis, at, sign in ((2, 0, 1), (0, 0, 1), (1, 0, 1), (0, side, -1), (1, side, -1)):  # floor and walls: the last body
        near = np.flatnonzero(np.abs(x[:, axis] - at) < 0.05)
        inward = sign * np.eye(3)[[axis] * len(near)]
        pairs = np.vstack([pairs, np.stack([np.full(len(near), bodies), near], axis=1)])
        normals, middles = np.vstack([normals, inward]), np.vstack([middles, x[near] - inward])
    count, far = POINTS[kind]
    angle = draw.uniform(0, 2 * np.pi, (len(pairs), 1)) + np.arange(count) * 2 * np.pi / count
    t, s = (direction[:, None] for direction in tangents(normals))
    points = (middles[:, None] + far * (np.cos(angle)[:, :, None] * t + np.sin(angle)[:, :, None] * s)).reshape(-1, 3)
    pairs, normals = np.repeat(pairs, count, axis=0), np.repeat(normals, count, axis=0)
    inverse = np.append(ratio**-draw.uniform(0, 1, bodies), 0)
    axes = transform.Rotation.random(bodies + 1, random_state=seed).as_matrix()
    inertias = np.full((bodies + 1, 3), 2.5) if kind == "spheres" else draw.uniform(1, 4, (bodies + 1, 3))
    turned = np.einsum("nij,nj,nkj->nik", axes, inertias * inverse[:, None], axes)
    velocities = draw.normal(0, 0.3, (bodies + 1, 6)) - [0, 0, 1, 0, 0, 0]
    velocities[-1] = 0
    gaps = draw.uniform(0, 1, len(pairs)) * (draw.uniform(0, 1, len(pairs)) < 0.3)
    arms = points[:, None] - np.vstack([x, np.zeros(3)])[pairs]
    return core.SpaceBodyProblem(np.repeat(inverse[:, None], 3, axis=1), 0.5 * (turned + turned.transpose(0, 2, 1)), velocities, pairs, normals,
                                 arms.reshape(-1, 6), gaps, np.full(len(pairs), float(mu)))


def skewed(problem, share, seed):
    """Return the problem with an unsymmetric W, as some codes write it; share: of the largest entry."""
    W = problem.W.copy()
    largest = np.abs(W.data).max()
    W.data += share * largest * np.random.default_rng(seed).uniform(-1, 1, len(W.data)) * (np.abs(W.data) > 0.1 * largest)
    return core.Problem(W, problem.q, problem.mu, 3)


def _apart(x, side):
    """Return the centres, pushed apart until most of their distances are at least 1.9."""
    for _ in range(60):
        i, j = cKDTree(x).query_pairs(1.9, output_type="ndarray").T
        way = x[j] - x[i]
        push = way * (0.3 * (1.9 / np.linalg.norm(way, axis=1) - 1))[:, None]
        np.add.at(x, j, push)
        np.add.at(x, i, -push)
        x = np.clip(x, 0, [side, side, np.inf])
    return x
