"""Runs a scene without recording it, and times its steps alone."""
import time

from yade import O

from cd_engine import failing, watching
from yade_scripts import scenes
from yade_scripts.running import hooks, md, walls

RECORDING = frozenset((hooks.SAMPLING, hooks.SUMMING))


def measures():
    """Tell whether the scene in O measures something in the course of its steps."""
    return any(engine.label == hooks.MEASURING for engine in O.engines)


def run(scene, full, *also, without=RECORDING):
    """Run the scene in O. Return the processor time [s] from the start of its first step to the end of its last.

    also: further engines, put first. without: labels of runners to leave out. A loaded sample ends when it collapses, as in a recorded run. Raise
    Unstable if the scene is not physical at its end.
    """
    steps, moments = scene.every * scene.samples + (full["method"] == "MD"), []

    def clock():
        moments.append(time.thread_time())  # of the thread that makes the steps: what other programs do meanwhile does not count

    if full["method"] == "MD":
        md.law().traceEnergy = False
    if scene.load is not None:
        sides = walls.sides()

        def look():
            if abs(walls.gamma(sides)) > full["collapse_strain"]:
                clock()
                failing.stop()

        also += (hooks.runner(look, iterPeriod=scene.every, label=hooks.TIMING),)
    simulation = [engine for engine in O.engines if engine.label not in without]
    O.engines = [hooks.runner(clock, nDo=1, initRun=True, iterPeriod=1, label=hooks.TIMING), *also, *simulation,
                 hooks.runner(clock, iterPeriod=max(1, steps - 1), initRun=steps == 1, label=hooks.TIMING)]
    watch = watching.Watch(hooks.OBSERVERS)
    watch.check()
    scenes.method(full).run(scene)
    watch.check()
    if len(moments) < 2:
        raise RuntimeError(f"the run ended after {O.iter} of {steps} steps, so its time is unknown")
    return moments[-1] - moments[0]
