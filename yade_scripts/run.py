"""Runs one row of parameters: one scene, one method, one result file.

    yade -n -x yade_scripts/run.py method=CD seed=3          by name=value arguments
    yade-batch yade_scripts/tables/fig4.txt yade_scripts/run.py   as a row of a table
    from yade_scripts import run; run.start(method="CD")     at YADE's console: set up, ready for O.run()

Results go to results/<scene>-<method>-<hash of the row>.h5; a finished run is not run again. `--results=FOLDER` puts them elsewhere.
Exit status: 0 done, 1 the run failed (its file says why), 2 the row cannot be run.
"""
import os
import pathlib
import sys
import traceback

if __name__ == "__main__":
    sys.path.insert(0, str(pathlib.Path(sys.argv[0]).resolve().parent.parent))

from yade_scripts import parameters, results, tables


def start(folder=results.FOLDER, **row):
    """Build the scene of a row, ready for O.run(); nothing is recorded. The scene.Scene."""
    from yade_scripts import scenes
    return scenes.build(parameters.complete(row), folder)


def execute(row, folder=results.FOLDER):
    """Run a row to its end and write its file; the exit status."""
    full = parameters.complete(row)
    path = results.path_of(full, folder)
    if results.finished(path):
        print(f"{path} is there already.")
        return 0
    path.parent.mkdir(parents=True, exist_ok=True)
    failure = _run(path, full, folder)
    if failure is None:
        print(f"{path}: finished")
        return 0
    print(f"{path}: failed: {failure}", file=sys.stderr)
    if not isinstance(failure, RuntimeError):  # which is what engines, preparation and stress check raise; all else is a bug
        traceback.print_exception(failure)
    return 1


def _run(path, full, folder):
    """Build, run, record; None or the exception that ended the run, which the file names too."""
    from yade_scripts import load_check, progress, record, scenes
    scene, failure, collapse, show = scenes.Scene(every=1, samples=1), None, None, progress.progress(path.stem)
    try:
        scene = scenes.build(full, folder)
    except (parameters.ParameterError, ImportError):
        raise
    except Exception as error:
        failure = error
    recorder = record.Recorder(path, full, scene, show)
    if failure is None:
        scene.observer = recorder.sample
        try:
            scenes.method(full).run(scene)
        except load_check.Collapse as event:
            collapse = event
        except Exception as error:
            failure = error
    show.close()
    recorder.close(failure, collapse)
    return failure


def main(arguments):
    """Command line and yade-batch."""
    folders = [a for a in arguments if a.startswith("--results=")]
    folder = folders[-1].partition("=")[2] if folders else results.FOLDER
    try:
        if "YADE_BATCH" in os.environ:
            row = tables.batch_row(os.environ["YADE_BATCH"])
        else:
            row = parameters.from_arguments([a for a in arguments if a not in folders])
        return execute(row, folder)
    except (parameters.ParameterError, tables.TableError, ImportError, OSError) as error:
        print(f"run: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
