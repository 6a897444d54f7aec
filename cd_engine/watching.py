"""Watches whether a simulation in YADE is still physical: any springs, and Contact Dynamics.

A check finds what no valid simulation has:
    step     the time step is above the stability limit of the present contacts (springs.py), and the motion shows it: a share of the kinetic energy
             alternates from step to step
    overlap  bodies have passed into each other
    speed    a body moves by more than its radius in a step, faster than its fall explains
    energy   there is more kinetic energy than the initial state and gravity can have given (only where nothing else does work)
    numbers  a position or a velocity is not finite
It reads the scene and changes nothing in it.
"""
import contextlib
import math
import numbers

import numpy as np

from . import engine_methods, failing, springs

LABEL, COMMAND = "watching", "import cd_engine.watching; cd_engine.watching.fire"  # of the engine that watches
FIRST = 200  # steps to the second check; each interval is four times the last one until `every`
SPRINGS, RIGID = 10_000, 1_000  # largest interval [steps]. A check costs as much as 40 to 100 steps of springs, or five of Contact Dynamics

# Share of the kinetic energy of the stiffest bodies that alternates from step to step. In drums of 500 disks it is below 1e-3 at steps below the
# limit, mostly 0.002 to 0.01 at 1.05 times the limit, 0.03 to 0.1 at 1.2 times and 0.01 to 0.25 at 1.8 times.
ALTERNATING = 0.01
STILL = 1e-9  # radii: what moves less in a step may be round-off, which an unstable mode does not enlarge where positions cannot resolve it
SAFETY = 0.9  # of a step that is recommended
OVERLAP = 0.6  # of the smaller radius. In runs with far too soft springs that are otherwise sound it reaches 0.59
# Energy that integration may add, of that available, if contacts are short: a contact entered in mid-step gains up to (w dt)^2 of the energy.
CREATED = 0.2
RAISED = 0.01  # radii by which the mean body may be raised for nothing, as when overlaps are pushed out
MOVED = 1e-12  # m: a boundary that moves further does work

# These engines do no work, or none but that of contacts that dissipate. Others may: what they add is unknown, so the energy is not checked.
PASSIVE = {"ForceResetter", "InsertionSortCollider", "InteractionLoop", "NewtonIntegrator", "ContactDynamics", "DashpotWork", "PathIndependentShear",
           "TangentialDashpots", "GlobalStiffnessTimeStepper", "VTKRecorder", "SnapshotEngine", "ForceRecorder", "TorqueRecorder"}
REPULSIVE = {"Law2_ScGeom_FrictPhys_CundallStrack", "Law2_ScGeom_FrictViscoPhys_CundallStrackVisco", "Law2_ScGeom_ViscElPhys_Basic"}


class Unstable(RuntimeError):
    """The simulation is no longer physical. step: a time step [s] that would do; None if unknown."""

    def __init__(self, message, step=None):
        super().__init__(message)
        self.step = step


