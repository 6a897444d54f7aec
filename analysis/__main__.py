"""Command line: figures and tables from result files alone. `python3 -m analysis --help`."""

import argparse
import math
import sys
from pathlib import Path

from analysis import load, observables, publish, studies

FIGURES = load.RESULTS.parent / "figures"
EXIT_BAD_FILE, EXIT_MISTAKE = 1, 2


def main(arguments=None):
    """Run one command; the exit status: 0, 1 if `check` found a bad file, 2 for a user's mistake."""
    options = _parser().parse_args(arguments)
    try:
        return options.run(options)
    except (load.ResultError, OSError) as error:
        # An OSError is a figure that cannot be written: the loader turns those of reading into ResultError.
        print(f"analysis {options.command}: {error}", file=sys.stderr)
        return EXIT_MISTAKE


def _parser():
    parser = argparse.ArgumentParser(prog="python3 -m analysis", description="Figures and tables from result files.")
    commands = parser.add_subparsers(dest="command", required=True)
    for name, what, run in (("fig4", "stress against gamma, MD left and CD right", _fig4),
                            ("force-networks", "contact forces of MD and CD at the load maximum", _force_networks)):
        figure = commands.add_parser(name, help=what, description=what + ".")
        figure.add_argument("files", nargs="*", metavar="FILE", help="one MD and one CD run of the same packing; "
                            "without: the newest such pair in the results folder")
        figure.add_argument("-o", "--output", default=str(FIGURES / f"{name}.png"), help="figure to write (.png, .pdf, .svg)")
        figure.add_argument("--table", help="take the two runs of this table of yade_scripts/tables/")
        figure.add_argument("--results", default=str(load.RESULTS), help="folder to look in when no files are given")
        figure.add_argument("--mixed-commits", action="store_true", help="accept runs of different commits; the figure says so")
        figure.set_defaults(run=run)
        if name == "fig4":
            figure.add_argument("--cycle", type=int, default=1, help="which cycle, from 1 (default: %(default)s)")
    study = commands.add_parser("study", help="figure, summary table and provenance of a study",
                                description="Write NAME.png, NAME.csv and NAME.json of a study from its result files.")
    study.add_argument("name", metavar="NAME", help=f"one of {', '.join(studies.names())}; or all")
    study.add_argument("--full", action="store_true", help="of the full tables (default: the quick ones)")
    study.add_argument("-o", "--output", metavar="FOLDER", help="where to (default: figures/quick or figures/full)")
    study.add_argument("--results", default=str(load.RESULTS), help="folder of the result files")
    study.set_defaults(run=_study)
    report = commands.add_parser("report", help="one HTML page of all studies",
                                 description="Draw all studies that have results, then write one self-contained HTML page of them.")
    report.add_argument("--full", action="store_true", help="of the full tables (default: the quick ones)")
    report.add_argument("-o", "--output", default="report.html", help="page to write (default: %(default)s)")
    report.add_argument("--results", default=str(load.RESULTS), help="folder of the result files")
    report.add_argument("--published", metavar="FOLDER", help="take figures and tables from here and draw nothing")
    report.set_defaults(run=_report)
    charts = commands.add_parser("charts", help="charts of speed against accuracy and maps of stability",
                                 description="Draw every chart from the records that `make charts` has left.")
    charts.add_argument("--full", action="store_true", help="with the settings of the full run (default: the quick one's)")
    charts.add_argument("-o", "--output", metavar="FOLDER", help="where to (default: figures/quick/charts or figures/full/charts)")
    charts.add_argument("--results", default=str(load.RESULTS), help="folder of the results")
    charts.set_defaults(run=_charts)
    advice = commands.add_parser("recommend", help="method and settings for an accuracy",
                                 description="The cheapest measured settings that reach an accuracy, their expected error and cost.")
    advice.add_argument("--scene", help="for this scene (default: for each kind of scene)")
    advice.add_argument("--accuracy", type=_accuracy, default=1e-3, help="relative error to be reached (default: %(default)g)")
    advice.add_argument("--table", action="store_true", help="for each kind of scene as a table in Markdown")
    advice.add_argument("--results", default=str(load.RESULTS), help="folder of the results; taken where newer than what is published")
    advice.set_defaults(run=_recommend)
    for name, what, run in (("summary", "one line of numbers a run", _summary), ("check", "say which files can be used", _check)):
        command = commands.add_parser(name, help=what, description=what + ".")
        command.add_argument("files", nargs="+", metavar="FILE", help="result files")
        command.set_defaults(run=run)
    return parser


def _pair(options):
    if options.table and options.files:
        raise load.ResultError(options.table, "a table and files are both given", "give one or the other")
    if options.table:
        return load.pair_of_table(options.table, options.results, options.mixed_commits)
    if not options.files:
        return load.newest_pair(options.results, options.mixed_commits)
    if len(options.files) != 2:
        raise load.ResultError(", ".join(options.files), f"{len(options.files)} file(s) given", "give two, one MD and one CD run")
    return load.pair(*options.files, mixed_commits=options.mixed_commits)


def _fig4(options):
    from analysis.figures import fig4
    return _draw(options, lambda md, cd, path: fig4.draw(md, cd, path, options.cycle))


