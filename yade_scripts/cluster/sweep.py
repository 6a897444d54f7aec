"""Runs every row of tables on a Slurm cluster; the result files are those of a local run, and finished rows are skipped.

    /usr/bin/python3 yade_scripts/cluster/sweep.py TABLE.txt [--minutes 60] [--sbatch "--partition=long --mem=500M"]

The rows are submitted as an array job with one core for each task. Slurm puts a task whose node fails back into the queue. When the array has
ended, rows without a result (time limit, memory, a node's disk) are submitted again, with twice the time limit, up to `--retries` times. A row that
ended with a recorded failure is not submitted again, since runs are repeatable; the next call runs it once more, as batch.py does.
Ctrl-C ends only this process, not the tasks; the same command watches them again. Repository and results must be in a folder that all nodes share.
Exit status: 0 all finished, 1 a row failed, 2 the tables cannot be run, 130 ended by Ctrl-C.
"""
import collections
import hashlib
import os
import pathlib
import re
import shlex
import sys
import time

if __name__ == "__main__":
    file = sys._getframe().f_code.co_filename  # YADE sets no __file__
    sys.path.insert(0, str(pathlib.Path(file).resolve().parents[2]))
    from yade_scripts import commands
    commands.script("yade_scripts.cluster.sweep", file)

from yade_scripts import batch, commands, parameters, results, tables
from yade_scripts.cluster import slurm

SECONDS = 10  # between two looks at the queue


def _stamp(path):
    """Return (inode, time of change, size) of a file, which change when it is replaced; None if there is no file."""
    try:
        facts = path.stat()
    except OSError:
        return None
    return facts.st_ino, facts.st_mtime_ns, facts.st_size


# Matches Slurm's own errors in a task's output. They begin with slurmstepd and the node up to Slurm 24, with the time from 26 on.
SLURM_SAYS = re.compile(r"(slurmstepd\S*:|\[[-\dT:.]+\]) error: ")


def _packings_first(jobs):
    """Sort the rows: one of each packing first, then a second one of each, and so on, so that rows that start together share few packings."""
    seen, turn = collections.Counter(), {}
    for job in jobs:
        packing = parameters.digest(parameters.preparation(job.full))
        turn[job] = seen[packing]
        seen[packing] += 1
    return sorted(jobs, key=turn.get)