class Watch:
    """Checks the scene in O. observers: labels of PyRunners that change nothing in the scene; beside others the energy is not checked."""

    def __init__(self, observers=()):
        self.observers = observers
        self.passed = -1  # step of the last check
        self.start = None  # Bodies of the first check
        self.given = 0.0  # energy [J] that was there at the first check
        self.deepest = 0.0  # overlap over the smaller radius at the first check
        self.closed = True  # whether nothing but contacts and gravity has done work so far
        self.fastest = 0.0  # highest speed [m/s] that bodies have been given: at the first check, or that of a boundary
        self.stiffest = np.zeros((2, 2))  # largest normal and tangential k/m [1/s^2] and c/m [1/s] of a contact seen

    def check(self, moved=True):
        """Raise Unstable if the scene is not physical. moved: whether the bodies have moved by the forces in O, as between two steps."""
        from yade import O
        bodies = springs.Bodies()
        contacts = springs.Springs(bodies)
        if O.iter < self.passed or self.start is not None and len(bodies.ids) != len(self.start.ids):
            self.__init__(self.observers)  # another scene, or bodies that came or went
        self.stiffest = np.maximum(self.stiffest, contacts.stiffest())
        if self.start is None:
            self._begin(bodies, contacts)
        self.fastest = max(self.fastest, _speeds(bodies)[~bodies.free[:, :3].any(axis=1)].max(initial=0))
        gravity = _gravity(O)
        traces = contacts.traces(O.dt) if _explicit(O) else np.zeros(len(bodies.ids))
        value = contacts.eigenvalue(O.dt, traces)
        what = self._numbers(O, bodies) or self._step(O, bodies, contacts, gravity, value, traces, moved) or self._overlap(O, bodies, contacts) \
            or self._speed(O, bodies, gravity) or self._energy(O, bodies, gravity, value)
        if what:
            step = self._enough(O, bodies)
            raise Unstable(f"step {O.iter}, t = {O.time:.6g} s: {what}; " + (
                f"O.dt = {O.dt:.3g} s is too long: use at most {step:.3g} s" if step else
                f"use a shorter time step than O.dt = {O.dt:.3g} s" + ", or stiffer springs" * _explicit(O)), step)
        self.passed = O.iter

    def _begin(self, bodies, contacts):
        self.start = bodies
        self.given = _kinetic(bodies) + contacts.energy()
        self.deepest = contacts.depths().max(initial=0)
        self.fastest = _speeds(bodies).max(initial=0)

    def _numbers(self, O, bodies):
        wrong = ~(np.isfinite(bodies.position).all(axis=1) & np.isfinite(bodies.velocity).all(axis=1))
        if not wrong.any():
            return ""
        what = f"the position or velocity of {bodies.name(wrong.argmax())} is not finite"
        if self.passed < 0:
            raise Unstable(f"step {O.iter}: {what}, since the first check: look for what sets its state.pos and state.vel")
        return f"{what}; this arose after step {self.passed}"

    def _step(self, O, bodies, contacts, gravity, value, traces, moved):
        """Compare the step with the limit of the contacts. A step above it may do no harm where contacts last for a few steps only, or where kn is
        not the law's stiffness: the motion has to show it."""
        if value < springs.LIMIT:
            return ""
        tight = traces >= springs.LIMIT / 2
        size = np.nanmin(bodies.radius) if np.isfinite(bodies.radius).any() else 1.0
        alternates = _alternating(O, bodies, gravity, tight & ((_speeds(bodies) + _spins(bodies)) * O.dt > STILL * size), moved)
        if alternates < ALTERNATING:
            return ""
        body = traces.argmax()
        count = (bodies.owner[contacts.ends] == body).sum()
        return (f"the time integration of the springs is unstable: {100 * alternates:.2g} % of the kinetic energy of {tight.sum()} bodies "
                f"alternates from step to step. The stiffest is {bodies.name(body)} with {count} contacts and a mass of "
                f"{bodies.mass[body]:.3g} kg")

    def _overlap(self, O, bodies, contacts):
        """Compare the overlaps with the smaller radius; those that ContactDynamics had in any step, of unknown bodies, with the largest one."""
        depths = contacts.depths()
        if not depths.max(initial=0) > max(OVERLAP, 1.1 * self.deepest):
            deepest = max((engine.deepestPenetration for engine in O.engines if hasattr(engine, "deepestPenetration")), default=0)
            largest = np.nanmax(bodies.radius, initial=0)
            return f"two bodies overlapped by {deepest:.3g} m: they pass into each other" if not deepest <= OVERLAP * largest else ""
        one, other = contacts.ends[depths.argmax()]
        return f"{bodies.name(one)} and {bodies.name(other)} overlap by {depths.max():.3g} of the smaller radius: they pass into each other"

    def _speed(self, O, bodies, gravity):
        """Compare the motion within a step with the radius. Falling bodies, which touch nothing any more, may be so fast."""
        speeds = _speeds(bodies)
        size = np.sqrt((gravity**2).sum())
        fall = (bodies.position @ gravity - (self.start.position @ gravity).min()) if size else np.zeros(len(speeds))
        explained = np.sqrt(self.fastest**2 + 2 * np.maximum(fall, 0))
        wrong = (speeds * O.dt > bodies.radius) & (speeds > 2 * explained)
        if not wrong.any():
            return ""
        body = np.where(wrong, speeds, 0).argmax()
        return (f"{bodies.name(body)} moves by {speeds[body] * O.dt / bodies.radius[body]:.3g} of its radius in a step, at {speeds[body]:.3g} m/s, "
                f"where {explained[body]:.3g} m/s could be explained")

    def _energy(self, O, bodies, gravity, value):
        """Compare the kinetic energy with what was there at the first check and what gravity has given since."""
        self.closed = self.closed and self._is_closed(O, bodies)
        if not self.closed:
            return ""
        mass = np.where(bodies.free[:, :3], bodies.mass[:, None], 0)
        released = float((mass * gravity * (bodies.position - self.start.position)).sum())
        weights = float((mass * abs(gravity) * np.nan_to_num(bodies.radius)[:, None]).sum())
        swing = value / (springs.LIMIT - value) if value < springs.LIMIT else math.inf  # of the energy within a period, see `_step`
        appeared = _kinetic(bodies) - self.given - released
        if not appeared > (CREATED + swing) * (self.given + max(released, 0)) + RAISED * weights:
            return ""
        return f"{appeared:.3g} J of kinetic energy and height appeared, beside {self.given + max(released, 0):.3g} J that were there or fell"

    def _is_closed(self, O, bodies):
        """Tell whether nothing but gravity and contacts that repel each other does work."""
        live = [engine for engine in O.engines if not engine.dead]
        alone = bodies.owner == np.arange(len(bodies.ids))
        held = alone & ~bodies.free.any(axis=1)
        still = not bodies.velocity[alone[:, None] & ~bodies.free].any() and (np.abs(bodies.position - self.start.position)[held] <= MOVED).all()
        laws = {type(law).__name__ for engine in live if hasattr(engine, "lawDispatcher") for law in engine.lawDispatcher.functors}
        pushed = O.forces.getPermForceUsed() or any(getattr(engine, "gapCorrection", 0) > 0 for engine in live)
        return bool(still and laws <= REPULSIVE and not pushed and all(
            type(engine).__name__ in PASSIVE
            or type(engine).__name__ == "PyRunner" and (engine.label in self.observers or engine.command.startswith(COMMAND)) for engine in live))

    def _enough(self, O, bodies):
        """Return a step [s] that is short enough for contacts as stiff as those seen; None if O.dt is."""
        if not _explicit(O) or not self.stiffest.any():
            return None
        # A body among six like it in the plane, or among twelve in space: twice the sum of its contacts' energies, see Springs.bound.
        weights = (8, 16) if bodies.free[:, 2].any() else (6, 6)
        stiffness, damping = np.array(weights) @ self.stiffest
        enough = SAFETY * springs.LIMIT / (damping + math.sqrt(damping**2 + springs.LIMIT * stiffness))
        return enough if enough < O.dt else None


