"""Rows of the published studies, drawn at random, run anew: the engine of today gives the published numbers."""
import math
import random

import pytest

from analysis import publish, studies, summary
from tests.analysis.test_published import FOLDER
from yade_scripts import batch, results
from yade_scripts.results import provenance, reader

# Studies with a table row for each run, or for the runs that have these parameters in common. The other tables have means over all seeds.
TOGETHER = {"fig3": (), "fig4": (), "fig5": (), "collapse": (), "ratcheting": (), "indeterminacy": (),
            "critical_load": ("preparation_friction", "seed"),
            "isostatic": ("friction", "preparation_friction", "stiffening", "delta_sigma", "seed"), "size": ("disks", "seed"),
            "laws": ("pressure_ratio", "stiffening", "period", "cycles", "delta_sigma", "seed")}
MOST = 1.5e8  # disks times steps of the rows of one draw, those of CD counted tenfold: some ten minutes
SAME = 1e-9   # relative difference; a run that differs in one last bit differs far more at its end, while tables keep all digits


def cost(row):
    time = row["disks"] * row["period"] * row["cycles"]
    return 10 * time / row["cd_dt"] if row["method"] == "CD" else time / (3e-4 * row["md_dt_factor"])


def differences(fresh, old):
    """The columns in which a row of a table and a published one differ, but for computing times and for numbers that a study computes for some of
    its runs only, the first one of a group."""
    def same(new, known):
        if isinstance(new, str) or new is None:
            return str(new or "") == ("" if known != known else str(known))
        return math.isclose(new, float(known), rel_tol=SAME) or math.isnan(float(known))
    return [name for name, value in fresh.items() if "seconds" not in name and not (name in old and same(value, old[name]))]


@pytest.mark.parametrize("name", TOGETHER)
def test_rows_run_anew_give_the_published_numbers(name, tmp_path):
    """Another commit draws other rows."""
    rows = [row for row in studies.rows(name, True) if cost(row) < MOST]
    groups = summary.groups(rows, lambda row: tuple(row[key] for key in TOGETHER[name]) or row["method"])
    draw = random.Random(provenance.git_commit())
    drawn = [[draw.choice(group)] for group in groups.values()] if not TOGETHER[name] else \
        [draw.choice([group for group in groups.values() if sum(map(cost, group)) < 3 * MOST])]
    assert batch.work_off(batch.jobs_of([row for group in drawn for row in group], tmp_path), 2) == []
    table = publish.finished(publish.read_table(FOLDER / f"{name}.csv")).to_dict("records")
    for group in drawn:
        for fresh in studies.module(name).summarize([reader.load(results.path_of(row, tmp_path)) for row in group]):
            nearest = min((differences(fresh, old) for old in table), key=len)
            assert nearest == [], f"{name}, {fresh}"
