"""Runs YADE several times in parallel: the one place of this project that starts YADE.

Every run has a process and a log of its own. It uses one thread, since runs with several threads are not repeatable. The kernel ends the runs when
the process that started them ends, even by kill -9.
"""
import math
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

from tqdm import tqdm

SECONDS = 5  # between two lines of progress where there is no terminal
WITH_ME = ["setpriv", "--pdeathsig", "KILL"]
SCRIPTS = pathlib.Path(__file__).resolve().parents[1]


def environment():
    """Return the environment for YADE: one thread, a HOME, without which it does not start, and no table of a yade-batch around this process."""
    inherited = {name: value for name, value in os.environ.items() if name != "YADE_BATCH"}
    return {"HOME": tempfile.gettempdir()} | inherited | {"OMP_NUM_THREADS": "1"}


class Job:
    """One run: a script below yade_scripts/ with its arguments, and where its output goes."""

    def __init__(self, script, arguments, log):
        self.script, self.arguments, self.log, self.process = script, [str(word) for word in arguments], pathlib.Path(log), None
        self.began, self.late = math.nan, False  # when the process began, of time.monotonic() [s]; whether it has been ended for taking too long

    def start(self, mode="w"):
        self.log.parent.mkdir(parents=True, exist_ok=True)
        with open(self.log, mode, encoding="utf-8") as log:
            self.process = subprocess.Popen([*WITH_ME, "yade", "-n", "-x", "-j", "1", str(SCRIPTS / self.script), *self.arguments],
                                            stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT, env=environment())
        self.began = time.monotonic()

    def elsewhere(self):
        """Tell whether another process does this job already."""
        return False

    def again(self):
        """Tell, when the process has ended, whether to start it once more."""
        return False

    def said(self, lines=8):
        """Return the end of the log."""
        return "\n".join(self.log.read_text(encoding="utf-8", errors="replace").splitlines()[-lines:])

    def news(self):
        """Return the progress of the run in a few words."""
        return self.log.stem

    def outcome(self):
        """Return how the run ended, in words."""
        return f"ended with {self.process.returncode}"


def run(jobs, at_once, ended=lambda job: None, hours=math.inf):
    """Run all jobs in their order, `at_once` at a time, and call ended(job) after each. However this function ends, it ends the runs.

    hours: a run that takes longer is ended, too.
    """
    waiting, running, told = list(jobs), [], time.monotonic()
    bar = tqdm(total=len(waiting), unit="run", disable=not sys.stderr.isatty())
    try:
        while waiting or running:
            while waiting and len(running) < at_once:
                job = next((job for job in waiting if not job.elsewhere()), waiting[0])
                waiting.remove(job)
                job.start()
                running.append(job)  # only once it has a process, since a signal may come in between
            time.sleep(0.1)
            for job in running:
                if time.monotonic() - job.began > 3600 * hours and not job.late and job.process.poll() is None:
                    job.late = True
                    job.process.kill()
            for job in [job for job in running if job.process.poll() is not None]:
                if not job.late and job.again():
                    job.start("a")
                    continue
                running.remove(job)
                bar.update()
                with bar.external_write_mode(file=sys.stdout):
                    print(f"{job.log.stem}: {f'ended, since it took longer than {hours:g} hours' if job.late else job.outcome()}", flush=True)
                ended(job)
            if running and time.monotonic() - told > SECONDS:
                told = time.monotonic()
                news = " | ".join(job.news() for job in running)
                if bar.disable:
                    print(f"{bar.total - len(waiting) - len(running)} of {bar.total} done | {news}", flush=True)
                else:
                    bar.set_postfix_str(news)
    finally:
        for job in running:
            job.process.kill()
        for job in running:
            job.process.wait()
        bar.close()


def end_by_signals(name):
    """Turn SIGTERM, SIGHUP and SIGINT into SystemExit, so that `run` ends its runs. SIGTERM or SIGHUP stays ignored if it was (nohup)."""
    def end(number, frame):
        os.write(2, f"\n{name}: ended; give the same command again to continue.\n".encode())  # the signal may have interrupted a print
        sys.exit(128 + number)
    for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGINT):
        if number == signal.SIGINT or signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, end)
