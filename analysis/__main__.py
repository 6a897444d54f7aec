"""Draws figures and tables from result files, and runs studies.

Every command has its own --help.
"""
import contextlib
import sys
from pathlib import Path

import pandas

from yade_scripts import commands, parameters, results, tables
from yade_scripts.measuring import store
from yade_scripts.results import provenance, reader
from yade_scripts.running import queue

FIGURES = reader.RESULTS.parent / "figures"
LIMITS = ("the loads dSigma at which cycles on the run's stress path set slip going in its packing of springs, and keep it going: the static limit, "
          "the largest load that the contacts carry at all; the opening limit, above which contacts must open in every cycle; the ratchet limit, "
          "above which slips that open their contacts must ratchet; the shakedown limit, above which slip goes on in every cycle; alternating slip, "
          "the load from which a contact slips to and fro at the normal force that it has at rest; and the first slip "
          "(yade_scripts/theory/shakedown.py says what each proves)")
BAD = 1  # exit status of `check` for a bad file, or for files of several commits


@commands.command("analysis")
def main(arguments=None):
    """Run one command; the exit status: 0, 1 if `check` found a bad file or files of several commits or a run failed, 2 for a mistake of the user."""
    options = _parser().parse_args(arguments)
    try:
        return options.run(options) or 0
    except reader.ResultError as error:
        raise parameters.ParameterError(str(error)) from None


def _parser():
    parser = commands.parser(__doc__, prog="python3 -m analysis")
    kinds = parser.add_subparsers(dest="command", required=True)

    def command(name, run, what):
        found = kinds.add_parser(name, help=what, description=what[0].upper() + what[1:] + ".")
        found.set_defaults(run=run)
        return found

    study = command("study", _study, "figure, summary table and provenance of studies")
    study.add_argument("names", nargs="*", metavar="NAME", help="studies (default: all)")
    study.add_argument("--run", dest="rows", action="store_true", help="first make the runs that have no result yet")
    commands.add(study, "--jobs", "--hours")
    table = command("table", _table, "the rows of a study as a table for yade-batch")
    table.add_argument("name", metavar="NAME")
    charts = command("charts", _charts, "charts of speed against accuracy and maps of stability, from what `make charts` has measured")
    charts.add_argument("--beside", metavar="FOLDER", help="add what was measured to these published charts")
    report = command("report", _report, "one HTML page of all studies and charts")
    report.add_argument("--published", metavar="FOLDER", help="take figures and tables from here and draw nothing")
    commands.add_extent(study)
    for extent in (table, charts, report):
        commands.add_extent(extent, "of the first version", "of the full version")
    for writer, what in ((study, "folder of the figures"), (charts, "folder of the charts"), (report, "page to write")):
        commands.add(writer, "--results")
        writer.add_argument("-o", "--output", help=f"{what} (default: below figures/)")
    command("texts", _texts, "README's findings and the list of all findings, written from their templates and the published tables")
    benchmark = command("benchmark", _benchmark, "figures of `make bench`, from the tables it wrote")
    benchmark.add_argument("folder", nargs="?", default="results/benchmark", help="folder of the tables (default: %(default)s)")
    advice = command("recommend", _recommend, "the cheapest settings that reach an accuracy, with their expected error and cost")
    advice.add_argument("--scene", help="for this scene (default: for each kind of scene)")
    advice.add_argument("--accuracy", type=commands.positive, default=1e-3, help="relative error to be reached (default: %(default)g)")
    advice.add_argument("--measured", metavar="FILE",
                        help="by these measurements: a work_precision.csv, which `charts` writes (default: the published ones)")
    command("limits", _limits, LIMITS).add_argument("file", metavar="FILE", help="result file of a run of a packing under walls")
    for name, run, what in (("summary", _summary, "one line of numbers for each run"), ("check", _check, "tell which result files can be used")):
        command(name, run, what).add_argument("files", nargs="+", metavar="FILE", help="result files")
    return parser


