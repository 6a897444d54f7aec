"""Stability maps from rows made up here: boundaries, words and files, nothing run."""
import csv
import json

import pytest

from analysis.charts import maps as charts
from analysis.charts import maps_md, maps_walls
from analysis.load import ResultError
from yade_scripts import maps, spring_limits
from yade_scripts.maps import INACCURATE, STABLE, UNSTABLE, Outcome, search, store


def fill(folder, told="", leave_out=0):
    """Rows of md_contact as its theory has it: unstable above the limit, inaccurate above half of it; the last cells left out."""
    kept = store.Store("md_contact", folder / "maps")
    chart = maps.get("md_contact")

    def probe(case):
        known = kept.outcome(case)
        if known is None:
            limit = spring_limits.contact_limit(case["beta_n"], case["kt_over_kn"])
            known = (Outcome(UNSTABLE, "energy growth", told) if case["omega_dt"] > limit
                     else Outcome(INACCURATE, "wrong motion") if case["omega_dt"] > limit / 2 else Outcome(STABLE))
            kept.add(case, known, commit="abc", yade="2023.02a", seconds=0.5)
        return known

    cells = chart.grid(False)
    for case in cells[:len(cells) - leave_out]:
        probe(case)
    for line in chart.searches(False):
        search.bisect(line, probe)
    return cells


def test_boundaries_are_found_again_from_the_rows_alone(tmp_path):
    """Instability where theory has it, to the search's precision of 3 %; the first failure at half of it."""
    fill(tmp_path)
    found = charts.collect("md_contact", tmp_path, False)
    assert not found.missing
    rows = charts.boundary_rows(found)
    assert {row["from"] for row in rows} == {"instability", "first failure"}
    for row in rows:
        assert row["boundary"] == pytest.approx(row["theory"] * (1 if row["from"] == "instability" else 0.5), rel=0.03)


def test_the_answer_counts_and_names_what_is_silent(tmp_path):
    cells = fill(tmp_path)
    found = charts.collect("md_contact", tmp_path, False)
    text = charts.answer(found)
    unstable = sum(row["verdict"] == UNSTABLE for row in found.rows)
    assert f"of {len(cells)} cells" in text and f"{unstable} (energy growth)" in text and "within" in text
    elsewhere = tmp_path / "told"
    fill(elsewhere, told="an error")
    assert "(energy growth)" not in charts.answer(charts.collect("md_contact", elsewhere, False))


def test_files_of_a_group_name_what_was_not_run(tmp_path):
    """A map without any row is left out; missing cells are rows with a status, and counted."""
    fill(tmp_path, leave_out=3)
    maps_md.publish(tmp_path, tmp_path / "figures", False)
    found = json.loads((tmp_path / "figures" / "maps_md.json").read_text())
    assert [figure["file"] for figure in found["figures"]] == ["map_md_contact.png"] and (tmp_path / "figures" / "map_md_contact.png").stat().st_size > 10000
    assert found["runs_missing"] == 3 and found["commits"] == ["abc"]
    with open(tmp_path / "figures" / "maps_md.csv", newline="") as file:
        assert sum(row["status"] == charts.NOT_RUN for row in csv.DictReader(file)) == 3


def test_no_rows_is_said(tmp_path):
    with pytest.raises(ResultError, match="make charts"):
        maps_walls.publish(tmp_path, tmp_path, False)
