"""Draws studies; `make study` runs their rows first, and draws each study as soon as the last of its rows has ended."""
import sys
from pathlib import Path

from analysis import publish, studies
from yade_scripts import batch, commands, declared, results
from yade_scripts.running import locks


def draw(name, figures, folder, full):
    """Write the files of a study. Print its figure and how many runs are not in it, or why there is none. Return whether there is one."""
    waiting, faults = publish.publish_all([name], figures, folder, full)
    if fault := (waiting | faults).get(name):
        print(f"analysis study: {fault}", file=sys.stderr)
        return False
    print((Path(figures) / f"{name}.png").resolve(), flush=True)
    facts = publish.read_json(Path(figures) / f"{name}.json", {"runs_finished": int, "runs_failed": int, "runs_missing": int})
    if others := facts["runs_failed"] + facts["runs_missing"]:
        print(f"analysis study: {name}: {others} of {others + facts['runs_finished']} runs have failed or are missing; the table says why",
              file=sys.stderr)
    return True


def run(names, full, folder, figures, jobs, hours):
    """Run and draw the studies. Return 0, 1 if a row failed or a figure could not be drawn, MISTAKE if rows of a study cannot be run."""
    broken = []
    names = declared.readable(names, lambda name: studies.rows(name, full), broken)
    for message in broken:
        print(f"analysis study: {message}", file=sys.stderr)
    if not names:
        return commands.MISTAKE
    rows = {name: [results.path_of(row, folder) for row in studies.rows(name, full)] for name in names}
    left, drawn = {name: set(paths) for name, paths in rows.items()}, {}

    def ended(path):
        for name in [name for name, paths in left.items() if path in paths]:
            left[name].discard(path)
            if not left[name]:
                del left[name]
                with locks.held(Path(folder) / f"figure of {name}"):
                    drawn[name] = draw(name, figures, folder, full)

    try:
        queue = batch.jobs_of([row for name in names for row in studies.module(name).ROWS["full" if full else "quick"]], folder)
        print(f"{', '.join(names)}: ", end="")
        failed = batch.work_off(queue, jobs, ended, hours)
    except OSError as error:
        print(f"study: {error}: finished runs are kept; {commands.cure(error)} and give the same command again.", file=sys.stderr)
        return 1
    if pictures := [str((Path(figures) / f"{name}.png").resolve()) for name, there in drawn.items() if there]:
        print("Figures:", *pictures, sep="\n  ")
        print("One page of all: make report" + " FULL=1" * full)
    return 1 if failed or not all(drawn.values()) else commands.MISTAKE if broken else 0
