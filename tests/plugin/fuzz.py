"""Random scenes under random changes, with every step checked:  /usr/bin/python3 -m tests.plugin.fuzz 7 20-39

runs the scenes of these seeds, each in a process of its own, and reports for each what was checked and how it ended. `--here` runs them in this
process, for a debugger. The last line counts the scenes that broke a law. The seed alone determines a scene and what is done to it.
"""
import argparse
import glob
import importlib
import multiprocessing
import os
import pathlib
import random
import re
import sys
import tempfile
import traceback

from cd_engine import failing
from tests import waking

ROOT = pathlib.Path(__file__).resolve().parents[2]
PHASES = 7
SECONDS = 120  # limit for a scene, which takes about one: longer means that it hangs


class Run:
    """A running scene: the changes made, its engines, and the Watch that checks it."""

    def __init__(self, seed, folder):
        from . import fuzz_laws, fuzz_scene
        self.r = random.Random(seed)
        self.folder = pathlib.Path(folder)
        self.watch = fuzz_laws.Watch()
        self.changes, self.planned, self.stop_at, self.failed = [], {}, None, None
        self.scene = fuzz_scene.build(self.r)
        self.set_engines()

    def set_engines(self):
        """Set Contact Dynamics with its Watch, and other engines in any order that is allowed."""
        import cd_engine
        import yade
        from yade_scripts.running import hooks
        reset, collider, cd = cd_engine.engines(**self.scene.settings)
        first = [reset, collider] if self.r.random() < 0.7 else [collider, reset]
        if self.r.random() < 0.2:
            first.insert(1, hooks.runner(lambda: None, iterPeriod=3))
        push = []
        if self.r.random() < 0.2 and len(yade.O.bodies):
            free = [b for b in yade.O.bodies if b.state.blockedDOFs == "zXY"]
            if free:
                pushed = self.r.choice(free)
                push = [yade.wrapper.ForceEngine(ids=[pushed.id], force=(3 * pushed.state.mass, 0, 0))]
        yade.O.engines = [hooks.runner(self.begin, iterPeriod=1, initRun=True), *first, *push,
                          hooks.runner(lambda: self.watch.before(), iterPeriod=1, initRun=True), cd,
                          hooks.runner(self.after, iterPeriod=1, initRun=True)]

    def begin(self):
        import yade
        for change in self.planned.pop(yade.O.iter, ()):
            change(self)

    def after(self):
        import yade
        self.watch.after()
        if self.stop_at is not None and yade.O.iter >= self.stop_at:
            self.stop_at = None
            failing.stop()

    def after_load(self):
        """Restore what YADE does not save: permanent forces."""
        import yade
        for k, force in self.scene.permanent.items():
            if yade.O.bodies[k]:
                yade.O.forces.setPermF(k, force)

    def steps(self, count):
        from yade_scripts.running import hooks
        if count:
            hooks.simulate(count)

    def step(self):
        import yade
        yade.O.step()
        if self.watch.wrong:
            raise self.watch.wrong

    def refused(self):
        """Try the next step. Return the message with which it is refused, None if it is made."""
        import yade
        self.watch.before = self.watch.after = lambda: None
        try:
            yade.O.step()
        except RuntimeError as error:
            return str(error)
        finally:
            del self.watch.after, self.watch.before
            for runner in (e for e in yade.O.engines if type(e).__name__ == "PyRunner"):
                runner.iterLast = -1  # the step is made again, under the same number
        return None

    def go(self):
        """Run all phases, each a change and some steps. Return the message that ended the run if the engine refused a change that it may refuse."""
        from . import fuzz_changes, fuzz_twins
        import yade
        self.steps(self.r.randrange(1, 60))
        for _ in range(PHASES):
            may_refuse = None
            if self.r.random() < 0.4:
                change, when = self.r.choice(fuzz_changes.WITHIN), self.r.randrange(0, 12)
                self.planned.setdefault(yade.O.iter + when, []).append(change)
                self.changes.append(f"{change.__name__} at {yade.O.iter + when}")
            else:
                change = self.r.choice(fuzz_changes.BETWEEN)
                self.changes.append(f"{change.__name__} before {yade.O.iter}")
                may_refuse = change(self)
            try:
                self.steps(self.r.choice((2, 15, 50)))
            except RuntimeError as error:
                if may_refuse and re.search(may_refuse, str(error)):
                    return str(error)
                raise
            self.planned.clear()
        self.twins = fuzz_twins.compare(self)
        return None


def scene(seed):
    """Run one scene from its seed. Return (whether all laws held, report)."""
    run = None
    with tempfile.TemporaryDirectory() as folder:
        try:
            run = Run(seed, folder)
            end = run.go()
        except BaseException as error:
            from .fuzz_laws import Broken
            what = str(error) if isinstance(error, (Broken, RuntimeError)) else "".join(traceback.format_exception(error))
            return False, f"{what}\n    changes: {', '.join(run.changes) if run else 'none'}"
    w = run.watch
    worst = ", ".join(f"{name} {share:.2g}" for name, share in sorted(w.worst.items(), key=lambda x: -x[1])[:3])
    refused = f"; refused: {end}" if end else ""
    return True, f"{w.steps} steps, {w.unsolved} unsolved, {w.loaded} loaded contacts, {w.exact} exact; nearest to its bound: {worst}{refused}"


def apart(seed):
    """Run the same in a child process, which may crash or hang."""
    fork = multiprocessing.get_context("fork")
    here, there = fork.Pipe(duplex=False)
    child = fork.Process(target=lambda: there.send(scene(seed)))
    child.start()
    there.close()
    try:
        return here.recv() if here.poll(SECONDS) else (False, f"hangs: not done in {SECONDS} s")
    except EOFError:
        return False, "the process ended without a word"
    finally:
        child.kill()
        child.join()


def seeds(text):
    """Return the seeds that `7` or `20-39` stands for."""
    first, _, last = text.partition("-")
    return range(int(first), int(last or first) + 1)


def main():
    sys.path[:0] = [str(ROOT), *glob.glob("/usr/lib/*/yade-double/py")]
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("seeds", nargs="+", type=seeds, help="a number, or first-last")
    parser.add_argument("--here", action="store_true", help="in this process")
    asked = parser.parse_args()
    # Before children are made: it takes longer than a scene.
    for module in ("yade", "cd_engine", "tests.plugin.fuzz_changes", "tests.plugin.fuzz_twins"):
        importlib.import_module(module)
    sys.modules["cd_engine"].methods()
    waking.often(type(sys.modules["yade"].O))
    wanted, broken = [seed for some in asked.seeds for seed in some], []
    for seed in wanted:
        held, said = scene(seed) if asked.here else apart(seed)
        print(f"seed {seed}: {'held' if held else 'BROKEN'}: {said}", flush=True)
        if not held:
            broken.append(seed)
    print(f"{len(wanted)} scenes, {len(broken)} broken: {broken}", flush=True)
    os._exit(bool(broken))


if __name__ == "__main__":
    main()