def _force_networks(options):
    from analysis.figures import force_networks
    return _draw(options, force_networks.draw)


def _draw(options, draw):
    md, cd = _pair(options)
    try:
        draw(md, cd, options.output)
    except ValueError as error:
        if "is not supported" not in str(error):  # Matplotlib's words for an unknown file format
            raise
        raise load.ResultError(options.output, "unknown kind of figure", "name it .png, .pdf or .svg") from None
    print(Path(options.output).resolve())
    return 0


def _study(options):
    """Publish one study or all; what is missing is named."""
    folder = Path(options.output or _folder(options))
    if options.name == "all":
        _publish_all(options, folder)
        print(folder.resolve())
        return 0
    collection = studies.collect(options.name, options.results, options.full)
    print(publish.publish(collection, folder).with_suffix(".png").resolve())
    for path, _, reason in collection.missing:
        print(f"analysis study: {path.name}: {reason}", file=sys.stderr)
    return 0


def _folder(options):
    """Where studies are published unless told otherwise."""
    return FIGURES / ("full" if options.full else "quick")


def _publish_all(options, folder):
    for name, reason in publish.publish_all(folder, options.results, options.full).items():
        print(f"analysis {options.command}: {name}: {reason}", file=sys.stderr)


def _report(options):
    """The page, of studies drawn just now or taken as they are."""
    from analysis import charts, report
    if not options.published:
        _publish_all(options, _folder(options))
        charts.publish_all(options.results, _folder(options) / charts.FOLDER, options.full)
    print(report.build(options.published or _folder(options), options.output).resolve())
    return 0


def _charts(options):
    """Draw all charts; those without records are named."""
    from analysis import charts
    folder = Path(options.output or _folder(options) / charts.FOLDER)
    left = charts.publish_all(options.results, folder, options.full)
    for name, reason in left.items():
        print(f"analysis charts: {name}: {reason}", file=sys.stderr)
    print("\n".join(str(path.resolve()) for path in sorted(folder.glob("*.png"))))
    return EXIT_MISTAKE if len(left) == len(charts.names()) else 0


def _accuracy(text):
    """A positive number."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"{text} is no accuracy: it is a relative error above 0, such as 1e-3")
    return value


def _recommend(options):
    """What to run for an accuracy."""
    from analysis.charts import recommend
    found, source = recommend.rows(options.scene, options.results)
    if options.table:
        lines = recommend.readme_table(found)
    elif options.scene:
        lines = recommend.of_scene(options.scene, options.accuracy, found, source)
    else:
        lines = recommend.by_kind(options.accuracy, found, source)
    print("\n".join(lines))
    return 0


# Column of the summary: its heading and what it shows of a run.
_COLUMNS = (
    ("file", lambda run: run.path.name),
    ("method", lambda run: run.method),
    ("cycles", lambda run: f"{run.values('cycle')[-1]:g}"),
    ("gamma end", lambda run: f"{observables.permanent_strain(run.values('gamma')):.4e}"),
    ("loop width", lambda run: f"{observables.loop_width(run.values('gamma'), run.values('sigma2')):.3e}"),
    ("stiffness Pa", lambda run: f"{observables.stiffness(run.values('gamma'), run.values('sigma2')):.3e}"),
    ("dissipated J", lambda run: f"{observables.change(run, 'dissipated_energy'):.4e}"),
    ("wall work J", lambda run: f"{observables.wall_work(run):.4e}"),
    ("stress error/P0", lambda run: f"{observables.stress_error(run):.1e}"),
    ("unconverged", lambda run: str(observables.unconverged_steps(run)) if run.method == "CD" else "-"),
    ("commit", lambda run: run.attributes["git_commit"][:12]),
)


def _summary(options):
    """A table; a failed or unfinished run stays in it, as its status."""
    rows, broken = [[heading for heading, _ in _COLUMNS]], []
    for name in options.files:
        run = load.load(name, finished=False)
        if run.finished:
            rows.append([_cell(show, run) for _, show in _COLUMNS])
        else:
            broken.append(f"{run.path.name}  {run.attributes['status']}")
    widths = [max(map(len, column)) for column in zip(*rows)]
    for row in rows:
        print("  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip())
    print("".join(line + "\n" for line in broken), end="")
    return 0


def _cell(show, run):
    """What a column shows, or that the run (of a small scene, say) has no such number."""
    try:
        return show(run)
    except load.ResultError:
        return "n/a"


def _check(options):
    """A line a file; runs of several commits are pointed out, as no figure mixes them unasked."""
    bad, commits = 0, {}
    for name in options.files:
        try:
            run = load.load(name)
        except load.ResultError as error:
            print(error)
            bad += 1
            continue
        commits.setdefault(run.attributes["git_commit"], []).append(run.path.name)
        print(f"{name}: finished, {run.attributes['scene']} {run.method}, {len(run.values('time'))} samples, {len(run.snapshots)} snapshots")
    if len(commits) > 1:
        print("made by different commits: " + "; ".join(f"{commit}: {', '.join(names)}" for commit, names in commits.items()))
    return EXIT_BAD_FILE if bad or len(commits) > 1 else 0


if __name__ == "__main__":
    sys.exit(main())
