"""What is committed in analysis/published: complete, and one cheap study run anew. tests/soak asks that nothing lacks
there."""

import base64
import functools
import html
import io
import json
import os
import re
import subprocess
from decimal import Decimal

import numpy as np
import pandas
import pytest
from PIL import Image

from analysis import charts, publish, report, studies, style, texts
from analysis.charts import table
from yade_scripts.results import reader
from yade_scripts import parameters, results

FOLDER = reader.RESULTS.parent / "analysis" / "published"
PUBLISHED = sorted(path.stem for path in FOLDER.glob("*.json"))
# Floats that a row run anew must give: path of two disks led by prescribed motions, the same in every run. Another compiler or
# processor changes the last digits only; 1e-9 of the largest force is a thousand times the round-off of 1e4 steps.
ANEW, TOLERANCE = "closed_path", 1e-9

# Studies whose rows have changed since their tables were made. They leave this list when their new tables are here.
REMADE_NEXT = set()


def said(name):
    """The provenance and findings of a published study."""
    return json.loads((FOLDER / f"{name}.json").read_text())


def test_the_page_of_the_committed_run_is_one_command(root, tmp_path):
    page = tmp_path / "new" / "report.html"
    subprocess.run(["make", "report", "PUBLISHED=1", f"REPORT={page}"], cwd=root, check=True, capture_output=True, timeout=1200)
    text = html.unescape(page.read_text())
    absent = "; ".join(studies.module(name).TITLE for name in studies.names() if name not in PUBLISHED)  # while they are being written
    assert text.count("Not run yet") == (f"Not run yet: {absent}." in text) == bool(absent)
    manual = texts.ENGINE.read_text(encoding="utf-8")
    assert all(studies.module(name).TITLE in (text if studies.module(name).PART in report.PARTS else manual) for name in PUBLISHED)
    changed = [studies.module(name).TITLE for name in studies.names()
               if name in REMADE_NEXT and studies.module(name).PART in report.PARTS]
    assert re.findall(r"<h2>([^<]*)</h2>(?:(?!<h2>).)*Its rows have changed since", text, re.S) == changed
    assert page.stat().st_size < 2e6 and text.count("<figure>") == text.count("<figure><a href=")  # every picture leads to the full one


@pytest.mark.parametrize("name", ("fig4", "fig5", "force_networks", "isostatic"))
def test_the_colours_of_a_picture_survive_on_the_page(name):
    read = lambda file: np.asarray(Image.open(file).convert("RGB"), dtype=int)
    figure = Image.open(FOLDER / f"{name}.png")
    shown = read(io.BytesIO(base64.b64decode(report._figure(FOLDER / f"{name}.png")["picture"].split(",")[1])))
    full = figure.convert("RGB").crop((0, 0, figure.width, figure.height - int(figure.info[style.FOOT])))
    full = full.resize(shown.shape[1::-1], Image.LANCZOS)
    for colour in style.COLOUR.values():
        target = [int(colour[place:place + 2], 16) for place in (1, 3, 5)]
        pixels = np.abs(np.asarray(full, dtype=int) - target).max(axis=2) <= 2
        assert pixels.sum() > 15 or name == "force_networks"  # there MD has two crosses only
        assert (np.abs(shown[pixels] - target) <= 16).all()


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
    if name not in REMADE_NEXT:
        assert len(studies.rows(name, True)) == found["runs_finished"] + failed


@pytest.mark.parametrize("name", PUBLISHED)
def test_the_published_runs_had_the_parameters_of_today(name):
    """All but those that are run anew next."""
    assert publish.of_other_rows(name, said(name), publish.read_table(FOLDER / f"{name}.csv")) == (name in REMADE_NEXT)


def test_rows_that_cannot_be_run_are_others(monkeypatch):
    """The page of the other studies is written all the same."""
    monkeypatch.setitem(studies.module("fig4").ROWS, "full", [{"frction": 0.1}])
    assert publish.of_other_rows("fig4", said("fig4"), publish.read_table(FOLDER / "fig4.csv"))


@pytest.mark.parametrize("name", charts.ORDER)
def test_figures_of_charts_are_there(name):
    folder = FOLDER / charts.FOLDER
    assert all((folder / file).is_file() for file in json.loads((folder / f"{name}.json").read_text())["figures"])


@pytest.mark.parametrize("name", ("by_kind", "profile", "cost_against_size"))
def test_charts_follow_from_the_measured_settings(name, tmp_path):
    """Up to the round-off of sums and logarithms."""
    publish.write_table(tmp_path / "anew.csv", charts.module(name).rows(table.from_csv(table.PUBLISHED)))
    anew, old = (publish.read_table(path) for path in (tmp_path / "anew.csv", table.PUBLISHED.with_name(f"{name}.csv")))
    pandas.testing.assert_frame_equal(anew, old, check_dtype=False, rtol=1e-12)


