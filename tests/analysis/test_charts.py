"""The charts from made-up measurements: what counts as accurate, profiles, exponents, recommendations, and failures that are seen."""

import json
import re
import subprocess

import matplotlib.image
import numpy as np
import pytest

from analysis import charts, publish
from analysis.__main__ import main
from analysis.charts import choice, cost_against_size, profile, recommend, table, work_precision
from yade_scripts.charts import records, settings

PUBLISHED = recommend.PUBLISHED


def rows(series, errors, seconds=None, scene="stack", size=0):
    """A series of settings; an error that is a text is the reason of a failure."""
    made = []
    for rank, error in enumerate(errors):
        lost = isinstance(error, str)
        made.append({"name": f"{scene}-{series}-{rank}", "status": f"failed: {error}" if lost else "", "scene": scene, "kind": "piles at rest", "size": size, "method": series[:2], "series": series,
                     "rank": rank, "setting": f"tolerance={10.0**-rank:g}", "arguments": f"scene={scene} tolerance={10.0**-rank:g}", "error": None if lost else error,
                     "worst": "" if lost else "force", "seconds": None if lost else (seconds or [0.1 * 2**rank] * 99)[rank] if seconds else 0.1 * 2**rank,
                     "fastest": None if lost else 0.1, "slowest": None if lost else 0.2, "repeats": 3, "steps": 10, "sweeps": 5, "unconverged_steps": 0, "disks": 4})
    return made


def test_an_error_that_passes_through_zero_is_luck():
    own = rows("CD step", [1e-1, 1e-9, 1e-2, 1e-4])
    assert choice.cheapest(own, 1e-3)["rank"] == 3 and choice.cheapest(own, 1e-2)["rank"] == 1
    assert choice.best_error(own) == (1e-4, own[3])


def test_what_ran_out_of_time_tells_nothing_and_what_crashed_speaks_against():
    assert choice.cheapest(rows("CD step", [1e-4, "took more than 3 s"]), 1e-3)["rank"] == 0
    assert choice.cheapest(rows("CD step", [1e-4, "x is not a number"]), 1e-3) is None
    assert choice.cheapest(rows("CD step", ["took more than 3 s"]), 1e-3) is None


def test_damping_has_to_be_right_on_both_sides():
    own = rows("MD damping", [1.0, 1e-4, 1e-5, 1e-5])
    assert [row["rank"] for row in choice.reliable(own, 1e-3)] == [2, 3]


def test_one_setting_for_all_scenes_of_a_kind_solves_most_of_them():
    own = rows("CD step", [1e-5, 1e-5]) + rows("CD step", [1e-1, 1e-5], scene="loaded_box")
    series, solved, left = choice.of_kind(own, 1e-3)["CD"]
    assert [row["rank"] for row in solved] == [1, 1] and left == []
    assert choice.of_kind(own, 1e-7) == {}


def test_profile_counts_the_scenes_solved_within_a_factor():
    own = (rows("MD step", [1e-3, 1e-5], [4.0, 8.0]) + rows("CD step", [1e-5], [1.0])
           + rows("MD step", [1e-5], [1.0], "incline") + rows("CD step", [1e-1], [0.5], "incline") + rows("MD step", [1e-9], [1.0], "two_grain_path"))
    found = profile.factors(own)
    assert {row["scene"] for row in found} == {"stack", "incline"}  # the third is of one method alone
    factors, share = profile.share(found, "MD step", 1e-2)
    assert list(factors) == [1, 4] and list(share) == [0.5, 1]
    factors, share = profile.share(found, "CD, best of all", 1e-2)
    assert list(factors) == [1] and list(share) == [0.5]
    lost, = (row for row in found if row["scene"] == "incline" and row["series"] == "CD step" and row["accuracy"] == 1e-2)
    assert lost["status"] and lost["seconds"] is None


