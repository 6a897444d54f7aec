"""Publishes all charts from the measurements."""
from pathlib import Path

from analysis import charts, publish
from analysis.charts import maps, table
from yade_scripts.errors import ResultError
from yade_scripts.results import provenance


def publish_all(results, folder, full, broken):
    """Publish every chart that has measurements. Return {name: message} of those that have none. broken: as of declared.readable, of scenes and maps.
    """
    folder, left = Path(folder), {}
    folder.mkdir(parents=True, exist_ok=True)
    for names, source in ((charts.ORDER[:-1], table), (charts.ORDER[-1:], maps)):
        try:
            measured, origin = source.measured(results, full, broken)
        except ResultError as error:
            left |= {name: f"{name}: {error}" for name in names}
            continue
        line = f"{origin['measured']} measurements, {provenance.words(origin['commits'])}, {origin['processor']}"
        for name in names:
            chart = charts.module(name)
            if len(rows := chart.rows(measured)):
                figures = chart.draw(measured if name == "maps" else rows, folder, line)
                publish.write_table(folder / f"{name}.csv", rows)
                publish.write_json(folder / f"{name}.json", {"chart": name, "figures": figures} | origin)
            else:
                left[name] = f"{name}: {chart.LACKING}"
    return left