class Sweep:
    """Submits the rows, watches the queue and collects the results. options: those of the command line. open: rows without a result of this call;
    failed: rows that ended with a recorded failure."""

    def __init__(self, jobs, options):
        self.jobs, self.options, self.failed = jobs, options, []
        self.open = [job for job in jobs if not results.finished(job.path)]
        self.stamps = {job: _stamp(job.path) for job in self.open}  # a failed result of an earlier call does not count: its row is run again
        names = "\n".join(sorted(str(job.path) for job in jobs))
        self.name = "sweep-" + hashlib.sha256(names.encode()).hexdigest()[:12]  # the same name for the same rows in the same folder
        self.folder = pathlib.Path(options.results) / "sweeps" / self.name

    def collect(self):
        """Move the rows that have ended since the last call out of `open`."""
        there = set(os.listdir(self.options.results))
        ended = [job for job in self.open if job.path.name in there and _stamp(job.path) != self.stamps[job]]
        self.failed += [job for job in ended if results.has_failed(results.status(job.path))]
        self.open = [job for job in self.open if job not in ended]

    def run(self):
        """Submit and watch until every row has a result or has been submitted as often as allowed."""
        if earlier := bool(slurm.states(self.name)):
            print(f"{self.name}: an earlier call's tasks are in the queue: watching them.", flush=True)
            self.watch()
        for attempt in range(1 + self.options.retries):
            if not self.open:
                return
            if attempt or earlier:
                self._explain()
            self.submit(attempt)
            self.watch()

    def submit(self, attempt):
        """Submit one array job for all open rows. If there are more rows than tasks, each task gets several."""
        self.folder.mkdir(parents=True, exist_ok=True)
        for old in self.folder.glob("task-*.out"):
            old.unlink()
        todo = _packings_first(self.open)
        plan = self.folder / f"rows-{attempt}.txt"
        plan.write_text(tables.text([job.row for job in todo]), encoding="utf-8")
        tasks = min(len(todo), slurm.largest_array())
        minutes = self.options.minutes and self.options.minutes * 2**attempt
        words = sys.executable, batch.__file__, plan, "--results", self.options.results, "--jobs", 1, "--share"
        command = f"exec {shlex.join(map(str, words))} $SLURM_ARRAY_TASK_ID/{tasks}"
        output = self.folder / "task-%A_%a.out"
        number = slurm.submit(self.name, command, tasks, output, minutes, self.options.at_once, shlex.split(self.options.sbatch))
        limit = f" of at most {minutes} min" if minutes else ""
        print(f"{self.name}: job {number}, attempt {attempt + 1}: {len(todo)} rows in {tasks} tasks{limit}", flush=True)

    def watch(self):
        """Report progress until no task is left in the queue. If the controller does not answer, ask again: the tasks run without it."""
        told = None
        while True:
            try:
                states = slurm.states(self.name)
                waits = slurm.reasons(self.name) if states["PENDING"] else []
            except slurm.SlurmError as error:
                states, waits = None, [str(error)]
            self.collect()
            news = f"{len(self.jobs) - len(self.open)} of {len(self.jobs)} rows ended, {len(self.failed)} of them failed"
            news += "".join(f" | {text}" for text in [*(f"{count} {state.lower()}" for state, count in sorted((states or {}).items())), *waits])
            if news != told:
                print(f"{self.name}: {news}", flush=True)
            told = news
            if states is not None and not states:
                return
            time.sleep(self.options.seconds)

    def _explain(self):
        """Print Slurm's error messages about the tasks that left rows without a result."""
        said = [line[found.end():] for path in sorted(self.folder.glob("task-*.out"))
                for line in path.read_text(errors="replace").splitlines() if (found := SLURM_SAYS.match(line))]
        print(f"{self.name}: {len(self.open)} rows have no result" + "".join(f"\n  {line}" for line in said[:10]), flush=True)


@commands.command("sweep")
def main(arguments=None):
    parser = commands.parser(__doc__, "tables", "--results")
    parser.add_argument("--minutes", type=commands.whole(1), help="time limit of a task (default: the partition's)")
    parser.add_argument("--retries", type=commands.whole(0), default=2,
                        help="how often rows without a result are submitted again (default: %(default)s)")
    parser.add_argument("--at-once", type=commands.whole(1), metavar="N", help="largest number of tasks at the same time")
    parser.add_argument("--sbatch", default="", metavar="OPTIONS", help="further options for sbatch, as one quoted argument")
    parser.add_argument("--seconds", type=commands.positive, default=SECONDS, help="between two looks at the queue (default: %(default)s)")
    options = parser.parse_args(arguments)
    options.results = str(pathlib.Path(options.results).resolve())
    jobs = batch.jobs_of([row for path in options.tables for row in tables.read(path).values()], options.results)
    if not slurm.present():
        print("sweep: there is no Slurm here (no command sbatch). Call it where jobs are submitted from, or run the table on this machine: "
              "yade_scripts/batch.py", file=sys.stderr)
        return 2
    sweep = Sweep(jobs, options)
    print(f"{', '.join(options.tables)}: {batch.counted(jobs, set(jobs) - set(sweep.open))}", flush=True)
    try:
        sweep.run()
    except slurm.SlurmError as error:
        print(f"sweep: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print(f"\nThe tasks go on. The same command watches them again; scancel --name={sweep.name} ends them.", file=sys.stderr)
        return 130
    for job in sweep.failed + sweep.open:
        print(f"sweep: {job.path}: {job.outcome() if job.log.exists() else 'never started'}", file=sys.stderr)
    return 1 if sweep.failed or sweep.open else 0
