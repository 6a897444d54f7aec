"""What charts and maps measure: legal settings, measurements that survive crashes, and numbers equal to those of ordinary runs."""
import json
import math
import shutil
import signal
import types

import pytest

from yade_scripts import parameters, scenes
from yade_scripts.measuring import __main__ as runner
from yade_scripts.measuring import charts, maps, store
from yade_scripts.measuring.benchmark import pieces


@pytest.mark.parametrize("scene", charts.names())
def test_settings_are_legal_rows_from_coarse_to_fine(scene):
    full, quick = charts.settings(scene, True), charts.settings(scene, False)
    assert {one.name for one in quick} <= {one.name for one in full}
    for one in full:
        row = parameters.complete(store.split(one.row)[0])
        assert row["scene"] == scene and row["method"] in scenes.module(scene).METHODS
    for series in charts.series(scene):
        assert len(set(series.values)) == len(series.values) > 1
        finer = series.values[0] > series.values[-1]  # steps and tolerances fall; sweeps, stiffness and damping rise
        assert finer == (series.parameter in ("md_dt_factor", "cd_dt", "tolerance", "accuracy"))


def test_the_quick_chart_keeps_the_finest_setting_and_every_second_one():
    series = charts.Series("CD step", "CD", "cd_dt", (4.0, 2.0, 1.0, 0.5))
    assert [row["cd_dt"] for row in series.rows("incline", True)] == [2.0, 0.5]


def known(name, measured, exact=2.0, scale=4.0, deviation=0.0):
    return {"name": name, "measured": measured, "exact": exact, "scale": scale, "deviation": deviation}


def test_error_is_the_largest_over_its_scale_and_a_lost_number_is_no_solution():
    assert charts.error([known("a", 3.0), known("b", 0.0)]) == 0.5
    assert charts.error([known("a", 2.5, deviation=3.0)]) == 0.75  # against a mean, the error is at least the deviation of one run
    assert charts.status([known("a", 3.0)]) == "finished"
    assert math.isnan(charts.error([known("a", 3.0), known("b", None)]))
    assert charts.status([known("a", 3.0), known("b", None)]) == "failed: b is not a number"
    assert charts.status([known("a", 1e9)]) == "failed: wrong by more than 100 times its scale"
    assert charts.status([]) == "failed: the scene has no quantity with a known value"


def test_measurements_are_kept_to_the_bit_and_damaged_ones_measured_again(tmp_path, capsys):
    rows = [{"name": "a, b", "value": 0.1 + 0.2, "count": 3}, {"name": "ü", "value": None, "count": 4}]
    facts = {"map": "x", "case": {"a": 2.5}, "nested": {"a": [1, 2.5]}}
    name = store.name_of(facts)
    store.add(tmp_path, facts, rows)
    assert store.get(tmp_path, name) == store.origin() | facts | {"rows": rows}
    assert store.get(tmp_path, "y") is None
    (tmp_path / f"{name}.h5").write_bytes((tmp_path / f"{name}.h5").read_bytes()[:-100])
    assert store.get(tmp_path, name) is None and "measured again" in capsys.readouterr().err


def test_a_renamed_measurement_is_none(tmp_path, capsys, monkeypatch):
    """Neither a chart, nor a map, nor the benchmark takes it for another one."""
    settings = [one for one in charts.settings("incline", False) if one.series.name in ("MD step", "CD step")]
    md, cd = settings[0], settings[-1]
    store.add(tmp_path / "charts", {"row": md.row, "status": "finished", "seconds": [0.1]})
    shutil.copy(tmp_path / "charts" / f"{md.name}.h5", tmp_path / "charts" / f"{cd.name}.h5")
    left = {one.name for one in charts.Work("incline", False, tmp_path).left()}
    assert cd.name in left and md.name not in left and store.get(tmp_path / "charts", cd.name) is None
    assert f"{cd.name}.h5: holds another measurement than its name says ({md.name}); it is measured again" in capsys.readouterr().err
    work, (one, other) = maps.Work("tunnelling", False, tmp_path), maps.get("tunnelling").grid(False)[:2]
    work.enter(one, maps.Outcome("stable"), 1)
    name = store.name_of({"map": work.name, "case": other})
    shutil.copy(next((tmp_path / "maps").glob("*.h5")), tmp_path / "maps" / f"{name}.h5")
    assert work.find(one) and work.find(other) is None
    monkeypatch.setitem(pieces.MEASURE, "sweeps", lambda folder, rounds: [{"a": 1}])
    piece, another = (pieces.Piece("sweeps", {"rounds": rounds}) for rounds in (3, 4))
    piece.measure(tmp_path)
    shutil.copy(next((tmp_path / "pieces").glob("*.h5")), tmp_path / "pieces" / f"{store.name_of(another.facts())}.h5")
    assert piece.stored(tmp_path) == [{"a": 1}] and another.stored(tmp_path) is None


def job(tmp_path, kind, name, code, at):
    """The runner's job after its YADE has ended with `code` at a measurement."""
    found = runner.Measurements(kind, name, False, tmp_path)
    found.process = types.SimpleNamespace(returncode=code)
    found.log.parent.mkdir(parents=True, exist_ok=True)
    found.log.write_text("the end\n")
    if at:
        found.at.write_text(at)
    return found