def misplaced(text, values):
    """What is wrong where the numbers of a text have to be these values one by one, rounded to the digits written; a space in a number is none."""
    found = re.findall(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e-?\d+)?(?![\w])", re.sub(r"(?<=\d)\s(?=\d{3}\b)", "", text))
    wrong = [(number, value) for number, value in zip(found, values)
             if abs(float(number) - float(value)) > 0.5000001 * 10.0**Decimal(number).as_tuple().exponent]
    return wrong if len(found) == len(values) else [f"{len(found)} numbers for {len(values)} values: {' '.join(found)}"]


def test_every_number_of_the_cost_of_the_engine_is_that_of_the_benchmark(root):
    """Of the solvers, of problems that are hard for them and of a whole step; the million stands there as a word."""
    text = (root / "cd_engine" / "README.md").read_text(encoding="utf-8").split("## What it costs")[1].split("\n## ")[0]
    solver, step = (re.search(rf"{first}.*?\n\n", text, re.S)[0] for first in ("A plain sweep", "A whole step"))
    sweeps, solved, steps = (publish.read_table(FOLDER / "benchmark" / f"{name}.csv") for name in ("sweeps", "solutions", "step"))
    sweep = sweeps.set_index("problem").loc["packing of 4000"]
    own = solved[(solved.method == "auto") & (solved.target == 1e-4) & (solved.start == "cold") & solved.disks.isin((400, 4000))]
    masses, packings = (own[own.kind == kind].sweeps for kind in ("masses", "packing"))
    hard = re.search(r"Three problems.*?because", text, re.S)[0]
    assert misplaced(hard, [1e6, masses.min(), masses.max(), 1e-4, packings.min(), packings.max()]) == [] and len(masses) == 3
    cold = solved[(solved.kind == "packing") & (solved.disks == 4000) & (solved.start == "cold") & (solved.target == 1e-4)]
    cold = cold.pivot(index="problem", columns="method", values="seconds")
    faster = cold["siconos nsgs"] / cold["auto"]
    assert misplaced(solver, [4000, sweep.plain_avx512_ns, sweep.siconos_ns, 1e-4, 1e3 * cold["auto"].median(), len(cold), faster.min(),
                                      faster.max()]) == []
    rows = steps[(steps.order == "built") & (steps.tolerance == 1e-4)].set_index("disks").loc[[400, 40000, 250000, 1000000]]
    small, middle, large, million = rows.ns_a_contact
    assert misplaced(step, [1e-4, small, 400, middle, 40000, large, 250000, million, rows.sweeps_a_step.iloc[-1], *rows.over_springs, 40000,
                                    rows.two_threads_step[40000], 400, 40000, rows.ns_a_disk_at_rest[40000],
                                    rows.seconds_around_a_run.iloc[-1]]) == []


def test_every_number_of_problems_in_space_is_that_of_the_benchmark(root):
    """`auto` solves every problem to 1e-8, and faster than the fastest of Siconos's solvers."""
    text = (root / "cd_engine" / "README.md").read_text(encoding="utf-8").split("`make bench` compares these with")[1].split("![Error")[0]
    rows = publish.read_table(FOLDER / "benchmark" / "space.csv")
    rows = rows[(rows.target == 1e-8) & (rows.status == "solved")]
    own = rows[rows.method == "auto"].set_index("problem")
    peers = rows[rows.method.str.startswith("siconos")].sort_values("seconds")
    best = peers.drop_duplicates("problem").set_index("problem")
    gain, solved = best.seconds / own.seconds, peers.groupby("method").problem.nunique()
    words, table = text.split("\n| problem", 1)
    fewer = solved.drop("siconos PROX")
    counts = [solved["siconos PROX"], fewer.min(), fewer.max()]
    assert misplaced(words.split("To 1e-8 ")[1], [len(own), gain.min(), gain.max(), *counts]) == []
    assert len(own) == len(best) == rows.problem.nunique() and gain.min() > 1
    for line in table.splitlines()[2:-2]:
        name, contacts, peer, siconos, auto = (cell.strip() for cell in line.strip("|").split("|"))
        problem, = [full for full in own.index if full.lower().startswith(name.lower())]
        assert best.method[problem] == f"siconos {peer}" and int(contacts) == own.contacts[problem]
        assert misplaced(f"{siconos} {auto}", [best.seconds[problem], own.seconds[problem]]) == []
    random = own.index[own.kind == "space"]
    cells = table.splitlines()[-2].replace("|", " ")
    assert misplaced(cells, [len(random), 20, 60, own.contacts[random].min(), own.contacts[random].max(), best.seconds[random].min(),
                             best.seconds[random].max(), own.seconds[random].min(), own.seconds[random].max()]) == []


