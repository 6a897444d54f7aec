"""Contact Dynamics as an engine of the packaged YADE.

Inside YADE (a script, a batch job, the console):

    import cd_engine
    O.engines = cd_engine.engines(gravity=(0, -9.81, 0))

`ContactDynamics` is a C++ class registered in YADE; `help(cd_engine.ContactDynamics)` shows its attributes, units and ranges. Three further engines
are for the springs of Molecular Dynamics and stand right after InteractionLoop: `PathIndependentShear` replaces their tangential law,
`TangentialDashpots` adds dashpots to it, `DashpotWork` sums the energy that their normal dashpots dissipate. `PlateLoads` loads the plates around a
sample, for both methods. Import this module before `O.load` of a scene that contains one of them. `watch` is for both methods, too: an engine that
ends a run which is no longer physical. `picture` and `film` draw scenes of both.
"""
import atexit
import importlib
import math
import sys

from . import engine_methods, run_hooks
from .pictures import film, picture
from .proposed_step import timeStep
from .watching import Unstable, watch

ENGINES = ("ContactDynamics", "DashpotWork", "PathIndependentShear", "PlateLoads", "TangentialDashpots")
__all__ = [*ENGINES, "TESTED", "Unstable", "engines", "film", "methods", "picture", "release", "timeStep", "watch"]

# For the motion of single bodies, or for means: the tolerance of flows of rigid bodies, and that of contacts with a stiffness, which is relative to
# the motion of a step. Rigid bodies at rest need more accuracy than flows.
FLOW_TOLERANCES = {"bodies": 1e-4, "means": 1e-3}
SPRING_TOLERANCES = {"bodies": 0.1, "means": 1.0}

# Versions of YADE that all tests were run with, and the Debian that packages them. The compiled module checks the binary interface of the running
# YADE. Any other version that passes this check runs, too, with a message that nobody has tested it.
TESTED = {"2023.02a": "12", "2025.2.0": "13", "2026.1.0": "testing"}


def _plugin():
    """Return the compiled module, loaded once. Raise ImportError, with the remedy, if it cannot be loaded."""
    name = __name__ + "._yade_plugin"
    if name in sys.modules:
        return sys.modules[name]
    if "yade" not in sys.modules:
        raise ImportError("an engine of cd_engine needs a running YADE: use it in a script run by `yade`, at YADE's console, or after `import yade`.")
    from yade import config
    if config.highPrecisionName != "PrecisionDouble":
        raise ImportError(f"cd_engine computes in double precision; this is YADE {config.version} with {config.highPrecisionDecimalPlaces} decimal "
                          f"places, from {config.libDir}. Start `yade` or `yade-double`.")
    try:
        module = importlib.import_module(name)
    except ModuleNotFoundError:
        raise ImportError("cd_engine is not built: run `make build` at the top of the repository.") from None
    except ImportError as error:
        if error.path is None:  # the module itself has refused
            raise
        raise ImportError(f"cd_engine's compiled module does not load into YADE {config.version} ({error}): run `make build` at the top of the "
                          f"repository; if that does not help, this YADE lacks what the engine needs. Tested with {_tested()}.") from None
    if config.version not in TESTED:
        print(f"cd_engine: nobody has tested it with YADE {config.version}, but every check of the binary interface has passed. "
              f"Tested with {_tested()}.", file=sys.stderr)
    from yade import wrapper
    for engine in ENGINES:
        engine_methods.complete(getattr(wrapper, engine))
    wrapper.ContactDynamics.summary, wrapper.ContactDynamics.exportProblem = engine_methods.summary, engine_methods.exportProblem
    atexit.register(_report)
    run_hooks.install(module, ENGINES)
    return module


def _tested():
    return ", ".join(f"{version} (Debian {debian})" for version, debian in TESTED.items())


def _report():
    """Print at the end of the process how many steps missed their tolerance; the engine itself warns only at the first one."""
    from yade import O
    for engine in O.engines:
        if type(engine).__name__ == "ContactDynamics" and engine.unconvergedSteps > 1:
            print(f"ContactDynamics: {engine.unconvergedSteps} of {engine.steps} steps missed their tolerance.", file=sys.stderr)


