"""Runs every row of a table, several at a time, each in its own YADE; finished rows are skipped.

    /usr/bin/python3 yade_scripts/study.py yade_scripts/tables/fig4.txt [--jobs 2]

A row counts as done by its result file alone, never by an exit code. Rows that need the same packing prepare it once: the first
holds a lock, the others wait. Exit status: 0 all finished, 1 a row failed, 2 the table cannot be run.
"""
import argparse
import pathlib
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

from yade_scripts import commits, parameters, results, tables

SECONDS = 5  # between two lines of progress


class Job:
    """One row: its full parameters, result file, log, and process once started."""

    def __init__(self, row, folder):
        self.full = parameters.complete(row)
        self.path = results.path_of(self.full, folder)
        self.log = self.path.with_suffix(".log")
        self.arguments = [f"--results={folder}"] + [f"{name}={value}" for name, value in row.items()]
        self.process = None

    def start(self):
        """Run the row in a YADE of its own, one thread: several threads are not repeatable."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with open(self.log, "w") as log:
            self.process = subprocess.Popen(["yade", "-n", "-x", "-j", "1", str(HERE / "run.py"), *self.arguments],
                                            stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT)

    def news(self):
        """The last line of progress in the log."""
        lines = [line for line in self.log.read_text(errors="replace").splitlines() if line.startswith(self.path.stem)]
        return lines[-1] if lines else f"{self.path.stem}: preparing"

    def outcome(self):
        """How it ended, from the result file; without one, the end of the log."""
        said = results.status(self.path)
        return said or "failed: no result file; the end of its log:\n" + "\n".join(self.log.read_text(errors="replace").splitlines()[-8:])


def run_all(jobs, at_once):
    """Run the jobs, `at_once` at a time; the paths of those that did not finish."""
    waiting, running, failed, told = list(jobs), [], [], time.monotonic()
    try:
        while waiting or running:
            while waiting and len(running) < at_once:
                running.append(waiting.pop(0))
                running[-1].start()
            time.sleep(0.2)
            for job in [job for job in running if job.process.poll() is not None]:
                running.remove(job)
                print(f"{job.path}: {job.outcome()}", flush=True)
                if not results.finished(job.path):
                    failed.append(job.path)
            if running and time.monotonic() - told >= SECONDS:
                told = time.monotonic()
                print(f"{len(waiting)} waiting | " + " | ".join(job.news() for job in running), flush=True)
    finally:
        for job in running:
            job.process.terminate()
    return failed


def _warn_of_other_code(jobs):
    """Name the results that were made by another commit, or by one with changes: they are kept, and may not be what the code now gives."""
    now = commits.git_commit()
    for job in jobs:
        made = results.commit(job.path)
        if made != now or made.endswith("-dirty"):
            print(f"study: {job.path} was made by commit {made[:12]}{made[40:]}, the code is at {now[:12]}{now[40:]}; delete the file to run it again.", file=sys.stderr)


def main(arguments=None):
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("table", help="a table in yade-batch's format")
    parser.add_argument("--jobs", type=int, default=2, help="rows run at once (default %(default)s)")
    parser.add_argument("--results", default=results.FOLDER, help="folder of the result files (default %(default)s)")
    options = parser.parse_args(arguments)
    try:
        jobs = [Job(row, options.results) for row in tables.read(options.table).values()]
    except (parameters.ParameterError, tables.TableError) as error:
        print(f"study: {error}", file=sys.stderr)
        return 2
    open_jobs = [job for job in jobs if not results.finished(job.path)]
    _warn_of_other_code(job for job in jobs if results.finished(job.path))
    print(f"{options.table}: {len(jobs)} runs, {len(jobs) - len(open_jobs)} of them finished before", flush=True)
    failed = run_all(open_jobs, max(1, options.jobs))
    for path in failed:
        print(f"study: {path} failed: {results.status(path) or 'see its log'}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
