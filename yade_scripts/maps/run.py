"""Runs the stability maps, each in a YADE of its own, some at a time, then draws them; cases that have been probed are not probed again.

    /usr/bin/python3 yade_scripts/maps/run.py [--quick | --full] [--only NAME ...] [--jobs 2] [--results FOLDER] [--figures FOLDER]

A case that crashes its process, or takes longer than CASE_SECONDS, is entered as such, and the map goes on with the next.
Exit status: 0 all maps complete, 1 one of them is not, 2 they cannot be run or drawn.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1]))

from analysis import load
from analysis.charts import maps_cd, maps_md, maps_walls
from yade_scripts import commits, results
from yade_scripts.maps import NOT_SOLVED, ORDER, Outcome, store

CASE_SECONDS = 180
MOST_FAILURES = 20  # of one map; more are no matter of single cases


class Worker:
    """One map's process, started again after a case that ended it."""

    def __init__(self, name, full, folder):
        self.name, self.full, self.folder = name, full, folder
        self.store = store.Store(name, folder)
        self.underway, self.log = (self.store.path.with_suffix(suffix) for suffix in (".underway", ".log"))
        self.failures, self.why = 0, ""
        self.log.parent.mkdir(parents=True, exist_ok=True)
        self.log.write_text("")
        self._start()

    def _start(self):
        self.underway.unlink(missing_ok=True)
        with open(self.log, "a") as log:
            self.process = subprocess.Popen(["yade", "-n", "-x", "-j", "1", str(HERE / "worker.py"), self.name, *["--full"] * self.full,
                                             f"--results={self.folder}"], stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT,
                                            env=os.environ | {"OMP_NUM_THREADS": "1"})  # eigenvalues on many threads are slower

    def ended(self):
        """Whether the map is complete, or given up (then `why` says the reason)."""
        if self.process.poll() is None:
            if self._hangs():
                self.process.kill()
                self.process.wait()
                self._enter("timed out", f"killed after {CASE_SECONDS} s")
            return False
        if self.process.returncode == 0 or self.why:
            return True
        if self.underway.exists() and self.process.returncode != 1:  # 1: an exception, a mistake of the probe
            self._enter("crashed", f"exit status {self.process.returncode}")
            return False
        self.why = f"exit status {self.process.returncode}; the end of {self.log}:\n" + "\n".join(self.log.read_text(errors="replace").splitlines()[-6:])
        return True

    def _hangs(self):
        try:
            return time.time() - self.underway.stat().st_mtime > CASE_SECONDS
        except FileNotFoundError:
            return False

    def _enter(self, reason, words):
        """Give the case under way its outcome, and go on."""
        self.failures += 1
        kept = store.Store(self.name, self.folder)
        kept.add(json.loads(self.underway.read_text()), Outcome(NOT_SOLVED, reason, words), commit=commits.git_commit(), yade="", seconds=0)
        if self.failures > MOST_FAILURES:
            self.why = f"more than {MOST_FAILURES} cases crashed or hung"
        else:
            self._start()


def run(names, full, folder, jobs):
    """Run the maps; {name: why} of those that are not complete."""
    waiting, running, incomplete, began = list(names), [], {}, time.monotonic()
    try:
        while waiting or running:
            while waiting and len(running) < jobs:
                running.append(Worker(waiting.pop(0), full, folder))
            time.sleep(0.3)
            for worker in [worker for worker in running if worker.ended()]:
                running.remove(worker)
                if worker.why:
                    incomplete[worker.name] = worker.why
                rows = len(store.Store(worker.name, folder).rows)
                print(f"map {worker.name}: {rows} cases, {time.monotonic() - began:.0f} s since the start", flush=True)
    finally:
        for worker in running:
            worker.process.terminate()
    return incomplete


def draw(folder, figures, full):
    """Draw the groups of maps that have rows; the figures' paths."""
    for group in (maps_md, maps_cd, maps_walls):
        try:
            group.publish(folder, figures, full)
        except load.ResultError as error:
            print(f"maps: {error}", file=sys.stderr)
    return [str(path) for path in sorted(pathlib.Path(figures).glob("map_*.png"))]


def main(arguments=None):
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    extent = parser.add_mutually_exclusive_group()
    extent.add_argument("--quick", action="store_true", help="coarse grids and searches (the default)")
    extent.add_argument("--full", action="store_true", help="the fine ones")
    parser.add_argument("--only", nargs="+", metavar="NAME", choices=ORDER, default=ORDER, help=f"of {', '.join(ORDER)}")
    parser.add_argument("--jobs", type=int, default=2, help="how many at a time (default: %(default)s)")
    parser.add_argument("--results", metavar="FOLDER", default=results.FOLDER, help="folder of the results; rows are in maps/ below (default: %(default)s)")
    parser.add_argument("--figures", metavar="FOLDER", help="where to draw (default: figures/quick/charts or figures/full/charts)")
    options = parser.parse_args(arguments)
    try:
        incomplete = run(options.only, options.full, pathlib.Path(options.results) / "maps", max(1, options.jobs))
        print("\n".join(draw(options.results, options.figures or HERE.parents[1] / "figures" / ("full" if options.full else "quick") / "charts", options.full)))
    except (store.StoreError, load.ResultError, OSError) as error:
        print(f"maps: {error}", file=sys.stderr)
        return 2
    for name, why in incomplete.items():
        print(f"maps: {name} is incomplete: {why}", file=sys.stderr)
    return 1 if incomplete else 0


if __name__ == "__main__":
    sys.exit(main())