def _folder(options):
    """Return the default folder of the figures."""
    return FIGURES / ("full" if options.full else "quick")


def _demand_results(folder):
    """Raise ParameterError if there is no folder of results of this name."""
    if not Path(folder).is_dir():
        raise parameters.ParameterError(f"there is no folder {folder} with results: make them by `make study`, or name another folder")


def _study(options):
    from analysis import make_study, studies
    broken = []
    names, figures = options.names or studies.names(broken), Path(options.output or _folder(options))
    for name in names:
        studies.module(name)
    for message in broken:
        print(f"analysis study: {message}", file=sys.stderr)
    if not options.rows:
        _demand_results(options.results)
    results.make(figures, "figures")
    if options.rows:
        return make_study.run(names, options.full, options.results, figures, options.jobs, options.hours) or (commands.MISTAKE if broken else 0)
    drawn = [make_study.draw(name, figures, options.results, options.full) for name in names]
    return commands.MISTAKE if broken or not any(drawn) else 0


def _table(options):
    from analysis import studies
    print(tables.text(studies.module(options.name).ROWS["full" if options.full else "quick"]), end="")


def _charts(options):
    """Draw all charts. Print the files of those that were drawn, and the names of those without measurements."""
    from analysis import charts, publish
    from analysis.charts import publishing
    folder = Path(options.output or _folder(options) / charts.FOLDER)
    results.make(folder, "figures")
    broken = []
    left = publishing.publish_all(options.results, folder, options.full, broken, options.beside)
    for message in (*left.values(), *broken):
        print(f"analysis charts: {message}", file=sys.stderr)
    for name in [name for name in charts.ORDER if name not in left]:  # others may lie there from before
        for file in publish.read_json(folder / f"{name}.json", {"figures": dict})["figures"]:
            print((folder / file).resolve())
    return commands.MISTAKE if broken or len(left) == len(charts.ORDER) else 0


def _report(options):
    """Write the page: of studies and charts drawn now, or of published ones as they are."""
    from analysis import charts, publish, report, studies
    from analysis.charts import publishing
    folder = Path(options.published or _folder(options))
    if options.published and (options.quick or options.full or options.results != results.FOLDER):
        raise parameters.ParameterError("--published takes figures and tables as they are: leave out --quick, --full and --results")
    broken, faults, failed = [], {}, {}
    if not options.published:
        _demand_results(options.results)
        waiting, failed = publish.publish_all(studies.names(broken), folder, options.results, options.full)
        left = publishing.publish_all(options.results, folder / charts.FOLDER, options.full, broken)
        if waiting:
            print(f"analysis report: no run has finished of {', '.join(waiting)}: make study", file=sys.stderr)
        for message in (*failed.values(), *left.values(), *broken):
            print(f"analysis report: {message}", file=sys.stderr)
        faults = failed | waiting | {f"{charts.FOLDER}/{name}": message for name, message in left.items()}
    page = options.output or FIGURES / "report.html"
    try:
        print(report.build(folder, page, bool(options.published), faults).resolve())
    except OSError as error:
        raise parameters.ParameterError(f"{page} cannot be written: {error}") from None
    return commands.MISTAKE if broken or failed else 0


def _texts(options):
    from analysis import texts
    print(*texts.write(), sep="\n")


def _benchmark(options):
    from analysis import benchmark
    print(*benchmark.draw(options.folder), sep="\n")


def _recommend(options):
    from analysis.charts import recommend, table
    measured = options.measured or table.PUBLISHED
    print("\n".join(recommend.of_scene(options.scene, options.accuracy, measured) if options.scene else
                    recommend.by_kind(options.accuracy, measured)))


def _limits(options):
    from analysis import limits
    run = reader.load_named(options.file)
    found = limits.of_cycles(run)
    for name in ("static", "opening", "ratchet", "shakedown"):
        print(f"{name} limit {getattr(found, name):.4g}")
    print(f"alternating slip {found.alternating:.4g}", f"first slip {found.first_slip:.4g}", sep="\n")
    if run.method == "CD":
        print("Rigid grains have the static limit only; the others are those of springs that carry the forces of the first snapshot.")


