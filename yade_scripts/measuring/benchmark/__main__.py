"""Measures the contact solvers beside Siconos's, as `make bench` does.

    /usr/bin/python3 -m yade_scripts.measuring.benchmark [--quick | --full] [--again] [--table NAME] [FILE ...]

FILE: problems to measure besides the project's own, such as those of Siconos's library (text) or FCLIB's (HDF5).
Pieces that were measured with the same build are kept, so the run can be stopped and started again; --again measures all anew. Times of both
codes are processor time of one thread. Other programs should not run meanwhile, since they would share caches and memory. Results:
results/benchmark/*.csv, without --full results/benchmark/quick/*.csv; `python3 -m analysis benchmark FOLDER` draws them. Exit status: 0, 1 if a
piece failed, 2 for wrong arguments.
"""
import importlib.metadata
import inspect
import json
import os
import pathlib
import platform
import sys

import pandas
from tqdm import tqdm

from yade_scripts import commands, results
from yade_scripts.errors import ParameterError
from yade_scripts.measuring import store
from yade_scripts.measuring.benchmark import pieces, problems, siconos
from yade_scripts.running import queue


@commands.command("benchmark")
def main(arguments=None):
    parser = commands.parser(__doc__, prog="python3 -m yade_scripts.measuring.benchmark")
    parser.add_argument("files", nargs="*", metavar="FILE", help="problems to measure, too (FCLIB, Siconos's text, or of bodies)")
    commands.add_extent(parser, "a first version, some two minutes", "the real one, hours; it can be stopped and started again")
    commands.add(parser, "--results")
    parser.add_argument("--again", action="store_true", help="measure again what was measured with this build")
    parser.add_argument("--table", choices=pieces.MEASURE, help="measure this table only and leave the others as they are")
    options = parser.parse_args(arguments)
    for path in options.files:
        try:
            problems.from_file(path)
        except ValueError as error:
            raise ParameterError(str(error)) from None
    folder = pathlib.Path(options.results) / "benchmark" / ("" if options.full else "quick")
    results.make(folder)
    if reason := siconos.available():
        print(f"benchmark: without Siconos beside it: {reason}", file=sys.stderr)
    busy = os.getloadavg()[0]
    if busy > 0.5:
        print(f"benchmark: {busy:.1f} other processes are running; they disturb the measured times", file=sys.stderr)
    todo = (pieces.full if options.full else pieces.quick)(options.files)
    tables, failed = run([piece for piece in todo if options.table in (None, piece.table)], folder, options.again)
    write(tables, folder, busy, options.table)
    return 1 if failed else 0


def run(todo, folder, again=False):
    """Measure the pieces in `todo`. Return ({table: rows}, number of pieces that failed). A piece that fails becomes a row with the reason."""
    tables, failures = {}, []
    bar = tqdm(todo, unit="piece", disable=not sys.stderr.isatty())
    for number, piece in enumerate(bar, 1):
        rows = None if again else piece.stored(folder)
        if rows is None:
            bar.write(f"[{number}/{len(todo)}] {piece.name}")
            try:
                rows = piece.measure(folder)
            except (RuntimeError, OSError, ValueError) as error:
                bar.write(f"benchmark: {piece.name}: {error}", file=sys.stderr)
                failures.append({"piece": piece.name, "status": f"failed: {error}"})
                rows = []
        tables.setdefault(piece.table, []).extend(rows)
    return tables | ({"failures": failures} if failures else {}), len(failures)


def write(tables, folder, busy, only=None):
    """Write a CSV file for each table, and the provenance. If only one table was measured, it gets a provenance of its own."""
    for name, rows in tables.items():
        table = pandas.DataFrame(rows)
        table.to_csv(folder / f"{name}.csv", index=False)
        print(f"\n{name.capitalize()}\n{table.to_string(index=False, float_format='{:.3g}'.format, na_rep='-')}")
    path, known = folder / "provenance.json", provenance(busy)
    if only:
        known = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
        known.setdefault("tables", {})[only] = provenance(busy)
    path.write_text(json.dumps(known, indent=1) + "\n", encoding="utf-8")


def provenance(busy):
    """Return where the numbers come from: commit, processor, versions, solvers; busy: load of the machine before the run."""
    from cd_engine import core
    try:
        peer = importlib.metadata.version("siconos")
    except importlib.metadata.PackageNotFoundError:
        peer = "unknown"
    found = store.origin()
    return {"commit": found["git_commit"], "processor": found["processor"], "instruction_sets": core.instruction_sets(),
            "processes_running_before": round(busy, 2), "siconos": peer, "python": platform.python_version(),
            "default_method": inspect.signature(core.solve).parameters["method"].default, "methods": core.methods()}


if __name__ == "__main__":
    queue.end_by_signals("benchmark")
    sys.exit(main())
