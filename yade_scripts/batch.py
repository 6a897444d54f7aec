"""Runs every row of tables, several at a time, each in a YADE process of its own; finished rows are skipped.

    /usr/bin/python3 yade_scripts/batch.py TABLE.txt [--jobs 2] [--hours 3] [--share INDEX/TASKS]

A row counts as finished if its result file says so. Rows that need the same packing prepare it once. Two calls at the same time
share the rows. When a call ends, even by kill -9, its runs end with it; the same command then runs the rows that have not finished.
Exit status: 0 all finished, 1 a row failed, 2 the tables cannot be run, 128 + n ended by signal n.
"""
import argparse
import errno
import math
import os
import pathlib
import shutil
import sys

if __name__ == "__main__":
    file = sys._getframe().f_code.co_filename  # YADE sets no __file__
    sys.path.insert(0, str(pathlib.Path(file).resolve().parents[1]))
    from yade_scripts import commands
    commands.script("yade_scripts.batch", file)

from yade_scripts import commands, parameters, results, tables
from yade_scripts.results import provenance
from yade_scripts.running import locks, plausible, queue

LEAST_SPACE = 10**7  # bytes; on a disk with less, runs cannot write their files


class Row(queue.Job):

    def __init__(self, row, folder):
        self.row, self.full = row, parameters.complete(row)
        self.path = results.path_of(self.full, folder)
        super().__init__("run.py", [f"--results={folder}"] + [f"{name}={value}" for name, value in row.items()], self.path.with_suffix(".log"))

    def start(self, mode="w"):
        """Start the run. If another process runs the row now, its log is kept and this run appends to it."""
        super().start("a" if self.elsewhere() else mode)

    def elsewhere(self):
        """Tell whether another process runs this row."""
        return locks.taken(self.path)

    def news(self):
        """Return the last line of progress in the log."""
        lines = [line for line in self.log.read_text(encoding="utf-8", errors="replace").splitlines() if line.startswith(self.path.stem)]
        return lines[-1] if lines else f"{self.path.stem}: preparing"

    def outcome(self):
        """Return how the run ended according to its result file; without a result file, a message with the end of the log."""
        return results.in_words(self.path) or f"failed: it left no result file; the end of its log:\n{self.said()}"


def jobs_of(rows, folder):
    """Return one job for each different row. Print a warning for each setting that is probably not meant."""
    jobs = {job.path: job for job in (Row(row, folder) for row in rows)}
    doubts = [f"{path.stem}: {doubt}" for path, job in jobs.items() for doubt in plausible.doubts(job.full)]
    for doubt in doubts + plausible.unread([job.full for job in jobs.values()]):
        print(f"batch: {doubt}.", file=sys.stderr)
    results.make(folder)
    return list(jobs.values())


def counted(jobs, finished):
    """Return how many runs there are and how many of them are already finished, in words."""
    return f"{len(jobs)} run{'s' * (len(jobs) != 1)}, {len(finished)} already finished"


def work_off(jobs, at_once, ended=lambda path: None, hours=math.inf):
    """Run the jobs that have not finished; return the paths of those that still have not. Call ended(path) for each result file that will not change
    any more. hours: a run that takes longer is ended; the next call continues it from its last checkpoint if it has one. Raise OSError when the
    disk is full."""
    endings = {job: results.ending(job.path) for job in jobs}
    finished = {job: commit for job, (status, commit) in endings.items() if status == results.STATUS_FINISHED}
    print(counted(jobs, finished), flush=True)
    if doubt := provenance.doubt(finished.values()):
        print(f"batch: some results {doubt}", file=sys.stderr)
    for job in finished:
        ended(job.path)
    failed = []

    def note(job):
        if not results.finished(job.path):
            failed.append(job.path)
            if not job.late and results.status(job.path) is None and shutil.disk_usage(job.path.parent).free < LEAST_SPACE:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(job.path.parent))
        elif job.log.exists():  # what a row sets in vain would look like a result of its own
            for line in job.log.read_text(encoding="utf-8", errors="replace").splitlines():
                if line.startswith("run: ") and plausible.IN_VAIN in line:
                    print(f"batch: {job.path.stem}: {line.removeprefix('run: ')}", file=sys.stderr)
        if not job.late:
            ended(job.path)

    queue.run([job for job in jobs if job not in finished], at_once, note, hours)
    for path in failed:
        late = any(job.late for job in jobs if job.path == path)
        goes_on = "continues it from its last checkpoint" if results.checkpoint_of(path).exists() else "begins it again: it has no checkpoint"
        print(f"batch: {path}: " + (f"not finished within {hours:g} hours: the same command {goes_on}" if late else
                                    results.status(path) or "failed: see its log"), file=sys.stderr)
    return failed


def share(text):
    """Convert INDEX/TASKS, a task's share of the rows, to a slice."""
    index, tasks = (commands.whole(least)(part) for least, part in enumerate(text.partition("/")[::2]))
    if index >= tasks:
        raise argparse.ArgumentTypeError(f"{text!r}: INDEX must be below TASKS")
    return slice(index, None, tasks)


@commands.command("batch")
def main(arguments=None):
    parser = commands.parser(__doc__, "tables", "--jobs", "--hours", "--results")
    parser.add_argument("--share", type=share, default="0/1", metavar="INDEX/TASKS",
                        help="run every TASKS-th row only, beginning with row INDEX, counted from 0: the task of a cluster")
    options = parser.parse_args(arguments)
    jobs = jobs_of([row for path in options.tables for row in tables.read(path).values()][options.share], options.results)
    try:
        return 1 if work_off(jobs, options.jobs, hours=options.hours) else 0
    except OSError as error:
        print(f"batch: {error}: finished runs are kept; {commands.cure(error)} and give the same command again.", file=sys.stderr)
        return 1


def begin():
    queue.end_by_signals("batch")