def test_exponent_of_the_cost():
    own = [row for size in (10, 100, 1000) for row in rows("CD nsgs", [1e-5], [2e-6 * size**1.5], size=size)]
    found = cost_against_size.costs(own + rows("MD step", [1e-1], [1.0], size=10))
    # Exact but for the rounding of logarithms.
    assert cost_against_size.power([row for row in found if row["series"] == "CD nsgs"]) == pytest.approx(1.5, abs=1e-9)
    lost, = (row for row in found if row["series"] == "MD step")
    assert lost["status"] == "smallest error 0.1"


@pytest.fixture
def published(tmp_path, monkeypatch):
    """A published table, and no local records."""
    path = tmp_path / "work_precision.csv"
    publish.write_csv(path, rows("MD step", [1e-1, 1e-2]) + rows("CD step", [1e-3, 1e-6]))
    monkeypatch.setattr(recommend, "PUBLISHED", path)
    return ["recommend", "--results", str(tmp_path)]


def test_recommend_names_the_cheapest_setting_and_what_the_other_method_can(published, capsys):
    assert main([*published, "--scene", "stack", "--accuracy", "1e-4"]) == 0
    said = capsys.readouterr().out
    assert "accuracy 0.0001: CD" in said and "expected error 1e-06, 0.2 s" in said and "MD: not reached; its best is 0.01 in 0.2 s" in said
    assert "run.py scene=stack tolerance=0.1" in said


def test_recommend_says_what_is_missing(published, capsys):
    assert main([*published, "--scene", "stack", "--accuracy", "1e-9"]) == 2
    assert "no measured setting reaches an accuracy of 1e-09; the best is 1e-06" in capsys.readouterr().err
    assert main([*published, "--scene", "nowhere"]) == 2
    assert "nowhere: there is no such scene; there are arch" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        main([*published, "--accuracy", "-1"])
    assert "-1 is no accuracy" in capsys.readouterr().err


def test_recommend_for_each_kind_of_scene(published, capsys):
    assert main([*published, "--accuracy", "1e-3"]) == 0
    assert "piles at rest (1 scene), accuracy 0.001: CD" in capsys.readouterr().out
    assert main([*published, "--table"]) == 0
    assert "| piles at rest | MD `tolerance=1` 0.1 s; CD 0.1 s | CD `tolerance=1` 0.1 s; MD 0.2 s | CD `tolerance=0.1` 0.2 s; MD: not reached |" in capsys.readouterr().out


def test_a_table_reads_back_as_it_was(published, tmp_path):
    assert table.from_csv(tmp_path / "work_precision.csv") == rows("MD step", [1e-1, 1e-2]) + rows("CD step", [1e-3, 1e-6])


def record(setting, error):
    """A record of a setting with this error, or a failed one."""
    lost = isinstance(error, str)
    return {"name": setting.name, "scene": "stack", "method": setting.full["method"], "row": dict(setting.row), "parameters": setting.full,
            "status": f"failed: {error}" if lost else "finished", "seconds": [] if lost else [0.1, 0.3, 0.2], "error": None if lost else error,
            "known": {} if lost else {"force": {"measured": error, "exact": 0.0, "scale": 1.0}}, "steps": 10, "disks": 4,
            "git_commit": "c" * 40, "yade_version": "2023.02a", "processor": "made up", "limit": 3}


@pytest.fixture
def measured(tmp_path):
    """Records of the stack: MD and CD steps, the last of each a failure; and sizes."""
    for series in ("MD step", "CD step"):
        own = [one for one in settings.of_scene("stack", True) if one.series == series]
        for rank, setting in enumerate(own):
            records.add(record(setting, "x is not a number" if rank == len(own) - 1 else 10.0**-rank), tmp_path)
    for setting in settings.of_sizes("stack", True):
        records.add(record(setting, 1e-5), tmp_path)
    return tmp_path