def _summary(options):
    """Print a table, then why runs failed and what is known exactly of each; a failed or unfinished run stays in the table."""
    rows, notes, unread = [], [], []
    for name in options.files:
        try:
            run = reader.load_named(name)
        except reader.NoRunError as error:
            unread.append(_why_no_run(name, error))
            continue
        except reader.ResultError as error:
            unread.append(error)
            continue
        status, _, reason = str(run.attributes["status"]).partition(": ")
        rows.append({"file": run.path.name, "method": run.method, "status": status} | (_numbers(run) if run.finished else {}))
        notes += [f"{run.path.name}: {status}: {reason}"] * bool(reason) + [f"{run.path.name}: {run.outcome}"] * run.collapsed
        notes += [f"{run.path.name}: {name}: {known}" for name, known in run.known.items()]
    if rows:
        print(pandas.DataFrame(rows).to_string(index=False, float_format="{:.4g}".format, na_rep="n/a"), *notes, sep="\n")
    for error in unread:
        print(f"analysis: {error}", file=sys.stderr)
    return commands.MISTAKE if unread else 0


def _why_no_run(name, error):
    """Return why a file that is no run is left out of the table: `error`, unless it is a measurement."""
    try:
        store.load(name)
    except reader.ResultError:
        return error
    return reader.ResultError(name, "is a measurement, not a run", "`python3 -m analysis check` reads it")


def _numbers(run):
    """Return the numbers of a run; NaN for those that its scene does not have."""
    from analysis import loops, observables
    columns = {
        "cycles": lambda: run.values("cycle")[-1],
        "gamma end": lambda: observables.change(run, "gamma"),
        "loop width": lambda: loops.of(run)["width"],
        "stiffness Pa": lambda: observables.stiffness(run.values("gamma"), run.values("sigma2")) if run.method == "MD" else float("nan"),
        "dissipated J": lambda: observables.change(run, "dissipated_energy"),
        "wall work J": lambda: observables.wall_work(run),
        "stress error/P0": lambda: observables.stress_error(run),
        "unconverged": lambda: observables.unconverged_steps(run) if run.method == "CD" else float("nan"),
        "commit": lambda: provenance.short(run.attributes["git_commit"])}
    found = dict.fromkeys(columns, float("nan"))
    for name, value in columns.items():
        with contextlib.suppress(reader.ResultError):
            found[name] = value()
    return found


def _check(options):
    """Print a line a file, of a run or of a measurement; say also if files come from several commits; the exit status is then BAD, too."""
    bad, commits = 0, {}
    for name in options.files:
        try:
            what, commit = _content(name)
        except reader.ResultError as error:
            print(error)
            bad += 1
            continue
        commits.setdefault(commit, []).append(Path(name).name)
        print(f"{name}: finished, {what}")
    if len(commits) > 1:
        print("made by different commits: " + "; ".join(f"{commit}: {', '.join(names)}" for commit, names in commits.items()))
    return BAD if bad or len(commits) > 1 else 0


def _content(name):
    """Return what a file holds, in words, and the commit that made it. Raise ResultError if it cannot be used under its name."""
    try:
        run = reader.load_named(name, finished=True)
    except reader.NoRunError:
        facts = store.load(name)
        return f"a measurement ({facts.get('status') or facts.get('verdict') or facts['piece']})", facts["git_commit"]
    what = f"{run.attributes['scene']} {run.method}, {len(run.values('time'))} samples, {len(run.snapshots)} snapshots"
    without = "".join(f", no {name}" for name in run.not_shown)
    return what + f", {run.outcome}" * run.collapsed + without, run.attributes["git_commit"]


if __name__ == "__main__":
    queue.end_by_signals("analysis")
    sys.exit(main())
