"""Extends O.run, O.step, O.wait, O.pause and O.engines: they check the list of engines and tell the plug-in when the scene may be read.

O.pause() returns when the last step has ended (where the run's own stop is not a few steps away). O.load, O.reset and their like call it first.
"""
import inspect
import time

from . import engine_methods, failing, watching

# They take the scene away. YADE itself would crash if the thread of the run has not begun yet, and wait for ever if an engine of the run calls them.
REPLACING = ("load", "loadTmp", "reload", "reset", "resetAllScenes", "resetCurrentScene", "resetThisScene", "stringToScene")


def install(plugin, own):
    """Replace these methods of YADE's O. plugin: the compiled module. own: names of its engines.

    O.run(n, True) and O.wait() tell the plug-in that the caller does not read the scene before they return; O.pause() tells it that the caller may.
    In between ContactDynamics writes to the scene only what other engines read, and everything at the end.
    """
    from yade import O
    originals = {name: getattr(type(O), name) for name in ("run", "step", "wait", "pause", *REPLACING)}
    checks = {}  # by the number of the scene

    def of_this_scene():
        return checks.setdefault(O.thisScene, _EngineCheck(O, plugin, own))

    def check():
        of_this_scene()()

    def run(self, nSteps=-1, wait=False):
        check()
        if not engine_methods.in_a_run():
            failing.begin()
        plugin.run_begins()
        if not wait:
            return originals["run"](self, nSteps)
        waited(originals["run"], self, nSteps, True)

    def step(self):
        check()
        failing.begin()
        plugin.take_error()
        try:
            with failing.awaited():
                originals["step"](self)
        finally:
            plugin.settle()
            plugin.take_error()  # YADE itself raises it

    def wait(self):
        waited(originals["wait"], self)

    def waited(original, self, *arguments):
        if engine_methods.in_a_run():
            raise RuntimeError(f"O.{original.__name__}: an engine of a run (PyRunner) cannot wait for its own run. Call O.run(n) there without "
                               "waiting, which ends this run after n more steps, or leave it to the script")
        plugin.wait_begins()
        try:
            with failing.awaited():
                original(self, *arguments)
        finally:
            plugin.wait_ends()
            error = plugin.take_error()
        if error:  # the run had ended before YADE began to wait, which then raises nothing
            raise RuntimeError(error)

    def pause(self):
        plugin.pause_begins()
        former, lead, moved = self.stopAtIter, 1, False
        try:
            # YADE's own O.pause() returns while the last step still changes the scene. A run that stops by itself has ended its step.
            while engine_methods.runs_besides():
                stop = self.iter + lead
                if self.iter <= former <= stop + lead:  # its own stop is as near
                    if moved:
                        break
                else:
                    self.stopAtIter, moved = stop, True
                    if self.iter >= stop:  # passed before it was set
                        lead *= 2
                        continue
                time.sleep(1e-3)
        finally:
            originals["pause"](self)
            if moved:
                self.stopAtIter = former if former > self.iter else -1
        plugin.settle()

    def replacing(name):
        def replace(self, *arguments, **keywords):
            if engine_methods.in_a_run():
                raise RuntimeError(f"O.{name}: an engine of a run (PyRunner) cannot replace the scene of its own run. Call O.pause() there, and "
                                   f"O.{name} in the script after the run")
            if self.running:
                pause(self)
            originals[name](self, *arguments, **keywords)
            watching.forget()
            failing.begin()
            if name == "resetAllScenes":
                checks.clear()
            checks.pop(self.thisScene, None)  # the scene is another one, of which nothing has run
        return replace

    engines = type(O).engines

    def set_engines(self, new):
        if inspect.isfunction(new):
            raise TypeError(f"O.engines: {new.__name__} is a function; call it: {new.__name__}()")
        new = list(new)
        if any(isinstance(engine, (list, tuple)) for engine in new):
            raise TypeError("O.engines: there is a list in the list; join lists of engines by +")
        if (self.running or engine_methods.in_a_run()) and of_this_scene().replaces_rigid(new):
            raise RuntimeError("O.engines: springs cannot take over from ContactDynamics within a run, since its contacts have no stiffness. Call "
                               "O.pause() there; then call cd_engine.release() and set the engines in the script")
        engines.fset(self, new)

    type(O).engines = property(engines.fget, set_engines, doc=engines.__doc__)
    for name, told in dict(run=run, step=step, wait=wait, pause=pause, **{name: replacing(name) for name in REPLACING}).items():
        told.__name__, told.__doc__ = name, originals[name].__doc__
        setattr(type(O), name, told)