def _explicit(O):
    return any(type(engine).__name__ == "NewtonIntegrator" and not engine.dead for engine in O.engines)


def _gravity(O):
    found = engine_methods.gravity(O.engines)
    return np.array([found[k] for k in range(3)]) if found is not None else np.zeros(3)


def _speeds(bodies):
    return np.sqrt((bodies.velocity[:, :3]**2).sum(axis=1))


def _spins(bodies):
    """Return the speeds that rotation gives to the surfaces of spheres."""
    return np.sqrt((bodies.velocity[:, 3:]**2).sum(axis=1)) * np.nan_to_num(bodies.radius)


def _kinetic(bodies):
    return 0.5 * float((np.where(bodies.free, bodies.masses, 0) * bodies.velocity**2).sum())


def _alternating(O, bodies, gravity, chosen, moved):
    """Return which share of the kinetic energy of the `chosen` bodies belongs to velocities that change their sign in this step.

    moved: whether the velocities are those after the step.
    """
    kick = np.zeros_like(bodies.velocity)
    for row, name in enumerate(bodies.ids.tolist()):
        force, torque = O.forces.f(name), O.forces.t(name)
        f, arm = np.array([force[0], force[1], force[2]]), bodies.position[row] - bodies.position[bodies.owner[row]]
        kick[bodies.owner[row]] += np.concatenate([f, np.array([torque[0], torque[1], torque[2]]) + np.cross(arm, f)])
    kick = np.divide(kick, bodies.masses, out=np.zeros_like(kick), where=bodies.free) * O.dt
    kick[:, :3] += gravity * O.dt * bodies.free[:, :3]
    one, other = bodies.velocity, bodies.velocity + (-kick if moved else kick)
    weights = np.where(bodies.free & chosen[:, None], bodies.masses, 0)
    turned, total = float((weights * np.maximum(-2 * one * other, 0)).sum()), float((weights * (one**2 + other**2)).sum())
    return turned / total if total else 0.0


