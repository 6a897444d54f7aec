"""Runs every row of tables, several at a time, each in its own YADE; finished rows are skipped.

    /usr/bin/python3 yade_scripts/study.py yade_scripts/tables/fig4.txt [--jobs 2]
    /usr/bin/python3 yade_scripts/study.py --quick        every study's quick table, each figure drawn as soon as its rows are there
    /usr/bin/python3 yade_scripts/study.py --full         the same with the full tables; stop and start it again at will

A row counts as done by its result file alone, never by an exit code. Rows that need the same packing prepare it once: the first
holds a lock, the others wait. Two studies at once share the rows: each leaves to the other what that has begun. However a study ends, kill -9
included, its runs end with it; started again it goes on with those that have not finished, long ones from their last checkpoint.
Exit status: 0 all finished, 1 a row or a figure failed, 2 the tables cannot be run, 128 + n ended by signal n.
"""
import argparse
import os
import pathlib
import signal
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

from analysis.schema import STATUS_FINISHED
from yade_scripts import commits, locks, parameters, plausible, results, tables

SECONDS = 5  # between two lines of progress
# The kernel ends a child of this process with it, whatever ended it. A run may be killed at any moment.
WITH_ME = ["setpriv", "--pdeathsig", "KILL"]


class Job:
    """One row: its full parameters, result file, log, and process once started."""

    def __init__(self, row, folder):
        self.row = row
        self.full = parameters.complete(row)
        self.path = results.path_of(self.full, folder)
        self.log = self.path.with_suffix(".log")
        self.arguments = [f"--results={folder}"] + [f"{name}={value}" for name, value in row.items()]
        self.process = None

    def start(self):
        """Run the row in a YADE of its own, one thread: several threads are not repeatable."""
        if not self.elsewhere():
            self.log.write_text("")
        with open(self.log, "a") as log:
            self.process = subprocess.Popen([*WITH_ME, "yade", "-n", "-x", "-j", "1", str(HERE / "run.py"), *self.arguments],
                                            stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT)

    def elsewhere(self):
        """Whether another process runs this row."""
        return locks.taken(self.path)

    def news(self):
        """The last line of progress in the log."""
        lines = [line for line in self.log.read_text(errors="replace").splitlines() if line.startswith(self.path.stem)]
        return lines[-1] if lines else f"{self.path.stem}: preparing"

    def outcome(self):
        """How it ended, from the result file; without one, the end of the log."""
        said = results.status(self.path)
        return said or "failed: no result file; the end of its log:\n" + "\n".join(self.log.read_text(errors="replace").splitlines()[-8:])


class Queue:
    """Runs jobs in their order, `at_once` at a time, and says how far it is."""

    def __init__(self, jobs, at_once):
        self.waiting, self.at_once, self.running, self.failed = list(jobs), at_once, [], []
        self.total, self.began, self.told = len(self.waiting), time.monotonic(), time.monotonic()

    def run(self, ended=lambda job: None):
        """Run all; calls ended(job) after each. The paths of those that did not finish."""
        try:
            while self.waiting or self.running:
                while self.waiting and len(self.running) < self.at_once:
                    self._start(next((job for job in self.waiting if not job.elsewhere()), self.waiting[0]))
                time.sleep(0.2)
                for job in [job for job in self.running if job.process.poll() is not None]:
                    self.running.remove(job)
                    print(f"{job.path}: {job.outcome()}", flush=True)
                    if not results.finished(job.path):
                        self.failed.append(job.path)
                    ended(job)
                self._tell()
        finally:
            for job in self.running:
                job.process.kill()
            for job in self.running:
                job.process.wait()
        return self.failed

    def _start(self, job):
        """A row that another process runs waits for it, and ends at once where that has finished it."""
        self.waiting.remove(job)
        job.start()
        self.running.append(job)  # not before it has a process: a signal may come between

    def _tell(self):
        if not self.running or time.monotonic() - self.told < SECONDS:
            return
        self.told = time.monotonic()
        done = self.total - len(self.waiting) - len(self.running)
        left = f", about {(self.told - self.began) / done * (self.total - done) / 60:.0f} min left" if done else ""
        print(f"{done} of {self.total} runs done{left} | " + " | ".join(job.news() for job in self.running), flush=True)


class Figures:
    """Draws a study's figure when the last of its rows has ended."""

    def __init__(self, wanted, full, folder, figures):
        """wanted: {study: its jobs}."""
        self.open = {study: {job.path for job in jobs} for study, jobs in wanted.items()}
        self.full, self.folder, self.figures, self.drawn, self.failed = full, folder, figures, [], []

    def ended(self, paths):
        """These result files will not change any more."""
        for study, left in list(self.open.items()):
            left -= paths
            if not left:
                del self.open[study]
                self._draw(study)

    def _draw(self, study):
        command = [sys.executable, "-m", "analysis", "study", study, "--results", str(pathlib.Path(self.folder).resolve())]
        if self.full:
            command.append("--full")
        if self.figures:
            command += ["-o", str(pathlib.Path(self.figures).resolve())]
        with locks.held(pathlib.Path(self.folder) / f"figure of {study}"):
            done = subprocess.run([*WITH_ME, *command], cwd=HERE.parent, capture_output=True, text=True)
        print((done.stdout + done.stderr).strip(), flush=True)
        if done.returncode:
            self.failed.append(study)
        else:
            self.drawn += done.stdout.split("\n")


