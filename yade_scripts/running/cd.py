"""Sets the engines of Contact Dynamics; the load of the walls is applied before the contacts are solved."""
from yade import O
from yade.wrapper import FrictMat

import cd_engine
from yade_scripts.running import bounds, hooks, walls

# Parameters that are attributes of ContactDynamics: attribute -> parameter.
SETTINGS = {"tolerance": "tolerance", "maxIterations": "max_iterations", "fixedIterations": "fixed_iterations", "method": "method_cd",
            "warmStart": "warm_start", "seed": "solver_seed", "restitution": "restitution", "gapCorrection": "gap_correction",
            "allowedOverlap": "allowed_overlap", "handover": "reference_overlaps"}


class Watch:
    """Keeps the largest residual between two samples; the engine keeps only that of its last step."""

    def __init__(self, full, engine):
        self.full, self.engine, self._largest = full, engine, 0.0

    def look(self):
        """Check every step; raise OutOfBounds if the run has to end."""
        bounds.check_step(self.full, O.iter, self.engine.residual, self.engine.maxPenetration)
        self._largest = max(self._largest, self.engine.residual)

    def take(self):
        """Return the largest error e since the last call."""
        largest, self._largest = self._largest, 0.0
        return largest


def set_engines(full, scene, goals=None):
    """Set O.engines for a scene. Its free walls are loaded by goals(t) -> (sigma1, sigma2) [Pa], or not at all.

    Samples are taken before a step begins: positions after the last step, forces that acted in it. The load is that of the
    middle of the step (Moreau-Jean scheme, theta = 1/2).
    """
    _forget_dashpots()
    settings = {attribute: full[name] for attribute, name in SETTINGS.items()}
    reset, collider, engine = cd_engine.engines(gravity=(0, -full["gravity"], 0), **settings)
    engine.label = "contact_dynamics"  # its name at the console
    scene.watch = Watch(full, engine)
    engines = [hooks.runner(lambda: scene.observer(), iterPeriod=scene.every, initRun=True, label=hooks.SAMPLING), reset, collider]
    if goals is not None:
        scene.load = walls.ForceLoad(goals, implicit=True)
        engines.append(hooks.runner(scene.load.apply, iterPeriod=1, initRun=True))
    O.engines = engines + [engine, hooks.runner(scene.watch.look, iterPeriod=1, initRun=True, label=hooks.WATCHING)]


def _forget_dashpots():
    """Give all bodies a FrictMat of the same friction: ContactDynamics says of every other material that it leaves part of it unused."""
    plain = {}
    for body in O.bodies:
        values = {name: getattr(body.material, name) for name in ("frictionAngle", "density", "label")}
        body.material = plain.setdefault(tuple(values.values()), FrictMat(**values))


def bind(full, scene):
    """Give the scene's functions the engine that is in O now; O.load replaces the object."""
    scene.watch.engine = hooks.engine("ContactDynamics")


def run(scene, simulate=hooks.simulate):
    """Run a scene to its end by simulate(steps); the last sample follows the last step."""
    simulate(scene.every * scene.samples)
    scene.observer()
