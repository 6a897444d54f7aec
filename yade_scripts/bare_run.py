"""Runs a scene without recording it, and times its steps alone."""
import time

from yade import O

from yade_scripts import hooks, scenes


def run(scene, full, *also):
    """Run a scene that stands in O; the time [s] from the start of its first step to the end of its last. also: further engines, in front."""
    steps, moments = scene.every * scene.samples + (full["method"] == "MD"), []

    def clock(**when):
        return hooks.runner(lambda: moments.append(time.perf_counter()), **when)

    if scene.law is not None:
        scene.law.traceEnergy = False
    simulation = [engine for engine in O.engines if engine.label not in (hooks.SAMPLING, hooks.WATCHING)]
    O.engines = [clock(nDo=1, initRun=True, iterPeriod=1), *also, *simulation, clock(iterPeriod=max(1, steps - 1), initRun=steps == 1)]
    scenes.method(full).run(scene)
    return moments[-1] - moments[0]


def contact_dynamics():
    """The engine of CD in O."""
    return next(engine for engine in O.engines if type(engine).__name__ == "ContactDynamics")