class _EngineCheck:
    """Refuses lists of engines with which YADE would crash, would ask for a NewtonIntegrator, or would use springs without stiffness.

    When springs and ContactDynamics take over from each other, colliders begin anew, and overlaps left by the springs count as touching again.
    """

    def __init__(self, O, plugin, own):
        self.O, self.plugin, self.own = O, plugin, own
        self.passed = []  # the engines of springs that ran last; none if ContactDynamics ran last
        self.rigid = False  # whether ContactDynamics ran last
        self.takers = []  # engines of ContactDynamics that have taken overlaps over; those of a loaded scene tell by handoverOverlap

    def __call__(self):
        live = [engine for engine in self.O.engines if not engine.dead]
        names = [type(engine).__name__ for engine in live]
        for slave in engine_methods.slaves(live):
            inside = "cd_engine.watch()" if getattr(slave, "command", "").startswith(watching.COMMAND) else type(slave).__name__
            if inside == "cd_engine.watch()" or inside in self.own:
                raise RuntimeError(f"{inside} stands in a ParallelEngine; there any error that it raises ends YADE. Put it into O.engines itself")
        if "ContactDynamics" in names:
            if self.O.periodic:  # YADE's collider would end the program if there are boundaries
                raise RuntimeError("ContactDynamics: the scene is periodic, which is not supported. Set O.periodic=False and use walls")
            engine = live[names.index("ContactDynamics")]
            if not self.O.running and self.O.subStep < 0:  # in mid-step, as after an error, a new list has not replaced the old one yet
                self.plugin.check_engines(engine)
            # YADE's collider is content with an integrator that is dead.
            integrator = any(type(engine).__name__ == "NewtonIntegrator" for engine in self.O.engines)
            if not integrator and any(getattr(engine, "verletDist", 0) != 0 for engine in live):
                raise RuntimeError("ContactDynamics needs no NewtonIntegrator, but the collider asks for one: give it verletDist=0, or take the list "
                                   "of cd_engine.engines()")
            if engine.handover and engine not in self.takers:
                self.takers.append(engine)
            elif self.passed and (engine in self.takers or engine.handoverOverlap > 0):
                engine.handover = True
            self.passed, self.rigid = [], True
        elif "InteractionLoop" in names and live != self.passed:
            self._check_stiffness()
            for engine in live:
                if self.rigid and hasattr(engine, "doSort"):
                    engine.doSort = True  # or a collider that springs had before would not find what came together since
            self.passed, self.rigid = live, False

    def replaces_rigid(self, engines):
        """Return whether these engines make springs go on where ContactDynamics ran last."""
        names = [type(engine).__name__ for engine in engines if not engine.dead]
        return self.rigid and "InteractionLoop" in names and "ContactDynamics" not in names

    def _check_stiffness(self):
        """RuntimeError if springs find contacts of ContactDynamics. A material with young = 0 gives contacts that look the same."""
        def is_left(contact):
            return type(contact.phys).__name__ == "FrictPhys" and contact.phys.kn == 0 \
                and all(getattr(getattr(self.O.bodies[i], "material", None), "young", 1) > 0 for i in (contact.id1, contact.id2))

        if any(map(is_left, self.O.interactions)):
            raise RuntimeError("The contacts that ContactDynamics has left have no stiffness, so springs would carry no force there. Call "
                               "cd_engine.release() before you set the engines of the springs")
