"""Rows whose springs fail end as unstable, with the step that would do; so do measurements of charts."""
import re

import pytest

from yade_scripts import parameters, results
from yade_scripts.results import reader

SOFT = dict(method="MD", kn=5e6, disks=200)


@pytest.mark.parametrize("row, words", [
    (dict(scene="drum", md_dt_factor=0.8), "."),
    (dict(scene="drum", md_dt_factor=0.6), "alternates from step to step"),  # its slope is off by a fifth
    (dict(scene="filling", md_dt_factor=0.8), "."),
    (dict(scene="biaxial", kn=2e6, disks=60, md_dt_factor=1.0, beta_n=0.5), "."),
    (dict(scene="biaxial", kn=2e6, disks=60, md_walls="force", wall_mass_ratio=0.05, md_dt_factor=1.0), "."),
    (dict(scene="stack", kn=2e6, disks=5, md_dt_factor=1.0, beta_n=0.5), ".")])
def test_rows_beyond_the_limit_end_as_unstable(yade60, row, words):
    row = SOFT | row
    done = yade60.script("run.py", *(f"{name}={value}" for name, value in row.items()))
    path = results.path_of(parameters.complete(row), yade60.folder / "results")
    run = reader.load(path, finished=False)
    assert done.returncode == 1 and ": unstable: step " in done.stderr and "Traceback" not in done.stderr
    assert not run.finished and results.has_failed(results.status(path))
    status = run.attributes["status"]
    assert status.startswith("unstable: step ")
    assert re.search(words, status)
    name, would_do = re.fullmatch(r"unstable: (md_dt_factor) = [\d.]+ is too long, ([\d.]+) would do", run.outcome).groups()
    assert 0.03 < float(would_do) < row[name]


def test_the_step_that_would_do_does(yade60):
    """With strong tangential dashpots, too, which lower the limit."""
    row = dict(method="MD", disks=60, tangential_damping=2.0, beta_n=0.5, loading="cosine", period=1.0, records_per_cycle=50)
    yade60.script("run.py", *(f"{name}={value}" for name, value in row.items()))
    outcome = reader.load(results.path_of(parameters.complete(row), yade60.folder / "results"), finished=False).outcome
    would_do, = re.findall(r"md_dt_factor = 0.2 is too long, ([\d.]+) would do", outcome)
    assert yade60.load(**row | {"md_dt_factor": float(would_do)}).finished


def test_a_step_below_the_limit_finishes(yade60):
    """With weaker dashpots the limit of the contacts is above 0.6."""
    assert yade60.load(**SOFT | dict(scene="drum", md_dt_factor=0.6, beta_n=0.2, period=1.0)).finished


def test_a_measurement_of_a_chart_is_watched(yade60):
    facts = yade60.code("""
from yade_scripts.measuring.charts import measure
row = dict(scene="filling", method="MD", kn=5e6, md_dt_factor=0.8)
print(json.dumps(measure.measure(row, "results", 20, lambda seconds: None)[0]))
""")
    assert facts["status"].startswith("unstable: step ")
