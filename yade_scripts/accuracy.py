"""Runs CD to a given accuracy: refines time step and tolerance until the result no longer changes.

    yade -n -x yade_scripts/accuracy.py accuracy=1e-3 scene=slide_to_roll [name=value ...]

The first level runs the row at its own cd_dt with a tolerance of a hundredth of the accuracy and at most 1e-8. Each further level halves both.
The estimated error of a level is the larger of two numbers:
    the change of the measured quantities since the level before, over their scales; for loaded walls without such quantities the change of the
    final strains, so that accuracy=1e-5 means strains to 1e-5. The scheme is of first order, so the remaining error is about as large as the last
    change;
    the largest overlap, over the mean radius, since rigid disks should not overlap.
A level does not count if steps miss their tolerance, or if disks move by more than a radius in a step: then two coarse levels can agree although
both have missed an event. The first level within the accuracy is accepted if the level before it was within four times the accuracy, since a single
agreement can be chance. It is run once more to write its result file. All levels together cost about twice as much as the last.

There is no such estimate for MD, since a smaller step does not show the error due to the springs' stiffness. `analysis recommend` shows which
accuracy MD reaches.
"""
import math
import os
import pathlib
import sys
from dataclasses import dataclass

if __name__ == "__main__":
    file = sys._getframe().f_code.co_filename  # YADE sets no __file__
    sys.path.insert(0, str(pathlib.Path(file).resolve().parents[1]))
    from yade_scripts import commands
    commands.script("yade_scripts.accuracy", file)

from yade_scripts import commands, parameters, results, run, scenes
from yade_scripts.errors import ParameterError

STEP = 0.5               # factor on cd_dt and on the tolerance from one level to the next
SHARE = 0.01             # tolerance of the first level, over the accuracy
# Largest tolerance of the first level. With a looser one a packing creeps and yields too early; levels at 1e-3 and 1e-5 agree and are both wrong.
LOOSEST = 1e-8
SMALLEST = 1e-10         # smallest tolerance: some steps stagnate near 1e-9 to 1e-12
LEVELS = 12
TRIES = 3                # levels in a row with missed steps after which the search gives up: shorter steps do not help
MOTION = 1.0             # largest displacement of a disk in a step of a level that counts [radii]
BEFORE = 4               # largest error of the level before the accepted one, over the accuracy
LOW = 1e-8


class AccuracyError(RuntimeError):
    """No level reaches the accuracy. The message gives the error of the last level."""


@dataclass(frozen=True)
class Level:
    """One run of the search. row: its parameters. values: {name: measured number over its scale}. penetration: largest overlap [mean radii]. motion:
    largest displacement of a disk in a step [radii]. seconds: time of its steps. scene: the Scene, valid until the next one is built in O."""
    row: dict
    values: dict
    penetration: float
    motion: float
    missed_steps: int
    seconds: float
    scene: object = None


def refined(row, accuracy, level):
    tolerance = max(min(SHARE * accuracy, LOOSEST) * STEP**level, SMALLEST)
    return row | {"cd_dt": parameters.complete(row)["cd_dt"] * STEP**level, "tolerance": tolerance}


def estimate(coarse, fine):
    """Return the estimated error of the level `fine`, inf where it cannot be estimated. coarse: the level before it, or None."""
    if coarse is None or _untold(coarse) or _untold(fine):
        return math.inf
    errors = [fine.penetration, *(abs(value - coarse.values[name]) for name, value in fine.values.items())]
    return max(errors) if all(map(math.isfinite, errors)) else math.inf


def search(row, accuracy, run):
    """Run levels by run(row) -> Level up to the first within `accuracy`. Return [(Level, estimated error)]; raise AccuracyError if none is."""
    found = []
    for level in range(LEVELS):
        found.append((fine := run(refined(row, accuracy, level)), estimate(found[-1][0] if found else None, fine)))
        if found[-1][1] <= accuracy and found[-2][1] <= BEFORE * accuracy:
            return found
        if len(found) >= TRIES and all(fine.missed_steps for fine, _ in found[-TRIES:]):
            break
    last, error = found[-1]
    why = _untold(last) or f"its error is about {error:.2g}"
    raise AccuracyError(f"accuracy = {accuracy:g} is not reached at cd_dt = {last.row['cd_dt']:g} s, tolerance = {last.row['tolerance']:g}: "
                        f"{why}; ask for a larger error, or measure a quantity that is less sensitive to details of the motion")