def test_all_charts_are_drawn_and_say_where_they_come_from(measured, tmp_path, capsys):
    folder = tmp_path / "figures"
    assert main(["charts", "--results", str(measured), "-o", str(folder)]) == 0
    for name in ("work_precision", "profile", "cost_against_size"):
        found = json.loads((folder / f"{name}.json").read_text())
        assert found["commits"] == ["c" * 40] and found["runs_failed"] == (0 if name == "cost_against_size" else 2) and found["answer"]
        assert all((folder / figure["file"]).read_bytes().startswith(b"\x89PNG") for figure in found["figures"])
    row = next(row for row in table.from_csv(folder / "work_precision.csv") if row["error"] == 0.1)
    assert row["seconds"] == 0.2 and row["worst"] == "force" and row["arguments"].startswith("scene=stack method=MD ")


def test_no_measurements_are_said_so(tmp_path, capsys):
    assert main(["charts", "--results", str(tmp_path), "-o", str(tmp_path / "figures")]) == 2
    assert "holds no measured setting" in capsys.readouterr().err


def test_failures_are_drawn_at_the_top(tmp_path):
    """Crosses of the series' colour in the top tenth, which hold no ink of it without failures: errors are far below."""
    kept = [record(one, 1e-3) for one in settings.of_scene("stack", True)[:1]]
    ink = []
    for errors in ([1e-3, 1e-4], [1e-3, 1e-4, "x is not a number"]):
        path = tmp_path / f"{len(errors)}.png"
        work_precision.draw(rows("CD step", [1.0]) + rows("MD step", errors), kept, path)
        image = matplotlib.image.imread(path)[:, :, :3]
        top = image[:int(0.1 * len(image)), :int(0.75 * image.shape[1])]
        ink.append((np.abs(top - np.array([0x00, 0x72, 0xB2]) / 255).max(axis=2) < 0.1).sum())
    assert ink[0] == 0 and ink[1] > 20


FOLDER = PUBLISHED.parent
NAMES = sorted(path.stem for path in FOLDER.glob("*.json"))


@pytest.mark.parametrize("name", NAMES)
def test_published_charts_are_complete(name):
    found = json.loads((FOLDER / f"{name}.json").read_text())
    _, table_rows = publish.read_csv(FOLDER / f"{name}.csv")
    assert name in charts.ORDER and found["chart"] == name and found["extent"] == "full" and table_rows
    assert found["commits"] and all(re.fullmatch("[0-9a-f]{40}", commit) for commit in found["commits"])
    assert found["answer"] and all((FOLDER / figure["file"]).is_file() for figure in found["figures"])


@pytest.mark.skipif(not PUBLISHED.is_file(), reason="no chart has been published yet")
def test_recommended_settings_reach_what_they_promise(root, tmp_path):
    """Every scene's cheapest settings of both methods that take less than 0.1 s, run anew."""
    promised = {}
    found = table.one_size(table.from_csv(PUBLISHED))
    for scene in dict.fromkeys(row["scene"] for row in found):
        for method in ("MD", "CD"):
            row = choice.cheapest([row for row in found if (row["scene"], row["method"]) == (scene, method)], 1e-2)
            if row and row["seconds"] < 0.1:
                setting, = (one for one in settings.of_scene(scene, False) if (one.series, one.rank) == (row["series"], row["rank"]))
                promised[setting.name] = setting
    path = tmp_path / "rows.json"
    path.write_text(json.dumps([dict(setting.row) for setting in promised.values()]))
    subprocess.run(["yade", "-n", "-x", "-j", "1", "yade_scripts/charts/measure.py", f"--results={tmp_path}", "--limit=30", f"--rows={path}"],
                   cwd=root, capture_output=True, timeout=300)
    anew = {name: one for scene in settings.charted() for name, one in records.read(scene, tmp_path).items()}
    assert anew.keys() == promised.keys()
    assert {name: one["error"] for name, one in anew.items() if not one["status"] == "finished" or one["error"] > 1e-2} == {}
