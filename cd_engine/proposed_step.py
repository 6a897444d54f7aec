"""Proposes a time step from the bodies in the scene."""
import math

from . import engine_methods

SHARE, BOUNCING = 0.25, 0.05
STIFF = 100  # k h^2 W_nn with springs: from there on a step takes as many sweeps as a rigid one
UPRIGHT = 1e-6  # sine of the angle up to which rounding may tilt an upright face


def timeStep(gravity=None, speed=None, share=None):
    """Propose O.dt [s] for ContactDynamics: share * min(R / v, sqrt(R / g), sqrt(R / a)), or less with a stiffness.

    R [m]      radius of the smallest disk that may move
    g [m/s^2]  length of `gravity`; by default that of the first live engine of O.engines that has one: set O.engines first
    v [m/s]    highest speed to expect: `speed`, or by default sqrt(v0^2 + 2 g h). v0 is the highest speed present or that an engine gives a boundary
               (RotationEngine and its like, a strain rate of PlateLoads); of a body that turns, that of its farthest point, because friction can
               turn spin into motion.
               h [m] is the height from the highest disk down to the lowest body; for a Box, down to the lowest corner of its upper faces, where a
               disk that slides down leaves it
    a [m/s^2]  largest acceleration that a permanent force (O.forces.setPermF), or a stress of PlateLoads, gives a body that nothing holds; 0 if
               `speed` is given. Give `speed`
               where a force moves a body over a long way, and for longer steps where a light lid presses on disks already
    share      largest distance that a disk moves in one step at that speed, over its radius [1]; by default 0.25, or 0.05 if ContactDynamics has a
               restitution, since disks that bounce in a cluster overlap by up to their displacement in a step, and stay overlapped. An example:
               the disks that left a hopper of 600 disks in 0.6 s were 155 at 1/16, 152 at 1/8, 151 at 1/4, 146 at 1/2 and at 1 (means of four seeds)

    With a stiffness (of ContactDynamics, or of the materials) the step is at most h with k_n h^2 (2/m) = 100, m the smallest mass [kg] of a
    disk: about
    as many sweeps as errors of the quasi-static motion allow. Impacts whose rebound matters need a hundredth of it.

    Rigid contacts have no stiffness that would limit the time step, but geometry limits it: a step uses the normals at its middle, so a disk
    must move by less than its radius in a step. sqrt(R / g) is the time in which a disk falls from rest by half its radius.
    If other forces act, such as those of a ForceEngine, give the `speed` that they cause. With a drag of -gamma m v keep O.dt below 1/gamma, since
    beyond it the velocity changes its sign in every step. Call this function again when the scene has changed.

        O.dt = cd_engine.timeStep()

    Raises ValueError if no disk can move, if no gravity or no speed is known, or if an argument is out of range. With h = 0.5 m and R = 5 mm it
    returns 0.4 ms.
    """
    from yade import O
    if share is None:
        bounces = any((getattr(engine, "restitution", 0) > 0 or getattr(engine, "en", None)) and not engine.dead for engine in O.engines)
        share = BOUNCING if bounces else SHARE
    if not (engine_methods.is_number(share) and share > 0):
        raise ValueError(f"timeStep: share={share!r} is out of range: it must be a number above 0")
    if speed is not None and not (engine_methods.is_number(speed) and speed >= 0):
        raise ValueError(f"timeStep: speed={speed!r} m/s is out of range: it must be a number, at least 0")
    if gravity is None:
        gravity = engine_methods.gravity(O.engines)
        if gravity is None:
            raise ValueError("timeStep: no engine of O.engines has a gravity. Set O.engines first, or give it: timeStep(gravity=(0, -9.81, 0))")
    try:
        x, y, z = gravity
        g = math.hypot(x, y, z)
    except (TypeError, ValueError):
        g = math.nan
    if not math.isfinite(g):
        raise ValueError(f"timeStep: gravity={gravity!r} is not a vector of three finite numbers, such as (0, -9.81, 0)")
    movable = [body for body in O.bodies if type(body.shape).__name__ == "Sphere" and not set("xyz") <= set(body.state.blockedDOFs)]
    if not movable:
        raise ValueError("timeStep: no disk in the scene can move. Append the disks first. If an engine makes them later, set O.dt to a "
                         "quarter of their smallest radius over their highest speed")
    if any(part and all(axis in body.state.blockedDOFs for body in movable) for axis, part in zip("xyz", (x, y, z))):
        raise ValueError(f"timeStep: gravity={tuple(gravity)} m/s^2 points along an axis along which no disk can move. Let it point in the plane of "
                         "the scene")
    radius = min(body.shape.radius for body in movable)
    pressed = _pressed(O) if speed is None else 0
    if speed is None:
        fall = _fall(O.bodies, movable, [x / g for x in gravity]) if g else 0
        speed = math.sqrt(max([*map(_speed, O.bodies), *map(_driven, O.engines)])**2 + 2 * g * fall)
    times = ([radius / speed] if speed else []) + [math.sqrt(radius / acceleration) for acceleration in (g, pressed) if acceleration]
    if not times:
        raise ValueError("timeStep: nothing moves, and there is neither gravity nor a permanent force or load, so no speed can be estimated. Set "
                         "O.engines first, with their gravity, or give a speed: timeStep(speed=0.1), in m/s")
    return min(share * min(times), _springs_step(O, movable))