def _warn_of_other_code(made_by):
    """Name the results that were made by another commit, or by one with changes: they are kept, and may not be what the code now gives."""
    now = commits.git_commit()
    for path, made in made_by.items():
        if made != now or made.endswith("-dirty"):
            print(f"study: {path} was made by commit {made[:12]}{made[40:]}, the code is at {now[:12]}{now[40:]}; delete the file to run it again.", file=sys.stderr)


def jobs_of(paths, folder):
    """{table: its jobs}; a row that several tables share is one job."""
    known, found = {}, {}
    for path in paths:
        jobs = {line: Job(row, folder) for line, row in tables.read(path).items()}
        for line, job in jobs.items():
            for doubt in plausible.doubts(job.full):
                print(f"study: {path}:{line}: {doubt}.", file=sys.stderr)
        found[path] = [known.setdefault(job.path, job) for job in jobs.values()]
    results.make(folder)
    return found


def _studies(full):
    """{study: paths of its tables}."""
    from analysis import studies
    return {name: [str(studies.TABLES / table) for table in studies.module(name).TABLES["full" if full else "quick"]] for name in studies.names()}


def _options(arguments):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tables", nargs="*", metavar="TABLE", help="tables in yade-batch's format")
    parser.add_argument("--quick", action="store_true", help="all studies, a first version of each")
    parser.add_argument("--full", action="store_true", help="all studies")
    parser.add_argument("--only", action="append", metavar="STUDY", help="with --quick or --full: this study (may be repeated)")
    parser.add_argument("--jobs", type=int, default=2, help="rows run at once (default %(default)s)")
    parser.add_argument("--results", default=results.FOLDER, help="folder of the result files (default %(default)s)")
    parser.add_argument("--figures", help="folder of the figures of --quick and --full (default: figures/quick or figures/full)")
    options = parser.parse_args(arguments)
    if bool(options.tables) + options.quick + options.full != 1:
        parser.error("give either tables, or --quick, or --full")
    if options.only and options.tables:
        parser.error("--only is for --quick and --full")
    if options.jobs < 1:
        parser.error("--jobs must be at least 1")
    return options


def _end(number, frame):
    """What a signal that asks for the end does: leave by the way that ends the runs."""
    os.write(2, b"\nstudy: ended; the same command goes on where it stopped.\n")  # print may be what it has interrupted
    sys.exit(128 + number)


def main(arguments=None):
    """Command line."""
    options = _options(arguments)
    try:
        studies = {} if options.tables else _studies(options.full)
        unknown = [name for name in options.only or () if name not in studies]
        if unknown:
            print(f"study: there is no study {', '.join(unknown)}; there are {', '.join(studies)}", file=sys.stderr)
            return 2
        studies = {name: paths for name, paths in studies.items() if name in (options.only or studies)}
        by_table = jobs_of(options.tables or list(dict.fromkeys(path for paths in studies.values() for path in paths)), options.results)
    except (parameters.ParameterError, tables.TableError, ImportError) as error:
        print(f"study: {error}", file=sys.stderr)
        return 2
    jobs = list(dict.fromkeys(job for rows in by_table.values() for job in rows))
    done = {path: commit for path, (status, commit) in results.endings([job.path for job in jobs]).items() if status == STATUS_FINISHED}
    open_jobs = [job for job in jobs if job.path not in done]
    _warn_of_other_code(done)
    print(f"{', '.join(studies or by_table)}: {len(jobs)} runs, {len(jobs) - len(open_jobs)} of them finished before", flush=True)
    figures = Figures({name: [job for path in paths for job in by_table[path]] for name, paths in studies.items()},
                      options.full, options.results, options.figures)
    try:
        figures.ended({job.path for job in jobs} - {job.path for job in open_jobs})
        failed = Queue(open_jobs, options.jobs).run(lambda job: figures.ended({job.path}))
    except OSError as error:
        print(f"study: {error}: what has finished is kept; make room, and the same command goes on.", file=sys.stderr)
        return 1
    for path in failed:
        print(f"study: {path} failed: {results.status(path) or 'see its log'}", file=sys.stderr)
    drawn = [path for path in figures.drawn if path.strip()]
    if drawn:
        print("Figures:\n  " + "\n  ".join(drawn) + "\nOne page of all: make report" + " FULL=1" * options.full)
    for study in figures.failed:
        print(f"study: no figure of {study}", file=sys.stderr)
    return 1 if failed or figures.failed else 0


if __name__ == "__main__":
    for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGINT):
        if number == signal.SIGINT or signal.getsignal(number) != signal.SIG_IGN:  # nohup goes on
            signal.signal(number, _end)
    sys.exit(main())
