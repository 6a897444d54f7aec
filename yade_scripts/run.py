"""Runs one row of parameters: one scene, one method, one result file.

    yade -n -x yade_scripts/run.py method=CD seed=3          by name=value arguments
    yade-batch TABLE.txt yade_scripts/run.py                 as a row of a table; without TABLE.txt the row of defaults
    from yade_scripts import run; run.start(method="CD")     at YADE's console: sets up the scene, ready for O.run()

Results go to results/<scene>-<method>-<hash of the row>.h5, or to another folder with `--results=FOLDER`. A finished run is not run again.
Long runs of packings under walls and of the four flows write checkpoints (checkpoint.py) and resume from the last one. `--checkpoints=N` writes
one every N samples, 0 none; the result file records N. If another process runs the same row, this one waits for it.
Exit status: 0 done, 1 the run failed (its file says why) or could not be written, 2 the row cannot be run.
"""
import pathlib
import signal
import sys
import traceback

if __name__ == "__main__":
    file = sys._getframe().f_code.co_filename  # YADE sets no __file__
    sys.path.insert(0, str(pathlib.Path(file).resolve().parents[1]))
    from yade_scripts import commands
    commands.script("yade_scripts.run", file)

from yade_scripts import commands, parameters, results, scenes, tables
from yade_scripts.errors import ParameterError
from yade_scripts.results import provenance
from yade_scripts.running import locks, plausible


def start(folder=results.FOLDER, **row):
    """Build the scene of a row, ready for O.run(), without recording. Return the scenes.Scene."""
    return _watched(scenes.build(parameters.complete(row), folder))


def _watched(scene):
    """Let the scene in O end its run when it is no longer physical."""
    from yade import O

    import cd_engine
    from yade_scripts.running import hooks
    O.engines = O.engines + [cd_engine.watch(observers=hooks.OBSERVERS)]
    return scene


def execute(row, folder=results.FOLDER, checkpoint_samples=None):
    """Run a row to its end and write its file. Return the exit status. checkpoint_samples: None for the default of checkpoint.py."""
    full = plausible.Watched(parameters.complete(row))
    for doubt in plausible.doubts(dict(full)) + plausible.unread([full]):
        print(f"run: {doubt}.", file=sys.stderr)
    path = results.path_of(full, folder)
    results.make(folder)
    with locks.held(path, lambda: print(f"{path.stem}: another process runs this row: waiting for it", flush=True)):
        status, commit = results.ending(path)
        if status == results.STATUS_FINISHED:
            print(f"{path}: this run is already finished.")
            if doubt := provenance.doubt([commit]):
                print(f"run: it {doubt}", file=sys.stderr)
            return 0
        try:
            failure = _run(path, full, folder, checkpoint_samples)
        except OSError as error:
            print(f"{path.stem}: unfinished: {error}; {commands.cure(error)} and start it again.", file=sys.stderr)
            return 1
    if failure is None:
        print(f"{path.resolve()}: finished")
        return 0
    print(f"{path}: {results.status(path) or f'failed: {failure}'}", file=sys.stderr)
    if not isinstance(failure, RuntimeError):  # engines, preparation and checks raise RuntimeError; anything else is a bug
        traceback.print_exception(failure)
    return 1


def _run(path, full, folder, checkpoint_samples):
    """Build the scene, run it and record it. Return None or the exception that ended the run; the file names it, too."""
    from cd_engine import watching
    from yade_scripts.running import checkpoint, hooks, progress, recorder, wall_check
    scene, failure, collapse, show = scenes.Scene(every=1, samples=1), None, None, progress.Progress(path.stem)
    try:
        scene = _watched(scenes.build(full, folder))
    except (ParameterError, ImportError):
        raise
    except Exception as error:
        failure = error
    between = checkpoint.samples_between(dict(full), scene, checkpoint_samples)
    if checkpoint_samples and not between and failure is None:
        print("run: --checkpoints has no effect: " + ("this scene cannot be resumed." if scene.kept is None else "CD takes a sample in every step."),
              file=sys.stderr)
    checkpoints = checkpoint.Checkpoints(path, full, scene, between)
    found = checkpoints.found() if failure is None else None
    recorder = recorder.Recorder(path, full, scene, show, found and found[checkpoint.RECORD], checkpoints.every)
    if failure is None:
        scene.observer = recorder.sample
        try:
            if found:
                checkpoints.resume(found, recorder)
                print(f"{path.stem}: continues from its checkpoint at sample {recorder.count}", flush=True)
            try:
                scenes.method(full).run(scene, lambda steps: checkpoints.simulate(steps, recorder))
            except wall_check.Collapse as event:
                collapse = event
            watching.of_scene(hooks.OBSERVERS).check()
            recorder.measure()
        except Exception as error:
            failure = error
    show.close()
    for doubt in plausible.ignored(full) if failure is None else ():
        print(f"run: {doubt}.", file=sys.stderr)
    if isinstance(failure, OSError):
        raise failure
    for name, known in recorder.close(failure, collapse).items():
        print(f"{name}: {known}")
    if collapse:
        print(f"{path.stem}: collapsed: {collapse}")
    if failure is None or isinstance(failure, RuntimeError):  # a RuntimeError would come again; after anything else a new attempt can resume
        checkpoints.remove()
    return failure


@commands.command("run")
def main(arguments=None):
    parser = commands.parser(__doc__, "row", "--results")
    parser.add_argument("--checkpoints", type=commands.whole(0), metavar="N",
                        help="samples between two checkpoints, 0 for none (default: depends on the length of the run)")
    options = parser.parse_intermixed_args(arguments)
    return execute(tables.given(options.row), options.results, options.checkpoints)


def begin():
    """Let Ctrl-C end the program at once; else Python waits for the end of O.run."""
    if signal.getsignal(signal.SIGINT) == signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
