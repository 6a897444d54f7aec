"""Which method with which settings for an accuracy, its expected error and cost: from measured rows."""

from pathlib import Path

from analysis import load
from analysis.charts import choice, table
from yade_scripts.charts import records, settings

PUBLISHED = Path(__file__).resolve().parent.parent / "published" / "charts" / "work_precision.csv"


def rows(scene=None, results=load.RESULTS):
    """(rows, where they come from): of each scene the records of this machine if those are newer than the published table, else that."""
    if scene and scene not in settings.charted():
        raise load.ResultError(scene, "there is no such scene", f"there are {', '.join(settings.charted())}")
    since = PUBLISHED.stat().st_mtime if PUBLISHED.is_file() else 0
    newer = {name for name in settings.charted() if (path := records.path(name, results)).is_file() and path.stat().st_mtime > since}
    found = table.from_csv(PUBLISHED) if since else []
    sources = [str(PUBLISHED)] * bool(since)
    if newer:
        found = [row for row in found if row["scene"] not in newer] + [row for row in table.from_records(results, True)[0] if row["scene"] in newer]
        sources.append(f"{records.path(min(newer), results).parent} ({', '.join(sorted(newer))})")
    if not found:
        raise load.ResultError(PUBLISHED, "no such table", "measure the scenes: make charts")
    return found, " and ".join(sources)


def of_scene(scene, accuracy, found, source):
    """The lines of an answer for one scene. ResultError for a scene without measurements, or an accuracy that no setting reaches."""
    own = [row for row in table.one_size(found) if row["scene"] == scene]
    if not own:
        there = ", ".join(dict.fromkeys(row["scene"] for row in found))
        raise load.ResultError(scene, "no setting of this scene was measured", f"there are {there}; or measure it: "
                               f"/usr/bin/python3 yade_scripts/charts/run.py --full --only {scene}")
    best = {method: choice.cheapest([row for row in own if row["method"] == method], accuracy) for method in dict.fromkeys(row["method"] for row in own)}
    ordered = sorted((row for row in best.values() if row), key=lambda row: row["seconds"])
    if not ordered:
        error, row = choice.best_error(own)
        raise load.ResultError(scene, f"no measured setting reaches an accuracy of {accuracy:g}", f"the best is {error:.2g}, by {row['arguments']} "
                               f"in {row['seconds']:.2g} s" if row else "all settings failed")
    lines = [f"{scene}, accuracy {accuracy:g}: {ordered[0]['method']}"]
    lines += [_line(row, own) for row in ordered]
    for method, row in best.items():
        if row is None:
            error, nearest = choice.best_error([other for other in own if other["method"] == method])
            lines.append(f"  {method}: not reached; its best is " + (f"{error:.2g} in {nearest['seconds']:.2g} s ({nearest['setting']})" if nearest else "nothing: all failed"))
    script = "accuracy.py" if f"{settings.ACCURACY}=" in ordered[0]["arguments"] else "run.py"
    return lines + [f"Run it: yade -n -x yade_scripts/{script} {ordered[0]['arguments']}", f"Measured: {source}"]


def _line(row, rows_of_scene):
    confirmed = choice.finer(row, rows_of_scene)
    sure = f"{confirmed} finer settings agree" if confirmed > 1 else "one finer setting agrees" if confirmed else "the finest tried, so nothing confirms it"
    return f"  {row['method']}: {row['series']}, {row['setting']}: expected error {row['error']:.2g}, {row['seconds']:.2g} s for {row['steps']} steps of {row['disks']} disks ({sure})"


def by_kind(accuracy, found, source):
    """The lines of an answer for each kind of scene: one setting for all its scenes."""
    lines = []
    for kind, own in _kinds(found).items():
        chosen = choice.of_kind(own, accuracy)
        scenes = len({row["scene"] for row in own})
        lines.append(f"{kind} ({scenes} scene{'s' * (scenes > 1)}), accuracy {accuracy:g}: " + (_first(chosen) or "no setting reaches it"))
        for method, (series, solved, left) in chosen.items():
            times = [row["seconds"] for row in solved]
            lines.append(f"  {method}: {series}, {' '.join([*_fixed(solved[0]), _common(solved)])}: error up to {max(row['error'] for row in solved):.2g}, {_range(times)} s"
                         + (f"; not {', '.join(left)}" if left else ""))
    return lines + [f"Measured: {source}"]


def _kinds(found):
    kinds = {}
    for row in table.one_size(found):
        kinds.setdefault(row["kind"], []).append(row)
    return kinds


def _first(chosen):
    """The method to take: the one that solves more scenes, then the faster."""
    return min(chosen, key=lambda method: (len(chosen[method][2]), sum(row["seconds"] for row in chosen[method][1])), default="")


def _common(solved):
    """The setting, its value where that is the same in all scenes."""
    values = list(dict.fromkeys(row["setting"] for row in solved))
    return values[0] if len(values) == 1 else f"{values[0].split('=')[0]} " + " to ".join(
        f"{value:g}" for value in sorted({float(pick(values, key=lambda v: float(v.split('=')[1])).split("=")[1]) for pick in (min, max)}))


def _fixed(row):
    """What a setting has beside the value that its series varies: a law, a solver."""
    varied = (row["setting"].split("=")[0], "scene", "method", "disks")
    return [word for word in row["arguments"].split() if word.split("=")[0] not in varied]


def _range(times):
    low, high = (f"{pick(times):.2g}" for pick in (min, max))
    return low if low == high else f"{low} to {high}"


README_LEVELS = (1e-1, 1e-2, 1e-4)


def readme_table(found):
    """Markdown: for each kind of scene and accuracy the method to take, with which setting and time, and the other method's time."""
    lines = ["| scenes | " + " | ".join(f"to {level:g}" for level in README_LEVELS) + " |", "| --- |" + " --- |" * len(README_LEVELS)]
    for kind, own in _kinds(found).items():
        methods = dict.fromkeys(row["method"] for row in own)
        lines.append(f"| {kind} | " + " | ".join(_cell(choice.of_kind(own, level), methods) for level in README_LEVELS) + " |")
    return lines


def _cell(chosen, methods):
    """The method to take first."""
    if not chosen:
        return "not reached"
    said = []
    for method in sorted(methods, key=lambda name: name != _first(chosen)):
        if method not in chosen:
            said.append(f"{method}: not reached")
            continue
        _, solved, left = chosen[method]
        setting = f" `{' '.join([*_fixed(solved[0]), _common(solved)])}`" if not said else ""
        said.append(f"{method}{setting} {_range([row['seconds'] for row in solved])} s" + (f", not {', '.join(left)}" if left else ""))
    return "; ".join(said)
