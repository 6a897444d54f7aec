"""What is committed in analysis/published: complete, regenerated from result files where they are there, and one cheap study run anew."""

import html
import json
import os
import re
import subprocess

import pytest

from analysis import load, publish, studies
from yade_scripts import parameters, results, tables

FOLDER = load.RESULTS.parent / "analysis" / "published"
PUBLISHED = sorted(path.stem for path in FOLDER.glob("*.json"))
# Floats that a row run anew must give: path of two disks led by prescribed motions, the same in every run. Another compiler or
# processor changes the last digits only; 1e-9 of the largest force is a thousand times the round-off of 1e4 steps.
ANEW, TOLERANCE = "closed_path", 1e-9

pytestmark = pytest.mark.skipif(not PUBLISHED, reason="no study has been published yet")


def said(name):
    """The provenance and findings of a published study."""
    return json.loads((FOLDER / f"{name}.json").read_text())


def test_every_study_is_published():
    assert PUBLISHED == sorted(studies.names())


def test_the_page_of_the_committed_run_is_one_command(root, tmp_path):
    page = tmp_path / "new" / "report.html"
    subprocess.run(["make", "report", "PUBLISHED=1", f"REPORT={page}"], cwd=root, check=True, capture_output=True, timeout=300)
    text = html.unescape(page.read_text())
    assert "Not run yet" not in text and all(studies.module(name).TITLE in text for name in PUBLISHED)


@pytest.mark.parametrize("name", PUBLISHED)
def test_files_are_complete(name):
    found = said(name)
    headings, rows = publish.read_csv(FOLDER / f"{name}.csv")
    assert (FOLDER / f"{name}.png").read_bytes().startswith(b"\x89PNG")
    assert rows and all(None not in row and None not in row.values() for row in rows)
    assert found["study"] == name and found["extent"] == "full" and found["title"] == studies.module(name).TITLE
    assert all(found[key] for key in ("question", "answer", "headline", "yade", "python", "processor", "run_command", "figure_command"))
    # Nothing is published of a tree with changes that no commit holds.
    assert found["commits"] and all(re.fullmatch("[0-9a-f]{40}", commit) for commit in found["commits"])
    failed = [row for row in rows if row.get(publish.STATUS)]
    assert len(failed) == found["runs_failed"] + found["runs_missing"]


@pytest.mark.parametrize("name", PUBLISHED)
def test_the_tables_are_those_that_were_run(name):
    found = said(name)
    assert found["tables"] == [f"yade_scripts/tables/{table}" for table in studies.module(name).TABLES["full"]]
    rows = {results.path_of(parameters.complete(row)) for table in found["tables"] for row in tables.read(load.RESULTS.parent / table).values()}
    assert len(rows) == found["runs_finished"] + found["runs_failed"] + found["runs_missing"]


@pytest.mark.parametrize("name", PUBLISHED)
def test_summary_regenerates_from_the_result_files(name, tmp_path):
    collection = studies.collect(name, load.RESULTS, full=True)
    found = said(name)
    if len(collection.runs) != found["runs_finished"] or collection.commits != found["commits"]:
        pytest.skip(f"{len(collection.runs)} of its {found['runs_finished']} result files are here, or they are of other commits")
    stem = publish.publish(collection, tmp_path)
    assert stem.with_suffix(".csv").read_text() == (FOLDER / f"{name}.csv").read_text()
    assert json.loads(stem.with_suffix(".json").read_text())["answer"] == found["answer"]


def _cheapest_rows():
    """Of each tangential law the row of the study with the shortest path in time."""
    rows = {}
    for table in studies.module(ANEW).TABLES["full"]:
        for row in tables.read(studies.TABLES / table).values():
            full = parameters.complete(row)
            kept = rows.setdefault(full["tangential_law"], row)
            if full["period"] < parameters.complete(kept)["period"]:
                rows[full["tangential_law"]] = row
    return rows


@pytest.mark.parametrize("law", ("standard", "avoid_ratcheting", "path_independent"))
def test_a_row_run_anew_gives_the_published_numbers(law, root, tmp_path):
    row = _cheapest_rows()[law]
    arguments = [f"--results={tmp_path}"] + [f"{name}={value}" for name, value in row.items()]
    done = subprocess.run(["yade", "-n", "-x", "-j", "1", "yade_scripts/run.py", *arguments], cwd=root, capture_output=True, text=True, timeout=120,
                          env=os.environ | {"OMP_NUM_THREADS": "1"})
    run = load.load(results.path_of(parameters.complete(row), tmp_path))
    fresh, = studies.module(ANEW).summarize([run])
    _, published = publish.read_csv(FOLDER / f"{ANEW}.csv")
    keys = ("law", "path_depth", "path_angle", "period_s")
    old, = (other for other in published if all(other[key] == publish.text(fresh[key]) for key in keys))
    for name, value in fresh.items():
        if isinstance(value, float):
            assert float(old[name]) == pytest.approx(value, abs=TOLERANCE), f"{name}\n{done.stderr}"
