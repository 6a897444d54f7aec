"""Recommends a method and settings for an accuracy, with expected error and cost, from measurements: the published ones, or one's own.

measured: a table that `charts` has written, work_precision.csv.
"""
from pathlib import Path

from analysis import flow_costs, publish
from analysis.charts import choice, table
from yade_scripts import scenes
from yade_scripts.measuring import store
from yade_scripts.errors import ResultError

FLOWS = ("flows", "larger_flows")  # studies with a table of flows


def of_scene(scene, accuracy, measured):
    """Return the lines of an answer for one scene. Raise ResultError for a scene without measurements, or if no setting reaches the accuracy."""
    if scene in flow_costs.QUANTITY:  # means over seeds; a chart has one run a setting, which does not determine its error
        if Path(measured).resolve() != table.PUBLISHED.resolve():
            raise ResultError(scene, "a single run of a flow does not determine its error", "ask without --measured: the studies of flows have means")
        return of_flow(scene, accuracy)
    found = table.one_size(table.from_csv(measured))
    own = found[found.scene == scene]
    if own.empty:
        if scene not in scenes.names():
            there = "there is no such scene"
        else:
            there = f"no measurement of this scene in {measured}" if scenes.module(scene).CHART else "this scene has no known value to compare with"
        raise ResultError(scene, there, f"measured are {', '.join(sorted({*found.scene} | flow_costs.QUANTITY.keys()))}; for measurements of your "
                          "own: --measured figures/quick/charts/work_precision.csv")
    lines, reached = [], []
    for method, rows in own.groupby("method", sort=False):
        if (row := choice.cheapest(rows, accuracy)) is not None:
            reached.append(row)
        else:
            row = choice.best(rows)
            best = "nothing: all failed" if row is None else f"{row.error:.2g} in {row.seconds:.2g} s ({row.setting})"
            lines.append(f"  {method}: not reached; its best is {best}")
    if not reached:
        row = choice.best(own)
        raise ResultError(scene, f"no measured setting reaches an accuracy of {accuracy:g}", "all settings failed" if row is None else
                          f"the best is {row.error:.2g}, by {row.arguments} in {row.seconds:.2g} s")
    first, *_ = reached = sorted(reached, key=lambda row: row.seconds)
    script = "accuracy.py" if f"{store.ACCURACY}=" in first.arguments else "run.py"
    return [f"{scene}: {first.method} is recommended for an accuracy of {accuracy:g}", *(_line(row, own) for row in reached), *lines,
            f"Run it: yade -n -x yade_scripts/{script} {first.arguments}"]


def of_flow(scene, accuracy):
    """Return the same for a scene of the studies of flows, where the error is that of a mean over seeds."""
    folder = Path(__file__).resolve().parents[1] / "published"
    tables = [flow_costs.measured(publish.read_table(folder / f"{name}.csv")) for name in FLOWS]
    rows = [row for own in tables for row in own[own.scene == scene].to_dict("records")]
    if not any(abs(row["error"]) <= accuracy and not row["is_rigid_answer"] for row in rows):
        raise ResultError(scene, f"no measured setting reaches an accuracy of {accuracy:g}", "see analysis/published/flows.csv")
    lines = []
    for disks in sorted({row["disks"] for row in rows}):
        own = [row for row in rows if row["disks"] == disks and not row["is_rigid_answer"]]
        cheapest = [flow_costs.cheapest(own, scene, disks, kind, accuracy) for kind in flow_costs.KINDS]
        best = sorted((row for row in cheapest if row and row in flow_costs.reaching(own, scene, disks, row["kind"], accuracy)),
                      key=lambda row: row["seconds"])
        first = f"{best[0]['kind']} are recommended" if best else "no setting that was tried suffices"
        lines.append(f"{scene}, {disks:.0f} disks: {first} for an accuracy of {accuracy:g} of the {flow_costs.QUANTITY[scene]}")
        for row in best:
            set_by = flow_costs.arguments(row)
            spread = f"standard error {100 * row['error_deviation']:.1f} %, {row['seeds']:.0f} seeds" if row["seeds"] > 1 else "one seed"
            sure = "" if abs(row["error"]) + row["error_deviation"] <= accuracy else "; whether it is within the accuracy is not certain"
            lines.append(f"  {row['kind']}, {set_by}: off by {100 * row['error']:.1f} % ({spread}{sure}), {row['seconds']:.3g} s a run")
            if row is best[0]:
                run = f"Run it: yade -n -x yade_scripts/run.py scene={scene} method={row['method']} disks={row['disks']:.0f} seed=1 {set_by}"
        lines += [f"  {row['kind']}: not reached; the nearest is off by {100 * row['error']:.1f} %, {row['seconds']:.3g} s a run"
                  + ", but finer settings do not confirm it" * (abs(row["error"]) <= accuracy)
                  for row in cheapest if row and row not in best] + ([run] if best else [])
    return lines


def _line(row, rows_of_scene):
    confirmed, which = choice.confirming(row, rows_of_scene)
    sure = f"confirmed by {'one' if confirmed == 1 else confirmed} {which} setting{'s' * (confirmed > 1)}" if confirmed \
        else f"not confirmed: no {which} setting has finished"
    # Disks whose motion is prescribed are not counted.
    size = f" of {row.disks:.0f} disk{'' if row.disks == 1 else 's'}" if row.disks > 0 else ""
    return (f"  {row.method}: {row.series}, {row.setting}: expected error {row.error:.2g}, {row.seconds:.2g} s for {row.steps:.0f} steps{size} "
            f"({sure})")


def by_kind(accuracy, measured):
    """Return the lines of an answer for each kind of scene: one setting for all its scenes."""
    lines = []
    for kind, own in table.one_size(table.from_csv(measured)).groupby("kind", sort=False):
        if kind == "flow":
            lines.append("flow: a single run of a flow does not determine its error. Ask for one scene: --scene "
                         + " or ".join(sorted(flow_costs.QUANTITY)))
            continue
        chosen, count = choice.of_kind(own, accuracy), own.scene.nunique()
        best_first = sorted(chosen, key=lambda method: (len(chosen[method][2]), chosen[method][1].seconds.sum()))
        first = f"{best_first[0]} is recommended" if best_first else "no setting that was tried suffices"
        lines.append(f"{kind} ({count} scene{'s' * (count > 1)}): {first} for an accuracy of {accuracy:g}")
        for method in best_first:
            series, solved, left = chosen[method]
            times = dict.fromkeys(f"{seconds:.2g}" for seconds in (solved.seconds.min(), solved.seconds.max()))
            lines.append(f"  {method}: {series}, {' or '.join(solved.setting.unique())}: error up to {solved.error.max():.2g}, "
                         f"{' to '.join(times)} s" + (f"; not reached in {', '.join(left)}" if left else ""))
    if not lines:
        raise ResultError(measured, "holds no measurement", "make it by `make charts`")
    return lines