def test_every_number_of_packings_of_spheres_is_that_of_the_benchmark(root):
    """Of the lines of the table; where a method gives up, the error at which it ends."""
    text = (root / "cd_engine" / "README.md").read_text(encoding="utf-8").split("**Packings of spheres**")[1].split("With mu of")[0]
    rows = publish.read_table(FOLDER / "benchmark" / "spheres.csv")
    solved, cold = rows.status == "solved", rows.start == "cold"
    lines = [[cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines() if re.match(r"[|] \d", line)]
    assert len(lines) == len(rows[cold].groupby(["disks", "mu"]))
    for spheres, mu, peer, own, finest in lines:
        case = cold & (rows.disks == int(spheres.replace(" ", ""))) & (rows.mu == float(mu))
        of = {(row.method, row.target): row for row in rows[case].itertuples()}
        coarse = [of[method, 1e-4] for method in ("siconos nsgs", "auto")]
        fine = [of.get((method, 1e-8)) for method in ("auto", "siconos nsgs")]
        for cell, row in zip((peer, own), coarse):
            assert cell == "not in 120 s" if row.status != "solved" else misplaced(cell, [row.seconds]) == [], (spheres, mu, cell)
        last = [row.seconds if row.status == "solved" else 120 if row.status.startswith("not within") and fine[0].status == "solved"
                else row.residual for row in fine]
        assert misplaced(finest, last) == [], (spheres, mu, finest)
    warm = rows[solved & ~cold & (rows.method == "auto")].sweeps
    assert misplaced(re.search(r"before the load rises(.*?) sweeps", text, re.S)[1], [1e-4, warm.min(), warm.max()]) == []


def test_every_number_of_threads_is_that_of_the_benchmark(root):
    section = (root / "cd_engine" / "README.md").read_text(encoding="utf-8").split("## Threads")[1].split("\n## ")[0]
    text = re.search(r"With 40 000.*?A\s`BodyProblem", section, re.S)[0]
    step, threads = (publish.read_table(FOLDER / "benchmark" / f"{name}.csv") for name in ("step", "threads"))
    here = step[(step.disks == 40000) & (step.order == "built") & (step.tolerance == 1e-4)].iloc[0]
    many, few = (threads[threads.disks == disks].set_index("threads").step_speedup for disks in (40000, 4000))
    counts = [2, 4, 8, 16]
    assert misplaced(text, [40000, here.two_threads_solver, here.two_threads_step, threads.cores.max(), 40000, *many[counts], *counts, 4000,
                                    few[2], 2, few.max()]) == []


@pytest.mark.parametrize("law", ("standard", "avoid_ratcheting", "path_independent"))
def test_a_row_run_anew_gives_the_published_numbers(law, root, tmp_path):
    row = min((row for row in studies.module(ANEW).ROWS["full"] if row.get("tangential_law") == law), key=lambda row: row.get("period", 1))
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


@functools.lru_cache
def stored_at(root, commit):
    """The stored hashes of the scenes as they were at a commit. A clone without its history does not know them."""
    def git(*arguments):
        return subprocess.run(["git", *arguments], cwd=root, capture_output=True, text=True).stdout.strip()
    told = git("show", f"{commit}:tests/yade_scripts/digests.json")
    if not told and git("rev-parse", "--is-shallow-repository") != "false":
        pytest.skip(f"the commit {commit} is not here: it takes a whole clone")
    return json.loads(told)["all"]


def test_a_clone_without_history_is_skipped(root, tmp_path):
    subprocess.run(["git", "clone", "--depth", "1", root.as_uri(), tmp_path / "clone"], check=True, capture_output=True)
    with pytest.raises(pytest.skip.Exception, match="takes a whole clone"):
        stored_at(tmp_path / "clone", "0" * 40)


def test_no_study_is_older_than_the_bits_of_its_scenes(root):
    """Since its commit the stored hashes of its scenes have not changed. They are of short runs: runs that yield or are solved loosely may differ."""
    today = json.loads((root / "tests" / "yade_scripts" / "digests.json").read_bytes())["all"]
    for name in PUBLISHED:
        for scene, method in {(row["scene"], row["method"]) for row in studies.rows(name, True)}:
            for commit in said(name)["commits"]:
                assert f"{scene} {method}" in stored_at(root, commit), f"{name}: store the hash of {scene} {method} before its full run"
                assert stored_at(root, commit)[f"{scene} {method}"] == today[f"{scene} {method}"], f"{name}: {scene} {method} of {commit}"