def _springs_step(O, movable):
    """Return the longest step [s] for the stiffnesses of the engine; infinite without any."""
    engine = next((engine for engine in O.engines if type(engine).__name__ == "ContactDynamics" and not engine.dead), None)
    kn = math.inf if engine is None else engine.stiffness
    if engine is not None and engine.materialStiffness:
        # YADE's functors take a facet for a sphere of twice the radius.
        share = 4 / 3 if any(type(body.shape).__name__ == "Facet" for body in O.bodies) else 1
        kn = share * max(body.mat.young * body.shape.radius for body in movable)
    return math.sqrt(STIFF * min(body.state.mass for body in movable) / (2 * kn)) if 0 < kn < math.inf else math.inf


def _pressed(O):
    """Return the largest acceleration [m/s^2] that a permanent force gives a body in a direction in which it is free."""
    def pressed(body):
        force = O.forces.permF(body.id)
        size = math.hypot(*(force[k] for k in range(3) if "xyz"[k] not in body.state.blockedDOFs))
        if not math.isfinite(size):
            raise ValueError(f"timeStep: the permanent force {tuple(force)} N on body #{body.id} is not finite")
        return size / body.state.mass if body.state.mass > 0 else 0

    largest = max([_loaded(O, engine) for engine in O.engines if type(engine).__name__ == "PlateLoads" and not engine.dead], default=0)
    if not O.forces.getPermForceUsed():
        return largest
    if not engine_methods.runs_besides():  # whose engines add forces meanwhile
        O.forces.f(0, sync=True)  # before YADE has summed forces once permF gives 0
    return max(largest, *map(pressed, O.bodies))


def _loaded(O, loads):
    """Return the largest acceleration [m/s^2] that the stresses of PlateLoads give a plate before they rise."""
    pairs, length = _plates(O, loads), _lengths(O, loads)
    return max((abs(loads.goals[axis]) * length[axis - 1] * length[axis - 2] / body.state.mass
                for axis, pair in enumerate(pairs) if loads.stressMask >> axis & 1
                for body in pair if body.state.mass > 0 and "xyz"[axis] not in body.state.blockedDOFs), default=0)


def _plates(O, loads):
    """Return the plates of PlateLoads, a list for each axis."""
    return [[O.bodies[id] for id in loads.plates[2 * axis:2 * axis + 2] if 0 <= id < len(O.bodies) and O.bodies[id]] for axis in range(3)]


def _lengths(O, loads):
    """Return the distances [m] between the centres of the plates of PlateLoads along x, y and z; its depth where there are none."""
    return [abs(pair[1].state.pos[axis] - pair[0].state.pos[axis]) if len(pair) == 2 else loads.depth for axis, pair in enumerate(_plates(O, loads))]


def _size(body):
    """Return the distance [m] of the farthest point of a body from its centre."""
    kind = type(body.shape).__name__
    corners = {"Box": lambda shape: [shape.extents], "Facet": lambda shape: shape.vertices}.get(kind, lambda shape: [])(body.shape)
    return body.shape.radius if kind == "Sphere" else max((corner.norm() for corner in corners), default=0)


