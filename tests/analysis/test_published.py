"""What is committed in analysis/published: complete, with the numbers of its text, and one cheap study run anew. tests/soak asks that nothing lacks there."""

import html
import json
import os
import re
import subprocess

import pytest

from analysis import charts, publish, report, studies
from yade_scripts.results import reader
from tests import numbers
from yade_scripts import parameters, results

FOLDER = reader.RESULTS.parent / "analysis" / "published"
PUBLISHED = sorted(path.stem for path in FOLDER.glob("*.json"))
# Floats that a row run anew must give: path of two disks led by prescribed motions, the same in every run. Another compiler or
# processor changes the last digits only; 1e-9 of the largest force is a thousand times the round-off of 1e4 steps.
ANEW, TOLERANCE = "closed_path", 1e-9


def said(name):
    """The provenance and findings of a published study."""
    return json.loads((FOLDER / f"{name}.json").read_text())


def test_the_page_of_the_committed_run_is_one_command(root, tmp_path):
    page = tmp_path / "new" / "report.html"
    subprocess.run(["make", "report", "PUBLISHED=1", f"REPORT={page}"], cwd=root, check=True, capture_output=True, timeout=1200)
    text = html.unescape(page.read_text())
    absent = "; ".join(studies.module(name).TITLE for name in studies.names() if name not in PUBLISHED)  # while they are being written
    assert text.count("Not run yet") == (f"Not run yet: {absent}." in text) == bool(absent)
    assert all(studies.module(name).TITLE in text for name in PUBLISHED)
    assert page.stat().st_size < 2e6


@pytest.mark.parametrize("name", PUBLISHED)
def test_files_are_complete(name):
    found, table = said(name), publish.read_table(FOLDER / f"{name}.csv")
    assert (FOLDER / f"{name}.png").read_bytes().startswith(b"\x89PNG")
    assert found["study"] == name and found["extent"] == "full" and len(table)
    assert all(found[key] for key in ("yade", "python", "processor", "run_command"))
    # Nothing is published of a tree with changes that no commit holds.
    assert found["commits"] and all(re.fullmatch("[0-9a-f]{40}", commit) for commit in found["commits"])
    failed = table[publish.STATUS].notna().sum() if publish.STATUS in table else 0
    assert failed == found["runs_failed"] + found["runs_missing"]
    assert len(studies.rows(name, True)) == found["runs_finished"] + failed


@pytest.mark.parametrize("name", PUBLISHED)
def test_every_number_of_the_text_stands_in_the_published_table(name):
    study = studies.module(name)
    assert study.ANSWER
    text = study.ANSWER + " ".join(measured for *_, measured in study.POINTS)
    assert numbers.wrong(text, study.numbers(publish.read_table(FOLDER / f"{name}.csv")), study.GIVEN) == []


@pytest.mark.parametrize("name", charts.ORDER)
def test_every_number_about_a_chart_stands_in_its_table(name):
    chart, folder = charts.module(name), FOLDER / charts.FOLDER
    found = json.loads((folder / f"{name}.json").read_text())
    assert all((folder / file).is_file() for file in found["figures"])
    assert numbers.wrong(chart.ANSWER, chart.numbers(publish.read_table(folder / f"{name}.csv")), chart.GIVEN) == []


def test_the_short_answer_has_the_numbers_of_the_studies():
    """README and the page say the same, with numbers that the studies' own texts have and that are tested there."""
    readme = (FOLDER.parents[1] / "README.md").read_text(encoding="utf-8")
    for name, text in report.FINDINGS:
        study = studies.module(name)
        assert text in " ".join(readme.split())
        missing = [number for number in numbers.written(text) if number not in numbers.written(study.ANSWER) and number not in study.GIVEN]
        assert not missing, (name, missing)


def test_which_method_when_has_the_numbers_of_the_studies():
    readme = (FOLDER.parents[1] / "README.md").read_text(encoding="utf-8")
    advice = re.search(r"## Which method when\n(.*?)- `/usr/bin", readme, re.S)[1]
    studied = [studies.module(name) for name in ("speed", "flows", "ratcheting")]
    known = {number for study in studied for number in [*numbers.written(study.ANSWER), *study.GIVEN]}
    assert set(numbers.written(advice)) - known == {"2e6"}  # k_n itself, in N/m


def test_a_wrong_number_would_be_found():
    known = {"5": [5, 5], "4.3e-4": 4.34e-4}
    assert numbers.wrong("On 5 packings 4.3e-4 at 1e-8 (Fig. 4).", known, ("1e-8",)) == []
    assert len(numbers.wrong("On 5 packings 4.2e-4 at 1e-8.", known, ("1e-8",))) == 2
    assert numbers.wrong("4.3e-4 on 5 packings.", known) == ["4.3e-4 stands where 5 is expected"]
    assert numbers.wrong("On 5 packings 4.3e-4.", known | {"4.3e-4": 4.36e-4}) and numbers.wrong("On 5 packings 4.3e-4.", known | {"5": [5, 4]})


def _cheapest_rows():
    """Of each tangential law the row of the study with the shortest path in time."""
    rows = {}
    for row in sorted(studies.module(ANEW).ROWS["full"], key=lambda row: row.get("period", 1)):
        rows.setdefault(row["tangential_law"], row)
    return rows


@pytest.mark.parametrize("law", ("standard", "avoid_ratcheting", "path_independent"))
def test_a_row_run_anew_gives_the_published_numbers(law, root, tmp_path):
    row = _cheapest_rows()[law]
    arguments = [f"--results={tmp_path}"] + [f"{name}={value}" for name, value in row.items()]
    done = subprocess.run(["yade", "-n", "-x", "-j", "1", "yade_scripts/run.py", *arguments], cwd=root, capture_output=True, text=True, timeout=1200,
                          env=os.environ | {"OMP_NUM_THREADS": "1"})
    run = reader.load(results.path_of(parameters.complete(row), tmp_path))
    fresh, = studies.module(ANEW).summarize([run])
    published = publish.read_table(FOLDER / f"{ANEW}.csv")
    keys = ["law", "path_depth", "path_angle", "period_s"]
    (_, old), = published[(published[keys] == [fresh[key] for key in keys]).all(axis=1)].iterrows()
    for name, value in fresh.items():
        if isinstance(value, float):
            assert float(old[name]) == pytest.approx(value, abs=TOLERANCE), f"{name}\n{done.stderr}"


def test_the_studies_come_from_one_commit_whose_engine_gives_the_bits_of_today(root):
    """Since that commit the stored hashes of the engine's results have not changed."""
    newest, = {tuple(said(name)["commits"]) for name in PUBLISHED}
    assert len(newest) == 1
    hashes = "tests/yade_scripts/digests.json"
    then = subprocess.run(["git", "show", f"{newest[0]}:{hashes}"], cwd=root, check=True, capture_output=True).stdout
    assert json.loads(then) == json.loads((root / hashes).read_bytes())
