"""Publishes all charts from the measurements."""
from pathlib import Path

import pandas

from analysis import charts, publish
from analysis.charts import maps, table
from yade_scripts.errors import ResultError
from yade_scripts.results import provenance


def publish_all(results, folder, full, broken, beside=None):
    """Publish every chart that has measurements. Return {name: message} of those that have none. broken: as of declared.readable, of scenes and maps.

    beside: folder of published charts; what was measured is added to them, or takes the place of the same settings and maps there.
    """
    folder, left = Path(folder), {}
    folder.mkdir(parents=True, exist_ok=True)
    for names, source in ((charts.ORDER[:-1], table), (charts.ORDER[-1:], maps)):
        try:
            measured, origin = source.measured(results, full, broken)
        except ResultError as error:
            left |= {name: f"{name}: {error}" for name in names}
            continue
        if beside:
            origin |= _united(origin, publish.read_json(Path(beside) / f"{names[0]}.json", {"commits": list, "measured": int, "processor": str}))
            if source is table:
                measured = _added(table.from_csv(Path(beside) / "work_precision.csv"), measured)
                origin["measured"] = measured.name.nunique()  # the new ones may have taken the place of old ones
        line = f"{origin['measured']} measurements, {provenance.words(origin['commits'])}, {origin['processor']}"
        for name in names:
            chart = charts.module(name)
            if len(rows := chart.rows(measured)):
                figures = chart.draw(measured if name == "maps" else rows, folder, line)
                if beside and name == "maps":
                    rows, figures = _beside_maps(rows, figures, Path(beside))
                publish.write_table(folder / f"{name}.csv", rows)
                publish.write_json(folder / f"{name}.json", {"chart": name, "figures": figures} | origin)
            else:
                left[name] = f"{name}: {chart.LACKING}"
    return left


def _united(origin, other):
    processors = dict.fromkeys(", ".join((other["processor"], origin["processor"])).split(", "))
    return {"commits": sorted({*origin["commits"], *other["commits"]}), "measured": origin["measured"] + other["measured"],
            "processor": ", ".join(processors)}


def _added(old, new):
    """Return the rows of both tables of settings; of one that both have the new one. Scenes stay together."""
    kept = old[~old.set_index(["name", "series"]).index.isin(new.set_index(["name", "series"]).index)]
    both = pandas.concat([kept, new], ignore_index=True)
    order = {scene: place for place, scene in enumerate(both.scene.unique())}
    return both.sort_values("scene", key=lambda scenes: scenes.map(order), kind="stable", ignore_index=True)


def _beside_maps(rows, figures, folder):
    """Return the boundaries and figures of the published maps in `folder` and of these, which take the place of the same ones."""
    old = publish.read_table(folder / "maps.csv")
    kept = old[~old["map"].isin({row["map"] for row in rows})]
    drawn = publish.read_json(folder / "maps.json", {"figures": dict})["figures"]
    return pandas.concat([kept, pandas.DataFrame(rows)], ignore_index=True), drawn | figures