def _speed(body):
    """Return the largest speed [m/s] that a point of a body can have."""
    if not all(map(math.isfinite, (*body.state.pos, *body.state.vel, *body.state.angVel))):
        raise ValueError(f"timeStep: body #{body.id} has a position or a velocity that is not finite. Set its state.pos, state.vel and state.angVel")
    return body.state.vel.norm() + body.state.angVel.norm() * _size(body)


def _driven(engine, ids=None):
    """Return the largest speed [m/s] that PlateLoads or one of YADE's kinematic engines gives a point of its bodies. ids: others than its own."""
    from yade import O, wrapper
    if engine.dead:
        return 0
    if type(engine).__name__ == "PlateLoads":
        rates = [0 if engine.stressMask >> axis & 1 else abs(engine.goals[axis]) * (1 + abs(engine.rise[axis])) for axis in range(3)]
        return max(rate * length for rate, length in zip(rates, _lengths(O, engine)))
    combined = type(engine).__name__ == "CombinedKinematicEngine"
    if not combined and not isinstance(engine, wrapper.KinematicEngine):
        return 0
    ids = engine.ids if ids is None else ids
    if combined:
        return sum(_driven(part, ids) for part in engine.comb)
    along = abs(getattr(engine, "linearVelocity", 0)) + abs(getattr(engine, "velocity", 0))  # of a HelixEngine, of a TranslationEngine
    about = abs(getattr(engine, "angularVelocity", 0))
    if isinstance(engine, wrapper.HarmonicRotationEngine):
        about = 2 * math.pi * abs(engine.A * engine.f)
    elif isinstance(engine, wrapper.HarmonicMotionEngine):
        along = 2 * math.pi * math.hypot(*(size * rate for size, rate in zip(engine.A, engine.f)))
    elif isinstance(engine, wrapper.InterpolatingHelixEngine):
        about = max(map(abs, engine.angularVelocities), default=0)
        along = about * abs(engine.slope)
    if not (math.isfinite(along) and math.isfinite(about)):
        raise ValueError(f"timeStep: {type(engine).__name__} has a velocity that is not finite. Set its attributes to finite numbers")
    bodies = [O.bodies[id] for id in ids if about and 0 <= id < len(O.bodies)]
    return along + about * max((_arm(engine, body) for body in bodies if body), default=0)


def _arm(engine, body):
    """Return the distance [m] of the farthest point of a body from the axis about which an engine turns it, or the radius on which it moves it."""
    if hasattr(engine, "radius"):  # a BicyclePedalEngine
        return engine.radius
    centre = getattr(engine, "zeroPoint", body.state.pos) if getattr(engine, "rotateAroundZero", False) else body.state.pos
    away, axis = body.state.pos - centre, engine.rotationAxis
    return _size(body) + (away - axis * (away.dot(axis) / max(axis.dot(axis), 1e-300))).norm()


def _fall(bodies, movable, down):
    """Return the distance [m] along the unit vector `down` from the highest of `movable` to the lowest body."""
    from yade import Vector3

    def depth(body):
        centre = sum(x * d for x, d in zip(body.state.pos, down))
        if type(body.shape).__name__ == "Facet":
            return centre + max((body.state.ori * corner).dot(Vector3(*down)) for corner in body.shape.vertices)
        if type(body.shape).__name__ != "Box":
            return centre
        # Of each pair of opposite faces one is the upper one, unless both are vertical. The lowest corner of the upper face lies half[k] above the
        # centre along the normal k of the face, and below it along the other directions.
        share = [abs(d) for d in body.state.ori.conjugate() * Vector3(*down)]
        half = [extent * s for extent, s in zip(body.shape.extents, share)]
        return centre + max(sum(half) - 2 * h for h, s in zip(half, share) if s > UPRIGHT)

    across = max(range(3), key=lambda axis: abs(down[axis]))  # only a Wall across gravity has a height
    below = [depth(body) for body in bodies if type(body.shape).__name__ != "Wall" or body.shape.axis == across]
    return max(below) - min(map(depth, movable))