_watches = {}  # {(number of YADE's scene, labels): Watch}


def of_scene(observers=()):
    """Return the Watch of YADE's present scene."""
    from yade import O
    return _watches.setdefault((O.thisScene, tuple(observers)), Watch(observers))


def forget():
    """Forget what has been seen: O has another scene."""
    _watches.clear()


@contextlib.contextmanager
def kept():
    """Within, O.load gives back the scene that is watched: what has been seen of it still counts."""
    known = dict(_watches)
    yield
    _watches.update(known)


def fire(observers, most):
    """Check the scene from within a run, and set the steps to the next check. An unstable run ends."""
    from yade import O
    watch = of_scene(observers)
    engine = next(engine for engine in O.engines if getattr(engine, "command", "") == _command(observers, most))
    engine.iterPeriod = min(4 * engine.iterPeriod if watch.start else FIRST, most or (SPRINGS if _explicit(O) else RIGID))
    try:
        names = [type(other).__name__ for other in O.engines]
        watch.check("NewtonIntegrator" in names[:O.engines.index(engine)])
    except Unstable as error:
        failing.fail(error, f"cd_engine.watch: {error}")


def watch(every=None, observers=()):
    """Return an engine that ends a run which is no longer physical; put it at the end of O.engines, of springs or of ContactDynamics.

    It checks the time step against the stiffness of the present contacts, overlaps, speeds and, where nothing but gravity and contacts does work,
    the energy. O.run(n, True), O.wait() and O.step() then raise `cd_engine.Unstable`, whose message says what happened, where, and which
    O.dt would do; a run in the background prints it and stops. The engine changes nothing in the motion.

    every      largest number of steps between two checks, by default 10000 with springs and 1000 with ContactDynamics, which costs about 1 % of a
               long run. The first checks follow each other faster
    observers  labels of PyRunners that only look; beside any other PyRunner the energy is not checked, since it might push bodies

        O.engines += [cd_engine.watch()]
    """
    from yade import wrapper
    if every is not None and not (isinstance(every, numbers.Integral) and not isinstance(every, bool) and every > 0):
        raise ValueError(f"watch: every={every!r} is out of range: it must be a whole number of steps above 0")
    if not (isinstance(observers, (list, tuple, set)) and all(isinstance(label, str) for label in observers)):
        raise ValueError(f"watch: observers={observers!r} is no list of labels, such as ['sampling']")
    return wrapper.PyRunner(command=_command(observers, every), iterPeriod=FIRST, initRun=True, updateGlobals=False, label=LABEL)


def _command(observers, most):
    return f"{COMMAND}({tuple(observers)!r}, {most and int(most)!r})"
