"""Probes what is missing of one map, in one YADE process:  yade -n -x -j 1 yade_scripts/maps/worker.py NAME [--full] [--results=FOLDER]

The case under way stands in NAME.underway, so that a crash or a hang costs that case only (see run.py).
"""
import importlib
import json
import pathlib
import sys
import time

if __name__ == "__main__":
    sys.path.insert(0, str(pathlib.Path(sys.argv[0]).resolve().parents[2]))

from yade import O, config

from yade_scripts import commits
from yade_scripts.maps import NOT_SOLVED, Outcome, get, store
from yade_scripts.maps.search import bisect


class Prober:
    """Outcomes of cases, from the file where they stand there, else by running the probe."""

    def __init__(self, name, folder):
        self.store = store.Store(name, folder)
        self.probe = importlib.import_module(f"yade_scripts.maps.probes.{name}").probe
        self.underway = self.store.path.with_suffix(".underway")
        self.commit = commits.git_commit()
        self.made = 0

    def __call__(self, case):
        """The Outcome of a case; what raises is a case not solved, and says so."""
        known = self.store.outcome(case)
        if known is not None:
            return known
        self.underway.parent.mkdir(parents=True, exist_ok=True)
        self.underway.write_text(json.dumps(case))
        started = time.perf_counter()
        O.reset()
        try:
            outcome = self.probe(case)
        except RuntimeError as error:  # what engines and guards raise; all else is a mistake of the probe
            outcome = Outcome(NOT_SOLVED, "refused", " ".join(str(error).split()))
        self.store.add(case, outcome, commit=self.commit, yade=config.version, seconds=round(time.perf_counter() - started, 3))
        self.underway.unlink()
        self.made += 1
        print(f"{self.made} {json.dumps(case)}: {outcome.verdict} {outcome.reason}", flush=True)
        return outcome


def main(arguments):
    """Command line; the exit status is 0 once nothing is missing."""
    name = arguments[0]
    folder = next((a.partition("=")[2] for a in arguments if a.startswith("--results=")), store.FOLDER)
    chart, prober = get(name), Prober(name, folder)
    for case in chart.grid("--full" in arguments):
        prober(case)
    for search in chart.searches("--full" in arguments):
        bisect(search, prober)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
