"""The same scene twice: mirrored, turned by a right angle, its bodies in another order, solved whole instead of by islands. Motions must agree.

Compared after one step from the same places, velocities and overlaps, without a first guess: over more steps impacts would multiply differences.
"""
import re

import numpy as np
import yade
from yade import utils

from yade_scripts.running import hooks

from . import fuzz_geometry
from .fuzz_laws import SLACK_WHOLE, TOO_DEEP, Watch, engine

MIRROR = np.diag([-1., 1.])
QUARTER = np.array([[0., -1.], [1., 0.]])
SAME = np.eye(2)


def describe(permanent):
    """All bodies, by which the scene can be made again, and the permanent forces on them."""
    found = []
    for b in yade.O.bodies:
        s, kind = b.state, type(b.shape).__name__
        q = s.ori
        found.append({"kind": kind, "x": np.array([s.pos[0], s.pos[1]]), "angle": 2 * np.arctan2(q[2], q[3]), "v": np.array([s.vel[0], s.vel[1]]),
                      "spin": s.angVel[2],
                      "mass": s.mass, "inertia": s.inertia[2], "blocked": s.blockedDOFs, "friction": b.mat.frictionAngle,
                      "radius": getattr(b.shape, "radius", 0), "half": tuple(getattr(b.shape, "extents", ())), "axis": getattr(b.shape, "axis", 0),
                      "sense": getattr(b.shape, "sense", 0), "force": np.array(permanent.get(b.id, (0, 0, 0)))[:2]})
    return found


def make(bodies, order, by, gravity, settings, dt):
    """The bodies in another order, mirrored or turned by the matrix `by`; makes one step. Velocities (n, 3) in the old order and frame."""
    turns = np.linalg.det(by)
    yade.O.reset()
    for k in order:
        b = bodies[k]
        x, v = by @ b["x"], by @ b["v"]
        material = yade.O.materials.append(yade.wrapper.FrictMat(young=1e6, poisson=0.3, density=1000, frictionAngle=b["friction"]))
        if b["kind"] == "Sphere":
            body = utils.sphere((*x, 0), b["radius"], material=material)
        elif b["kind"] == "Box":
            # Of the turned box the first axis is the old one's, turned.
            first = by @ (np.cos(b["angle"]), np.sin(b["angle"]))
            body = utils.box((*x, 0), b["half"], orientation=yade.Quaternion((0, 0, 1), float(np.arctan2(first[1], first[0]))), fixed=True,
                             material=material)
        else:
            normal = by @ (b["axis"] == 0, b["axis"] == 1)
            axis = int(abs(normal[1]) > 0.5)
            body = utils.wall(float(x[axis]), axis=axis, sense=int(round(b["sense"] * normal[axis])), material=material)
            body.state.pos = (*x, 0)
        s = body.state
        s.mass, s.inertia, s.blockedDOFs = b["mass"], (b["inertia"],) * 3, _blocked(b["blocked"], by)
        s.vel, s.angVel = (*v, 0), (0, 0, turns * b["spin"])
        yade.O.bodies.append(body)
    import cd_engine
    yade.O.dt = dt
    g = by @ np.array(gravity)[:2]
    watch = Watch()
    reset, collider, cd = cd_engine.engines(**settings | {"gravity": (*g, 0), "warmStart": False, "handover": True})
    yade.O.engines = [reset, collider, hooks.runner(watch.before, iterPeriod=1, initRun=True), cd,
                      hooks.runner(watch.after, iterPeriod=1, initRun=True)]
    for new, old in enumerate(order):
        force = by @ bodies[old]["force"]
        if force.any():
            yade.O.forces.setPermF(new, (*force, 0))
    hooks.simulate(1)
    v = np.zeros((len(bodies), 3))
    acts = np.zeros(len(bodies))
    for new, old in enumerate(order):
        s = yade.O.bodies[new].state
        v[old] = *(by.T @ (s.vel[0], s.vel[1])), turns * s.angVel[2]
        acts[old] = watch.acts[new]
    return v, acts, engine().converged


def _blocked(blocked, by):
    """Freedoms of x and y change places where the scene is turned."""
    if abs(by[0, 0]) > 0.5:
        return blocked
    return "".join({"x": "y", "y": "x"}.get(dof, dof) for dof in blocked)


def leaves_open():
    """Whether a disk lies on two boundaries at one place that rub differently: any share of its weight on each is a solution, and motions differ."""
    p = fuzz_geometry.Picture((0, 0, 0))
    a, b = p.pairs()
    normal, gap, _ = fuzz_geometry.touch(p, p.x, a, b)
    near = np.flatnonzero(gap < 1e-3 * p.radius[b])
    mu = np.minimum(p.mu[a], p.mu[b])
    same = (b[near, None] == b[near]) & (normal[near] @ normal[near].T > 1 - 1e-6)
    return bool((same & (mu[near, None] != mu[near])).any())


def compare(run):
    """Makes the twins of the scene as it is, which is gone afterwards; how many were compared. Overlaps too deep to be taken over are compared with
    none, nor is what has many solutions."""
    try:
        return _compare(run)
    except RuntimeError as refused:
        if re.search(TOO_DEEP, str(refused)):
            return 0
        raise


def _compare(run):
    settings, dt = run.scene.settings | {"restitution": 0.0, "fixedIterations": 0, "maxIterations": 20000, "gapCorrection": 0.0}, yade.O.dt
    bodies = describe(run.scene.permanent)
    gravity = tuple(engine().gravity)
    order = list(range(len(bodies)))
    other = run.r.sample(order, len(order))
    first, acts, solved = make(bodies, order, SAME, gravity, settings, dt)
    if leaves_open():
        return 0
    sizes = np.array([[1, 1, max(b["radius"], *b["half"][:2], 0) if b["half"] or b["radius"] else 1] for b in bodies])
    masses = np.array([[b["mass"], b["mass"], b["inertia"]] for b in bodies])
    compared = 0
    for name, twin in {"mirrored": (order, MIRROR, settings), "turned": (order, QUARTER, settings), "in another order": (other, SAME, settings),
                       "solved by islands or not": (order, SAME, settings | {"reduce": not settings["reduce"]})}.items():
        v, acts_too, solved_too = make(bodies, twin[0], twin[1], gravity, twin[2], dt)
        if not (solved and solved_too):
            continue
        compared += 1
        blocked = np.array([[dof in b["blocked"] for dof in "xyZ"] for b in bodies])
        off = np.where(blocked, 0, masses * np.abs(v - first))
        allowed = (SLACK_WHOLE * max(settings["tolerance"], settings["flowTolerance"]) * np.maximum(acts, acts_too)[:, None] * sizes
                   + 1e-9 * masses * (np.abs(v) + np.abs(first)).max())
        run.watch.hold(f"the same scene {name}", off.ravel(), allowed.ravel(),
                       lambda i: f"body #{i // 3} ({bodies[i // 3]['kind']}), {'x y turn'.split()[i % 3]}")
    return compared
