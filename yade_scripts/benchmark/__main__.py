"""Measures the solvers beside Siconos's: `make bench`, or

    /usr/bin/python3 -m yade_scripts.benchmark [--quick] [--again] [--publish] [--table NAME] [FILE ...]

FILE: problems to measure with the project's own, such as those of Siconos's library (text) or FCLIB's (HDF5).
Pieces that were measured with the same build are kept: stop it and start it again at will; --again measures all anew. Times are processor
time of one thread, of both codes; still nothing else should run on the machine, since it would share caches and memory. Results:
results/benchmark/*.csv, figures beside them.
"""
import argparse
import json
import os
import pathlib
import platform
import sys
import time

from analysis import publish
from yade_scripts import commits
from yade_scripts.benchmark import goals, pieces, problems, siconos

FOLDER = problems.ROOT / "results" / "benchmark"
PUBLISHED = problems.ROOT / "analysis" / "published" / "benchmark"
EXIT_FAILED, EXIT_MISTAKE = 1, 2


def main(arguments=None):
    """Exit status: 0, 1 if a piece failed, 2 for a mistake of the user."""
    options = _parser().parse_args(arguments)
    for path in options.files:
        try:
            problems.from_file(path)
        except (OSError, ValueError) as error:
            print(f"benchmark: {error}", file=sys.stderr)
            return EXIT_MISTAKE
    folder = pathlib.Path(options.output or (FOLDER / "quick" if options.quick else FOLDER))
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        print(f"benchmark: --output={folder} cannot be a folder: {error}", file=sys.stderr)
        return EXIT_MISTAKE
    if reason := siconos.available():
        print(f"benchmark: without Siconos beside it: {reason}", file=sys.stderr)
    busy = os.getloadavg()[0]
    if busy > 0.5:
        print(f"benchmark: {busy:.1f} processes are running already; the times will not mean much", file=sys.stderr)
    todo = (pieces.quick if options.quick else pieces.full)(folder / "problems", options.files)
    if options.table:
        return _one_table(options, todo, folder, busy)
    tables, failed = run(todo, folder, options.again)
    tables["goals"] = goals.table(*(tables[name] for name in ("solutions", "sweeps", "engine")))
    write(tables, folder, busy)
    show(tables)
    from analysis import benchmark
    for path in benchmark.draw(folder):
        print(path)
    if options.publish:
        _publish(folder)
    return EXIT_FAILED if failed else 0


def _parser():
    parser = argparse.ArgumentParser(prog="python3 -m yade_scripts.benchmark", description="Measure the contact solvers beside Siconos's.")
    parser.add_argument("files", nargs="*", metavar="FILE", help="problems to measure, too (FCLIB, Siconos's text, or of bodies)")
    parser.add_argument("--quick", action="store_true", help="a small set, about a minute")
    parser.add_argument("--again", action="store_true", help="measure again what was measured with this build")
    parser.add_argument("--publish", action="store_true", help=f"copy tables and figures to {PUBLISHED.relative_to(problems.ROOT)}")
    parser.add_argument("--table", choices=pieces.TABLES, help="measure this table only and leave the others as they are")
    parser.add_argument("-o", "--output", metavar="FOLDER", help="where to write (default: results/benchmark, or its folder quick)")
    return parser


def run(todo, folder, again=False):
    """({table: rows}, number of pieces that failed); progress goes to the terminal, a piece's failure becomes a row."""
    tables, failed, begin = {name: [] for name in pieces.TABLES}, 0, time.monotonic()
    for number, piece in enumerate(todo, 1):
        rows = None if again else piece.stored(folder)
        if rows is None:
            print(f"[{number}/{len(todo)}, {time.monotonic() - begin:.0f} s] {piece.name}", flush=True)
            try:
                rows = piece.measure(folder, _say)
            except (RuntimeError, OSError, ValueError) as error:
                print(f"benchmark: {piece.name}: {error}", file=sys.stderr, flush=True)
                failed += 1
                rows = []
                tables.setdefault("failures", []).append({"piece": piece.name, "status": f"failed: {error}"})
            _say("")
        tables[piece.table] += rows
    return tables, failed


def _say(what):
    """What is going on, on the terminal's last line."""
    if sys.stderr.isatty():
        print(f"\r\033[K{what}", end="", file=sys.stderr, flush=True)


def write(tables, folder, busy):
    """A CSV for each table, and what was measured where."""
    for name, rows in tables.items():
        _write_table(folder, name, rows)
    (folder / "provenance.json").write_text(json.dumps(_provenance(busy), indent=1) + "\n")


def _write_table(folder, name, rows):
    publish.write_csv(folder / f"{name}.csv", [{key: "" if value is None else value for key, value in row.items()} for row in rows])


def _provenance(busy):
    from cd_engine import core
    return {"commit": commits.git_commit(), "processor": publish.processor(), "instruction_sets": core.instruction_sets(),
            "processes_running_before": round(busy, 2), "siconos": _siconos_version(), "python": platform.python_version(),
            "default_method": goals.default_method(), "methods": core.methods()}


def _one_table(options, todo, folder, busy):
    """Measure one table and put it among the others, with a provenance of its own; exit status."""
    name = options.table
    tables, failed = run([piece for piece in todo if piece.table == name], folder, options.again)
    if failed:
        return EXIT_FAILED
    for place in [folder] + [PUBLISHED] * options.publish:
        _write_table(place, name, tables[name])
        path = place / "provenance.json"
        known = json.loads(path.read_text()) if path.exists() else {}
        known.setdefault("tables", {})[name] = _provenance(busy)
        path.write_text(json.dumps(known, indent=1) + "\n")
    show({table: rows for table, rows in tables.items() if rows})
    return 0


def _siconos_version():
    try:
        from siconos.numerics import __version__ as version
        return version
    except (ImportError, AttributeError):
        import importlib.metadata as metadata
        try:
            return metadata.version("siconos")
        except metadata.PackageNotFoundError:
            return "unknown"


def show(tables):
    """The tables on the terminal: of the solutions what goals are about, everything else whole."""
    solutions = [row for row in tables.get("solutions", []) if row["target"] in (1e-4, 1e-6, 1e-8)]
    if solutions:
        print_table("Solutions", solutions, ("problem", "target", "method", "sweeps", "seconds", "residual", "residual_max", "status"))
    for name in ("oracle", "sweeps", "engine", "reduction", "failures", "goals"):
        if tables.get(name):
            print_table(name.capitalize(), tables[name], list(tables[name][0]))


def print_table(title, rows, names):
    """Rows in columns of equal width; a table wider than 200 characters is printed on its side."""
    cells = [[_text(row.get(name)) for name in names] for row in rows]
    if sum(max(map(len, column)) + 2 for column in zip(names, *cells)) > 200:
        cells, names = [list(column) for column in zip(names[1:], *(row[1:] for row in cells))], [names[0]] + [row[0] for row in cells]
    widths = [max(map(len, column)) for column in zip(names, *cells)]
    print(f"\n{title}")
    for line in [names, *cells]:
        print("  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip())


def _text(value):
    return "-" if value is None else f"{value:.3g}" if isinstance(value, float) else str(value)


def _publish(folder):
    """Tables and figures into the repository."""
    PUBLISHED.mkdir(parents=True, exist_ok=True)
    for path in [*folder.glob("*.csv"), *folder.glob("*.png"), folder / "provenance.json"]:
        (PUBLISHED / path.name).write_bytes(path.read_bytes())
    print(PUBLISHED)


if __name__ == "__main__":
    sys.exit(main())
