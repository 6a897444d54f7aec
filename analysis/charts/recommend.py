"""Which method with which settings for an accuracy, its expected error and cost: from the published measurements."""

from analysis.charts import choice, table
from yade_scripts.measuring import charts as settings
from yade_scripts.results.reader import ResultError


def of_scene(scene, accuracy):
    """Return the lines of an answer for one scene. ResultError for a scene without measurements, or an accuracy that no setting reaches."""
    found = table.one_size(table.from_csv(table.PUBLISHED))
    own = [row for row in found if row["scene"] == scene]
    if not own:
        raise ResultError(scene, "no setting of this scene was measured", f"there are {', '.join(dict.fromkeys(row['scene'] for row in found))}")
    best = {method: choice.cheapest([row for row in own if row["method"] == method], accuracy) for method in dict.fromkeys(row["method"] for row in own)}
    ordered = sorted((row for row in best.values() if row), key=lambda row: row["seconds"])
    if not ordered:
        error, row = choice.best_error(own)
        raise ResultError(scene, f"no measured setting reaches an accuracy of {accuracy:g}",
                          f"the best is {error:.2g}, by {row['arguments']} in {row['seconds']:.2g} s" if row else "all settings failed")
    lines = [f"{scene}, accuracy {accuracy:g}: {ordered[0]['method']}"] + [_line(row, own) for row in ordered]
    for method, row in best.items():
        if row is None:
            error, nearest = choice.best_error([other for other in own if other["method"] == method])
            lines.append(f"  {method}: not reached; its best is " + (f"{error:.2g} in {nearest['seconds']:.2g} s ({nearest['setting']})" if nearest else "nothing: all failed"))
    script = "accuracy.py" if f"{settings.ACCURACY}=" in ordered[0]["arguments"] else "run.py"
    return lines + [f"Run it: yade -n -x yade_scripts/{script} {ordered[0]['arguments']}"]


def _line(row, rows_of_scene):
    confirmed = choice.finer(row, rows_of_scene)
    sure = f"{confirmed} finer settings agree" if confirmed > 1 else "one finer setting agrees" if confirmed else "the finest that was tried, so nothing confirms it"
    return f"  {row['method']}: {row['series']}, {row['setting']}: expected error {row['error']:.2g}, {row['seconds']:.2g} s for {row['steps']:.0f} steps of {row['disks']:.0f} disks ({sure})"


def by_kind(accuracy):
    """Return the lines of an answer for each kind of scene: one setting for all its scenes."""
    kinds, lines = {}, []
    for row in table.one_size(table.from_csv(table.PUBLISHED)):
        kinds.setdefault(row["kind"], []).append(row)
    for kind, own in kinds.items():
        chosen = choice.of_kind(own, accuracy)
        first = min(chosen, key=lambda method: (len(chosen[method][2]), sum(row["seconds"] for row in chosen[method][1])), default="no setting reaches it")
        lines.append(f"{kind} ({len({row['scene'] for row in own})} scenes), accuracy {accuracy:g}: {first}")
        for method, (series, solved, left) in chosen.items():
            values, times = dict.fromkeys(row["setting"] for row in solved), [row["seconds"] for row in solved]
            lines.append(f"  {method}: {series}, {' or '.join(values)}: error up to {max(row['error'] for row in solved):.2g}, {min(times):.2g} to {max(times):.2g} s"
                         + (f"; not {', '.join(left)}" if left else ""))
    return lines