@pytest.fixture
def steps():
    """The settings of the series MD step of the incline."""
    return [one for one in charts.settings("incline", False) if one.series.name == "MD step"]


def test_a_crash_costs_its_own_setting(tmp_path, steps):
    work = job(tmp_path, "charts", "incline", -11, steps[1].name)
    assert work.again() and not work.trouble
    assert store.get(tmp_path / "charts", steps[1].name)["status"] == "failed: YADE ended by SIGSEGV"
    left = {one.name for one in work.work.left()}
    assert steps[1].name not in left and steps[2].name in left


def test_behind_a_setting_that_ran_out_of_time_no_costlier_one_is_tried(tmp_path, steps):
    work = job(tmp_path, "charts", "incline", -signal.SIGPROF, steps[1].name)
    assert work.again()
    assert store.get(tmp_path / "charts", steps[1].name)["status"] == "failed: took more than 2 s"
    assert all("not tried" in store.get(tmp_path / "charts", one.name)["status"] for one in steps[2:])
    assert steps[0].name in {one.name for one in work.work.left()}
    assert steps[-1].name in {one.name for one in charts.Work("incline", True, tmp_path).left()}  # with more time they are tried again


def test_a_worker_that_cannot_begin_is_trouble_and_no_endless_loop(tmp_path, steps):
    for code, at in ((1, steps[0].name), (-11, None)):
        work = job(tmp_path, "charts", "incline", code, at)
        assert not work.again() and "the end" in work.trouble


def test_measurements_of_another_commit_are_named(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(runner.queue, "run", lambda jobs, at_once: None)
    case = maps.get("tunnelling").grid(False)[0]
    store.add(tmp_path / "maps", {"map": "tunnelling", "case": case, "git_commit": "c" * 40})
    assert runner.main(["--only", "tunnelling", "servo", "--results", str(tmp_path)]) == 0
    said = capsys.readouterr().err
    assert "measuring: tunnelling: some measurements may come from other code (commit cccccccccccc;" in said and "servo" not in said


def test_a_crash_costs_one_case_of_a_map(tmp_path):
    case = maps.get("tunnelling").grid(False)[0]
    work = job(tmp_path, "maps", "tunnelling", -11, json.dumps(case))
    assert work.again()
    assert maps.Work("tunnelling", False, tmp_path).find(case)["reason"] == "crashed"


def test_measured_without_recording_a_setting_gives_what_its_result_file_holds(yade60):
    """The same to the last bit, since recording only reads. A setting that cannot be run is stored as such; one that is too slow ends its process."""
    found = yade60.code("""
from yade_scripts.measuring.charts import measure
row = {"scene": "incline", "method": "MD", "slope": 16.0}
good, known = measure.measure(row, "results", 60, lambda seconds: None)
bad, _ = measure.measure({"scene": "biaxial", "method": "CD"}, "results", 60, lambda seconds: None)
print(json.dumps([good, known, bad]))
""")
    good, known, bad = found
    assert good["status"] == "finished" and len(good["seconds"]) >= 3
    with yade60.run(disks=400, scene="incline", method="MD", slope=16.0) as file:
        assert known[0]["measured"] == file["known/acceleration"][()]
    assert bad["status"] == "failed: the scene has no quantity with a known value with these parameters"


def test_the_time_is_that_of_the_steps_and_springs_trace_no_energies_meanwhile(yade60):
    """Nearly all processor time of a long run is that of its steps."""
    for method in ("MD", "CD"):
        counted, spent, traced = yade60.code(f"""
import time
from yade_scripts import parameters, scenes
from yade_scripts.running import md, timing
full = parameters.complete({{"scene": "stack", "method": {method!r}, "period": 10.0}})
scene, begun = scenes.build(full, "results"), time.process_time()
counted = timing.run(scene, full)
spent = time.process_time() - begun
print(json.dumps([counted, spent, {method!r} == "MD" and md.law().traceEnergy]))
""")
        assert 0.5 * spent < counted <= spent and not traced


def test_what_is_too_slow_ends_its_worker_which_says_where(tmp_path):
    """With a limit of a fiftieth of a second SIGPROF ends the worker, which has written the name of its measurement."""
    path = tmp_path / "slow.py"
    path.write_text(f"""
import sys
sys.path.insert(0, {str(runner.queue.SCRIPTS.parent)!r})
from yade_scripts.measuring import charts, worker
charts.LIMIT = {{False: 0.02, True: 0.02}}
worker.main("charts", "heavy_on_light", False, {str(tmp_path)!r})
""")
    job = runner.queue.Job(path, [], tmp_path / "slow.log")
    runner.queue.run([job], 1)
    assert job.process.returncode == -signal.SIGPROF, job.said()
    under_way = (tmp_path / "charts" / "heavy_on_light.under-way").read_text()
    assert under_way in {one.name for one in charts.Work("heavy_on_light", False, tmp_path).settings}