def _untold(level):
    """Return why the error of a level cannot be estimated, '' if it can."""
    if level.missed_steps:
        return f"{level.missed_steps} steps miss their tolerance"
    return f"disks move {level.motion:.2g} radii a step" if level.motion > MOTION else ""


def check(row, accuracy):
    """Raise ParameterError if this accuracy cannot be asked for in this row."""
    full = parameters.complete(row)
    if parameters.has_springs(full) or full["fixed_iterations"]:
        raise ParameterError("accuracy: only for method = CD with rigid contacts and a tolerance; springs have an error due to their stiffness, "
                             "which a smaller step does not show")
    if "tolerance" in row:
        raise ParameterError(f"tolerance = {row['tolerance']}: the search for an accuracy chooses it, so leave it out")
    if not (isinstance(accuracy, float) and LOW <= accuracy < 1):
        raise ParameterError(f"accuracy = {accuracy!r}: must be a number in [{LOW:g}, 1), a relative error, or that of a strain")


def run_in_yade(folder):
    """Return a run(row) -> Level for `search`; `folder` holds the prepared packings."""
    from yade import O
    from yade_scripts.running import bodies, hooks, timing, walls

    def run(row):
        full, moved = parameters.complete(row), [0.0]
        scene = scenes.build(full, folder)
        sides = walls.sides() if scene.load else None
        if not scene.known and not scene.load:
            raise ParameterError(f"scene = {full['scene']}: with these parameters no quantity of it has a known value, so no "
                                 "accuracy can be asked for")
        disks = bodies.disks()

        def look():
            moved[0] = max(moved[0], max(b.state.vel.norm() * O.dt / b.shape.radius for b in disks))
        seconds = timing.run(scene, full, hooks.runner(look, iterPeriod=max(1, scene.every * scene.samples // 20), initRun=True))
        look()  # the last step, too
        engine = hooks.engine("ContactDynamics")
        values = {known.name: known.measure() / known.scale for known in scene.known}
        if not values:
            values = {f"strain{k}": now / before - 1 for k, (now, before) in enumerate(zip(walls.sides(), sides), 1)}
            if not any(values.values()):
                raise ParameterError(f"scene = {full['scene']}: its walls do not move, so no accuracy can be asked for")
        return Level(row, values, engine.maxPenetration / full["radius_mean"], moved[0], engine.unconvergedSteps, seconds, scene)
    return run


@commands.command("accuracy")
def main(arguments=None):
    """Run the command line: accuracy=..., then name=value as for run.py. Return the exit status."""
    options = commands.parser(__doc__, "row", "--results").parse_args(arguments)
    if os.environ.get("YADE_BATCH"):
        raise ParameterError("the table of yade-batch cannot give an accuracy: start each search by yade -n -x yade_scripts/accuracy.py accuracy=...")
    asked = [argument for argument in options.row if argument.startswith("accuracy=")]
    if len(asked) > 1:
        raise ParameterError("accuracy is given twice")
    row = {"method": "CD"} | parameters.from_arguments([argument for argument in options.row if argument not in asked])
    try:
        accuracy = float(asked[-1].partition("=")[2])
    except (IndexError, ValueError):
        raise ParameterError("accuracy=...: an error such as accuracy=1e-3 has to be given, relative to the scale of a known "
                             "quantity; in the biaxial box that of a strain") from None
    check(row, accuracy)
    results.make(options.results)
    try:
        levels = search(row, accuracy, run_in_yade(options.results))
    except RuntimeError as error:
        print(f"accuracy: {error}", file=sys.stderr)
        return 1
    what = "error" if levels[-1][0].scene.known else "absolute error of the strains"
    for level, error in levels:
        print(f"cd_dt = {level.row['cd_dt']:g} s, tolerance = {level.row['tolerance']:g}: " + (
            f"estimated {what} {error:.2g}" if error < math.inf else _untold(level) or "the first level") + f", {level.seconds:.3g} s")
    return run.execute(levels[-1][0].row, options.results)
