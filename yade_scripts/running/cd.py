"""Sets the engines of Contact Dynamics; the load of the walls is applied before the contacts are solved."""
from yade import O
from yade.wrapper import FrictMat

import cd_engine
from yade_scripts.running import hooks, walls

# Parameters that are attributes of ContactDynamics: attribute -> parameter.
SETTINGS = {"tolerance": "tolerance", "flowTolerance": "flow_tolerance", "maxIterations": "max_iterations",
            "fixedIterations": "fixed_iterations", "method": "method_cd",
            "warmStart": "warm_start", "seed": "solver_seed", "restitution": "restitution", "gapCorrection": "gap_correction",
            "allowedOverlap": "allowed_overlap", "handover": "reference_overlaps"}


def set_engines(full, scene, load=None):
    """Set O.engines for a scene. Its free walls are loaded by PlateLoads of these settings, or not at all.

    Samples are taken before a step begins: positions after the last step, forces that acted in it. The load is that of the
    middle of the step (Moreau-Jean scheme, theta = 1/2). No runner is due at every step: before each step in which one is
    due, ContactDynamics writes its state to the scene, which costs a quarter of a step of a flow.
    """
    _forget_dashpots()
    settings = {attribute: full[name] for attribute, name in SETTINGS.items()}
    # With few sweeps overlaps must cause impulses, or they cause no forces.
    reset, collider, engine = cd_engine.engines(gravity=(0, -full["gravity"], 0), gapVelocity=full["fixed_iterations"] > 0, **settings)
    engine.label = "contact_dynamics"  # its name at the console
    engines = [hooks.runner(lambda: scene.observer(), iterPeriod=scene.every, initRun=True, label=hooks.SAMPLING), reset, collider]
    if load is not None:
        scene.load = walls.Load()
        engines.append(cd_engine.PlateLoads(**load))
    O.engines = engines + [engine]


def _forget_dashpots():
    """Give all bodies a FrictMat of the same friction: ContactDynamics warns of any other material, part of which it ignores."""
    plain = {}
    for body in O.bodies:
        values = {name: getattr(body.material, name) for name in ("frictionAngle", "density", "label")}
        body.material = plain.setdefault(tuple(values.values()), FrictMat(**values))


def run(scene, simulate=hooks.simulate):
    """Run a scene to its end by simulate(steps); the last sample follows the last step."""
    simulate(scene.every * scene.samples)
    scene.observer()