def __getattr__(name):
    if name in ENGINES:
        _plugin()
        from yade import wrapper
        return getattr(wrapper, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__():
    """Return what a user may call; the engines only once they are there, since help() asks for everything that is listed."""
    return [name for name in __all__ if name in globals() or __name__ + "._yade_plugin" in sys.modules]


def methods():
    """Return the names of the contact solvers that `ContactDynamics.method` accepts."""
    return list(_plugin().methods())


def engines(*, accuracy="bodies", **settings):
    """Return the list for `O.engines`: ForceResetter, collider, ContactDynamics(**settings).

    accuracy: what flows are to be right in. "bodies": the motion of single bodies; "means": means over many bodies, or over time, as a rate or a
        slope, in less time. ValueError for another word, and beside settings that say how exact steps are.
    settings: attributes of `ContactDynamics`. Without a tolerance, steps are solved to 1e-4 (for means to 1e-3) after bodies have flowed or collided,
        and to 1e-6 when nothing slides or collides any more (flowTolerance). With a stiffness and without a tolerance, errors may be a tenth (for
        means the whole) of the motion of a step, which the next step corrects.

    Insert engines that push or move bodies (ForceEngine, PyRunner) before ContactDynamics. ContactDynamics itself finds the pairs that may touch. The
    collider is for springs and for YADE's tools; it does nothing during a run.
    """
    _plugin()
    from yade import wrapper as w
    springs = settings.get("materialStiffness") or settings.get("stiffness", math.inf) != math.inf
    if accuracy not in FLOW_TOLERANCES:
        raise ValueError(f"engines(accuracy={accuracy!r}): it must be one of {', '.join(map(repr, FLOW_TOLERANCES))}")
    said = [name for name in ("tolerance", "flowTolerance", "fixedIterations") if name in settings]
    if accuracy != "bodies" and said:
        raise ValueError(f"engines(accuracy={accuracy!r}) sets the tolerance; it has no meaning beside {said[0]}. Leave one of the two out.")
    usual = {"tolerance": SPRING_TOLERANCES[accuracy]} if springs else {"flowTolerance": FLOW_TOLERANCES[accuracy]}
    _let_colliders_begin()
    return [
        w.ForceResetter(),
        # With any other verletDist it would ask for a NewtonIntegrator.
        w.InsertionSortCollider([w.Bo1_Sphere_Aabb(), w.Bo1_Box_Aabb(), w.Bo1_Wall_Aabb(), w.Bo1_Facet_Aabb()], verletDist=0),
        w.ContactDynamics(**({} if "tolerance" in settings else usual) | settings),
    ]


def _let_colliders_begin():
    """Mark YADE's list of bodies as outdated, so that a new collider reads it.

    If a body was erased after an earlier collider had run, a new collider never reads the list and finds no new pair:
    InsertionSortCollider.numReinit stays 0 (YADE 2023.02a to 2026.1.0, with springs as well).
    """
    from yade import O
    if O.bodies.enableRedirection:
        O.bodies.enableRedirection = False
        O.bodies.enableRedirection = True  # setting it marks the list as outdated


def release():
    """Remove the contacts that Contact Dynamics made, so that the scene can go on with springs.

    These contacts have a FrictPhys without stiffness, which YADE's Ip2 functors would not replace. Call this function before you set the engines of
    the springs. Give these engines a collider of their own, which finds the contacts again. Raises RuntimeError while a run goes on: colliders begin
    anew, and overlaps are taken over, when a run begins.
    """
    _plugin()
    from yade import O
    if O.running:
        raise RuntimeError("cd_engine.release: a run goes on. Let it end, call release() and set the engines of the springs, then start the next run")
    _let_colliders_begin()
    for contact in list(O.interactions):
        if contact.isReal and type(contact.phys).__name__ == "FrictPhys" and contact.phys.kn == 0:
            O.interactions.erase(contact.id1, contact.id2)
    O.interactions.eraseNonReal()  # so that the new collider lists all pairs in an order of its own


if "yade" in sys.modules:
    try:
        _plugin()
    except ImportError:
        pass  # the error comes when an engine is used; cd_engine.core works without the plug-in
