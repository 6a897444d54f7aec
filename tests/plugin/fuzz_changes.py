"""Changes that may happen to a scene between two steps. Each takes the Run; some return the pattern of the words with which the next step may refuse
it."""
import math

import yade
from yade.wrapper import Box, FrictMat, Sphere, Wall

from . import fuzz_laws, plane
from .fuzz_geometry import BOX, DISK, KINDS, WALL

NAN = float("nan")


def pick(run, *kinds, free=None):
    """Return a random body of these kinds, or None."""
    some = [b for b in yade.O.bodies if KINDS[type(b.shape).__name__] in (kinds or KINDS.values())
            and (free is None or free == (b.state.blockedDOFs != "xyzXYZ"))]
    return run.r.choice(some) if some else None


def add(run):
    """Add a disk at a free place."""
    run.scene.disk()


def erase(run):
    if (b := pick(run)) and len([c for c in yade.O.bodies if type(c.shape) is Sphere]) > 1:
        run.scene.permanent.pop(b.id, None)
        yade.O.bodies.erase(b.id)


def radius(run):
    if b := pick(run, DISK):
        b.shape.radius *= run.r.choice((0.3, 0.9, 1.001, 1.1))


def place(run):
    if b := pick(run, DISK):
        if run.r.random() < 0.5:
            run.scene.put_free(b.id)
        else:
            b.state.pos += (run.r.gauss(0, 0.1) * b.shape.radius, run.r.gauss(0, 0.1) * b.shape.radius, 0)


def kick(run):
    if b := pick(run, DISK, free=True):
        b.state.vel, b.state.angVel = (*run.scene.velocity(), 0), (0, 0, run.r.gauss(0, 10))


def boundary_s_velocity(run):
    if b := pick(run, BOX, WALL, free=False):
        b.state.vel = run.r.choice([(0, 0, 0), (*run.scene.velocity(), 0)])
        if type(b.shape) is Box:
            b.state.angVel = (0, 0, run.r.choice((0, 1)) * run.r.gauss(0, min(5, 0.2 / yade.O.dt)))


def boundary_s_size(run):
    if b := pick(run, BOX):
        b.shape.extents = (b.shape.extents[0] * run.r.uniform(0.5, 1.05), b.shape.extents[1] * run.r.uniform(0.5, 1.05), b.shape.extents[2])


def mass(run):
    if b := pick(run, free=True):
        factor = 10 ** run.r.uniform(-2, 2)
        b.state.mass *= factor
        b.state.inertia = [factor * i for i in b.state.inertia]


def freedom(run):
    if b := pick(run, DISK):
        b.state.blockedDOFs = run.r.choice(("zXY", "xyzXYZ", "zXYZ", "xzXY"))


def friction(run):
    """Change the friction of a material, which bodies may share."""
    if b := pick(run):
        b.mat.frictionAngle = math.atan(run.r.choice((0, 0.05, 0.5, 2)))


def material(run):
    if b := pick(run):
        b.mat = FrictMat(young=1e6, poisson=0.3, density=1000, frictionAngle=math.atan(run.r.choice((0, 0.05, 0.5, 2))))


def shape(run):
    """Replace a shape by another object of the same or another class; sometimes twice, so that one may reuse the memory of the first."""
    for _ in range(run.r.choice((1, 1, 2, 3))):
        if b := pick(run, DISK, BOX):
            size = b.shape.radius if type(b.shape) is Sphere else min(b.shape.extents[0], b.shape.extents[1])
            b.shape = None
            fixed = b.state.blockedDOFs == "xyzXYZ"
            b.shape = run.r.choice([Sphere(radius=size), Box(extents=(size, 0.6 * size, 0.5))] + fixed * [Wall(axis=1, sense=run.r.choice((0, 1)))])
            if type(b.shape) is Wall:
                b.state.pos = (0, -0.3, 0)
                b.state.angVel, b.state.ori = (0, 0, 0), yade.Quaternion((0, 0, 1), 0)


def step_length(run):
    yade.O.dt = run.scene.dt * 10 ** run.r.uniform(-1, 0.3)


def gravity(run):
    turn, cd = run.r.uniform(-3, 3), fuzz_laws.engine()
    cd.gravity = (9.81 * math.sin(turn), -9.81 * math.cos(turn), 0)
    run.scene.settings["gravity"] = tuple(cd.gravity)


def settings(run):
    from .fuzz_scene import settings as draw
    for name, value in draw(run.r).items():
        setattr(fuzz_laws.engine(), name, value)
        run.scene.settings[name] = value


def force(run):
    from .fuzz_scene import load
    if b := pick(run, free=True):
        load(run.scene, b.id, tuple(b.state.mass * run.r.gauss(0, 10) for _ in range(2)) + (0,))


