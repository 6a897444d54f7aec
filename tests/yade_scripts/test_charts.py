"""What the charts run: settings that are legal, records that survive crashes, and the same numbers as an ordinary run."""
import json
import math
import signal
import types

import pytest

from yade_scripts import parameters, scenes
from yade_scripts.charts import records, run, settings


@pytest.mark.parametrize("scene", settings.charted())
def test_settings_are_legal_rows_from_coarse_to_fine(scene):
    full, quick = settings.everything(scene, False), settings.everything(scene, True)
    assert {one.name for one in quick} <= {one.name for one in full}
    for one in full:
        assert one.full["scene"] == scene and one.full["method"] in scenes.module(scene).METHODS
    assert {one.full["method"] for one in full} == set(scenes.module(scene).METHODS)
    for series in settings.series(scene):
        assert len(set(series.values)) == len(series.values) > 1
        finer = series.values[0] > series.values[-1]  # steps and tolerances fall; sweeps, stiffness and damping rise
        assert finer == (series.parameter in ("md_dt_factor", "cd_dt", "tolerance", "accuracy"))


def test_the_quick_chart_keeps_the_finest_setting_and_every_second_one():
    series = settings.Series("CD step", "CD", "cd_dt", (4, 2, 1, 0.5), relative=True)
    own = parameters.complete({"scene": "incline"})["cd_dt"]
    assert [row["cd_dt"] for row in series.rows("incline", True)] == [2 * own, 0.5 * own]


def known(measured, exact=2.0, scale=4.0):
    return {"measured": measured, "exact": exact, "scale": scale}


def test_error_is_the_largest_over_its_scale_and_a_lost_number_is_no_solution():
    assert records.error({"a": known(3.0), "b": known(0.0)}) == 0.5
    assert records.error({"a": known(2.5) | {"deviation": 3.0}}) == 0.75  # of a mean no run is nearer than by chance
    assert records.status({"a": known(3.0)}) == "finished"
    assert math.isnan(records.error({"a": known(3.0), "b": known(None)}))
    assert records.status({"a": known(3.0), "b": known(None)}) == "failed: b is not a number"
    assert records.status({"a": known(1e9)}) == "failed: wrong by more than 100 times its scale"
    assert records.status({}) == "failed: nothing is known of the scene"


def test_the_last_record_counts_and_a_cut_line_is_left_out(tmp_path):
    for status in ("failed: crash", "finished"):
        records.add({"name": "x", "scene": "stack", "status": status}, tmp_path)
    with open(records.path("stack", tmp_path), "a") as file:
        file.write('{"name": "y", "sta')
    assert records.read("stack", tmp_path) == {"x": {"name": "x", "scene": "stack", "status": "finished"}}
    assert records.read("incline", tmp_path) == {}


@pytest.mark.parametrize("record, limit, expected", [
    (None, 3, False), ({"status": "finished", "limit": 3}, 20, True), ({"status": "failed: wrong", "limit": 3}, 20, True),
    ({"status": "failed: took", "out_of_time": True, "limit": 3}, 3, True), ({"status": "failed: took", "out_of_time": True, "limit": 3}, 20, False)])
def test_only_what_ran_out_of_a_shorter_time_is_run_again(record, limit, expected):
    assert records.done(record, limit) is expected


def ended(tmp_path, code):
    """A scene's work after its YADE has ended with `code` at the second of four settings of one series."""
    wanted = [one for one in settings.of_scene("incline", True) if one.series == "MD step"]
    work = run.Work("incline", wanted, tmp_path, 3)
    records.add({"name": wanted[0].name, "scene": "incline", "status": "finished"}, tmp_path)
    work.begun.write_text(json.dumps(dict(wanted[1].row)))
    work.process = types.SimpleNamespace(returncode=code)
    return work, work.ended(), records.read("incline", tmp_path), wanted


def test_a_crash_costs_its_own_row(tmp_path):
    work, more, found, wanted = ended(tmp_path, -11)
    assert more and found[wanted[1].name]["status"] == "failed: YADE ended by SIGSEGV"
    assert work.left() == wanted[2:]


def test_behind_a_row_that_ran_out_of_time_no_costlier_one_is_tried(tmp_path):
    work, more, found, wanted = ended(tmp_path, -14)
    assert not more and work.left() == [] and not work.trouble
    assert found[wanted[1].name]["status"] == "failed: took more than 3 s"
    assert all("not tried" in found[one.name]["status"] for one in wanted[2:])


def test_a_yade_that_does_not_start_is_trouble_and_no_endless_loop(tmp_path):
    work = run.Work("incline", settings.of_scene("incline", True), tmp_path, 3)
    work.process = types.SimpleNamespace(returncode=1)
    assert work.ended() is False and "before its first row" in work.trouble


def test_measured_without_recording_a_setting_gives_what_its_result_file_holds(yade60):
    """To the last bit: recording only reads. And a setting that cannot be run is a record, not an end."""
    rows = [{"scene": "incline", "method": "MD", "slope": 16.0}, {"scene": "incline", "method": "CD", "method_cd": "no such solver"}]
    path = yade60.folder / "rows.json"
    path.write_text(json.dumps(rows))
    done = yade60.script("charts/measure.py", "--results=results", "--limit=60", f"--rows={path}")
    good, bad = records.read("incline", yade60.folder / "results").values()
    assert good["status"] == "finished" and len(good["seconds"]) >= 3 and good["git_commit"], done.stderr
    with yade60.run(disks=400, **rows[0]) as file:
        assert good["known"]["acceleration"]["measured"] == file["known/acceleration"][()]
    assert bad["status"].startswith("failed: method_cd = 'no such solver'")


def test_a_run_out_of_time_ends_its_yade_and_says_which_row(yade60):
    path = yade60.folder / "slow.json"
    path.write_text(json.dumps([{"scene": "incline", "method": "MD", "stiffening": 1e4, "md_dt_factor": 0.001}]))
    done = yade60.script("charts/measure.py", "--results=results", "--limit=1", f"--rows={path}")
    assert done.returncode == -signal.SIGPROF and json.loads(path.with_suffix(".begun").read_text())["stiffening"] == 1e4
