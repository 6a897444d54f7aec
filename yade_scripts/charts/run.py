"""Runs what the charts of speed against accuracy need, then draws them; settings measured before are not run again.

    /usr/bin/python3 yade_scripts/charts/run.py --quick [--only stack] [--jobs 2]
    /usr/bin/python3 yade_scripts/charts/run.py --full

One YADE measures many settings of a scene; one that crashes, or runs out of time, costs its own row: the rest go on in a new one.
Exit status: 0 done (failed settings are results), 1 a YADE or a figure could not be made, 2 wrong arguments.
"""
import argparse
import json
import pathlib
import signal
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1]))

from analysis.load import ResultError
from analysis.publish import processor
from analysis.schema import STATUS_FAILED
from yade_scripts import commits, parameters, results
from yade_scripts.charts import records, settings

LIMIT = {"quick": 2, "full": 8}  # s of processor time that a run may take


class Work:
    """What is left to measure of one scene, and the YADE that does."""

    def __init__(self, scene, wanted, folder, limit):
        self.scene, self.folder, self.limit, self.process, self.trouble = scene, folder, limit, None, None
        self.wanted = {one.name: one for one in wanted}
        self.rows = pathlib.Path(folder) / records.FOLDER / f"{scene}.rows.json"

    def left(self):
        """Settings without a record, in their order."""
        found = records.read(self.scene, self.folder)
        return [one for name, one in self.wanted.items() if not records.done(found.get(name), self.limit)]

    def start(self):
        """A new YADE for what is left; one thread, as several are not repeatable."""
        self.rows.parent.mkdir(parents=True, exist_ok=True)
        self.rows.write_text(json.dumps([dict(one.row) for one in self.left()]))
        self.begun.unlink(missing_ok=True)
        with open(self.log, "a") as log:
            self.process = subprocess.Popen(
                ["yade", "-n", "-x", "-j", "1", str(HERE / "measure.py"), f"--results={self.folder}", f"--limit={self.limit}", f"--rows={self.rows}"],
                stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT)

    @property
    def begun(self):
        """Holds the row that the YADE works at."""
        return self.rows.with_suffix(".begun")

    @property
    def log(self):
        """What the YADEs of this scene have said."""
        return self.rows.with_suffix("").with_suffix(".log")

    def ended(self):
        """After the YADE's end: True if there is more to do, the row that ended it being recorded as failed."""
        if not self.left():
            return False
        if not self.begun.exists():
            self.trouble = f"YADE ended with {self.process.returncode} before its first row; see {self.log}"
            return False
        row = json.loads(self.begun.read_text())
        culprit = next(one for one in self.wanted.values() if dict(one.row) == row)
        if culprit not in self.left():
            self.trouble = f"YADE ended with {self.process.returncode} between two rows; see {self.log}"
            return False
        self._failed(culprit)
        return bool(self.left())

    def _failed(self, culprit):
        code = self.process.returncode
        late = code in (-signal.SIGPROF, -signal.SIGALRM)
        reason = f"took more than {self.limit} s" if late else f"YADE ended by {signal.Signals(-code).name}" if code < 0 else f"YADE ended with {code}"
        self._record(culprit, reason, late)
        if not late or not culprit.costlier:
            return
        for one in self.left():
            if (one.series, one.size) == (culprit.series, culprit.size) and one.rank > culprit.rank:
                self._record(one, f"not tried: a coarser setting took more than {self.limit} s", True)

    def _record(self, setting, reason, late):
        records.add({"name": setting.name, "scene": self.scene, "method": setting.full["method"], "row": dict(setting.row), "parameters": setting.full,
                     "limit": self.limit, "out_of_time": late, "status": STATUS_FAILED + reason, "seconds": [], "git_commit": commits.git_commit(),
                     "processor": processor()}, self.folder)


def work_off(works, at_once):
    """Do all of them, `at_once` YADEs at a time, and say how far it is."""
    waiting, running = [work for work in works if work.left()], []
    total, told = sum(len(work.left()) for work in waiting), time.monotonic()
    try:
        while waiting or running:
            while waiting and len(running) < at_once:
                running.append(waiting.pop(0))
                running[-1].start()
            time.sleep(0.2)
            for work in [work for work in running if work.process.poll() is not None]:
                if work.ended():
                    work.start()
                else:
                    running.remove(work)
            if time.monotonic() - told > 5:
                told = time.monotonic()
                print(f"charts: {total - sum(len(work.left()) for work in waiting + running)} of {total} settings measured | "
                      + ", ".join(work.scene for work in running), flush=True)
    finally:
        for work in running:
            work.process.terminate()


def draw(full, folder, figures):
    """The charts of what was measured; the exit status."""
    command = [sys.executable, "-m", "analysis", "charts", "--results", str(pathlib.Path(folder).resolve())]
    command += ["--full"] * full + (["-o", str(pathlib.Path(figures).resolve())] if figures else [])
    return subprocess.run(command, cwd=HERE.parents[1]).returncode


def _options(arguments):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    extent = parser.add_mutually_exclusive_group(required=True)
    extent.add_argument("--quick", action="store_true", help="every second setting, small sizes")
    extent.add_argument("--full", action="store_true", help="all settings")
    parser.add_argument("--only", action="append", metavar="SCENE", help="this scene (may be repeated)")
    parser.add_argument("--jobs", type=int, default=2, help="YADEs run at once (default %(default)s)")
    parser.add_argument("--results", default=results.FOLDER, help="folder of the results (default %(default)s)")
    parser.add_argument("--figures", help="folder of the charts (default: figures/quick/charts or figures/full/charts)")
    return parser.parse_args(arguments)


def main(arguments=None):
    """Command line."""
    options = _options(arguments)
    unknown = [scene for scene in options.only or () if scene not in settings.charted()]
    if unknown:
        print(f"charts: there is no chart of {', '.join(unknown)}; there are {', '.join(settings.charted())}", file=sys.stderr)
        return 2
    limit = LIMIT["full" if options.full else "quick"]
    scenes = sorted(options.only or settings.charted(), key=lambda scene: -settings.PATIENCE.get(scene, 1))  # the longest first
    works = [Work(scene, settings.everything(scene, options.quick), options.results, limit * settings.PATIENCE.get(scene, 1)) for scene in scenes]
    try:
        results.make(pathlib.Path(options.results) / records.FOLDER)
        work_off(works, max(1, options.jobs))
    except (parameters.ParameterError, ResultError) as error:
        print(f"charts: {error}", file=sys.stderr)
        return 2
    trouble = [f"{work.scene}: {work.trouble}" for work in works if work.trouble]
    for line in trouble:
        print(f"charts: {line}", file=sys.stderr)
    return draw(options.full, options.results, options.figures) or bool(trouble)


if __name__ == "__main__":
    sys.exit(main())