def contacts(run):
    """Remove interactions, or change the forces on them."""
    some = [i for i in yade.O.interactions]
    if some and run.r.random() < 0.7:
        i = run.r.choice(some)
        if i.isReal and run.r.random() < 0.5:
            i.phys.normalForce = (0, 1e3, 0)
        else:
            yade.O.interactions.erase(i.id1, i.id2)
    else:
        yade.O.interactions.clear()


def save_and_load(run):
    """Save and load the scene, in memory or in a file; YADE keeps no permanent forces."""
    references = dict(run.watch.references)
    if run.r.random() < 0.5:
        yade.O.saveTmp()
        run.steps(run.r.choice((0, 5)))
        yade.O.loadTmp()
    else:
        path = str(run.folder / f"scene{run.r.choice(('.yade.gz', '.xml'))}")
        yade.O.save(path)
        run.steps(run.r.choice((0, 5)))
        yade.O.load(path)
        if run.r.random() < 0.5:
            run.watch.references = dict(references)
            run.after_load()
            run.steps(5)
            yade.O.reload()
    run.watch.references = references
    run.after_load()


def new_engines(run):
    """Set Contact Dynamics anew: overlaps are taken over anew, and may have become too deep for that."""
    run.set_engines()
    return fuzz_laws.TOO_DEEP


def springs(run):
    """Run YADE's own springs for a while, then Contact Dynamics again."""
    import cd_engine
    cd_engine.release()
    scene = yade.O
    scene.engines = plane.springs(run.scene.settings["gravity"])
    lightest = min((b.state.mass for b in scene.bodies if b.state.blockedDOFs != "xyzXYZ"), default=1)
    dt, scene.dt = scene.dt, min(scene.dt, 0.1 * math.sqrt(lightest / 1e6))
    scene.run(run.r.choice((1, 50, 400)), True)
    scene.dt = dt
    run.set_engines()
    return fuzz_laws.TOO_DEEP


def interlude(run):
    """Make single steps."""
    for _ in range(run.r.choice((1, 3))):
        run.step()


def pause(run):
    """Stop the run before its planned end."""
    run.stop_at = yade.O.iter + 3
    run.steps(50)


# What makes the scene invalid: the object of a body, its attribute, and a bad value in place of the old one.
BAD = {
    "radius": ("shape", "radius", lambda r, old: r.choice((0, -0.01, NAN))),
    "z": ("state", "pos", lambda r, old: (*old[:2], 5)),
    "velocity": ("state", "vel", lambda r, old: (NAN, 0, 0)),
    "mass": ("state", "mass", lambda r, old: r.choice((0, -1, NAN))),
    "friction": ("mat", "frictionAngle", lambda r, old: r.choice((-0.1, 1.6, NAN))),
    "extents": ("shape", "extents", lambda r, old: (NAN, 0.1, 0.5)),
    "axis": ("shape", "sense", lambda r, old: 5),
}


def bad(run):
    """Make the scene invalid: the next step must refuse it with the body's name. Then repair it."""
    b = pick(run, DISK)
    kind = run.r.choice(tuple(BAD))
    if kind in ("extents", "axis"):
        b = pick(run, BOX if kind == "extents" else WALL)
    if not b or (kind == "mass" and b.state.blockedDOFs == "xyzXYZ"):
        return None
    run.changes[-1] += f" ({kind} of #{b.id})"
    where, attribute, value = BAD[kind]
    owner = getattr(b, where)
    old = getattr(owner, attribute)
    old = old if isinstance(old, (int, float)) else tuple(old)
    setattr(owner, attribute, value(run.r, old))
    said = run.refused()
    setattr(owner, attribute, old)
    users = [c.id for c in yade.O.bodies if c.mat.id == owner.id] if kind == "friction" and owner.id >= 0 else [b.id]
    if kind == "z" and said:
        users = [c.id for c in yade.O.bodies]  # the first disk says which plane it is
    if not said:
        raise fuzz_laws.Broken(f"{kind} of {type(b.shape).__name__} #{b.id} is not refused, step {yade.O.iter}")
    if not any(f"#{k}" in said for k in users) or "\n" in said.strip():
        raise fuzz_laws.Broken(f"refusal of {kind} of #{b.id} says: {said}")
    return None


# Those that can be made within a run, by an engine ahead of the others, and those that cannot.
WITHIN = (add, erase, radius, place, kick, boundary_s_velocity, boundary_s_size, mass, freedom, friction, material, shape, step_length, gravity,
          settings, force, contacts)
BETWEEN = WITHIN + (save_and_load, save_and_load, new_engines, springs, interlude, pause, bad)
