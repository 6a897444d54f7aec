"""The charts from made-up measurements: what counts as accurate, profiles, exponents, recommendations, and failures that are seen."""

import json

import pandas
import pytest

from analysis import publish, style
from analysis.__main__ import main
from analysis.charts import by_kind, choice, cost_against_size, profile, table
from tests.yade_scripts.conftest import Yade
from yade_scripts.measuring import charts as settings
from yade_scripts.measuring import store


def rows(*several):
    """The table of several series, each as the arguments of `series`."""
    return pandas.DataFrame([row for one in several for row in series(*one)]).astype({"error": float, "seconds": float})


def series(series, errors, seconds=None, scene="stack", size=0):
    """A series of settings; an error given as text is the reason of a failure. seconds: of each, by default doubled from one to the next."""
    made = []
    for rank, error in enumerate(errors):
        row = {"scene": scene, "kind": "piles at rest", "size": size, "method": series[:2], "series": series, "rank": rank,
               "setting": f"tolerance={10.0**-rank:g}", "arguments": f"scene={scene} tolerance={10.0**-rank:g}", "steps": 10, "sweeps": 5,
               "unconverged_steps": 0, "disks": 4}
        if isinstance(error, str):
            made.append(row | {"status": f"failed: {error}"} | dict.fromkeys(("error", "worst", "seconds", "fastest", "slowest")))
        else:
            made.append(row | {"status": "", "error": error, "worst": "force", "seconds": seconds[rank] if seconds else 0.1 * 2**rank,
                               "fastest": 0.1, "slowest": 0.2})
    return made


def test_an_error_that_passes_through_zero_is_luck():
    own = rows(("CD step", [1e-1, 1e-9, 1e-2, 1e-4]))
    assert choice.cheapest(own, 1e-3)["rank"] == 3 and choice.cheapest(own, 1e-2)["rank"] == 1
    assert choice.best(own).error == 1e-4


def test_what_ran_out_of_time_tells_nothing_and_what_crashed_speaks_against():
    assert choice.cheapest(rows(("CD step", [1e-4, "took more than 3 s"])), 1e-3)["rank"] == 0
    assert choice.cheapest(rows(("CD step", [1e-4, "x is not a number"])), 1e-3) is None
    assert choice.cheapest(rows(("CD step", ["took more than 3 s"])), 1e-3) is None
    assert choice.best(rows(("CD step", ["took more than 3 s"]))) is None


def test_damping_has_to_be_right_on_both_sides():
    own = rows(("MD damping", [1.0, 1e-4, 1e-5, 1e-5]))
    assert list(choice.reliable(own, 1e-3)["rank"]) == [2, 3]


def test_one_setting_for_all_scenes_of_a_kind_solves_most_of_them():
    own = rows(("CD step", [1e-5, 1e-5]), ("CD step", [1e-1, 1e-5], None, "loaded_box"))
    _, solved, left = choice.of_kind(own, 1e-3)["CD"]
    assert list(solved["rank"]) == [1, 1] and left == []
    assert choice.of_kind(own, 1e-7) == {}
    _, fastest, _ = choice.of_kind(rows(("CD step", [1e-5, 1e-6], [3.0, 1.0])), 1e-3)["CD"]
    assert list(fastest["rank"]) == [1]


def test_profile_counts_the_scenes_solved_within_a_factor():
    own = rows(("MD step", [1e-3, 1e-5], [4.0, 8.0]), ("CD step", [1e-5], [1.0]), ("MD step", [1e-5], [1.0], "incline"),
               ("CD step", [1e-1], [0.5], "incline"), ("MD step", [1e-9], [1.0], "two_grain_path"))
    found = profile.rows(own)
    assert set(found.scene) == {"stack", "incline"}  # the third is of one method alone
    factors, share = profile.share(found, "MD step", 1e-2)
    assert list(factors) == [1, 4] and list(share) == [0.5, 1]
    factors, share = profile.share(found, "CD, best of all", 1e-2)
    assert list(factors) == [1] and list(share) == [0.5]
    lost, = found[(found.scene == "incline") & (found.series == "CD step") & (found.accuracy == 1e-2)].itertuples()
    assert lost.status and pandas.isna(lost.seconds)


def test_exponent_of_the_cost():
    """Of the larger half of the sizes; the smallest ones may cost what does not grow."""
    own = [("CD nsgs", [1e-5], [2e-6 * size**1.5 if size > 4 else 1.0], "stack", size) for size in (1, 2, 10, 100, 1000, 10000)]
    found = cost_against_size.rows(rows(*own, ("MD step", [1e-1], [1.0], "stack", 10)))
    # Exact but for the rounding of logarithms.
    assert cost_against_size.power(found[found.series == "CD nsgs"]) == pytest.approx(1.5, abs=1e-9)
    assert list(found.status[found.series == "MD step"]) == ["smallest error 0.1"]


@pytest.fixture
def published(tmp_path, monkeypatch):
    """A published table."""
    path = tmp_path / "work_precision.csv"
    publish.write_table(path, rows(("MD step", [1e-1, 1e-2]), ("CD step", [1e-3, 1e-6])))
    monkeypatch.setattr(table, "PUBLISHED", path)
    return ["recommend"]


def test_recommend_names_the_cheapest_setting_and_what_the_other_method_can(published, capsys):
    assert main([*published, "--scene", "stack", "--accuracy", "1e-2"]) == 0
    said = capsys.readouterr().out
    assert "(confirmed by one finer setting)" in said and "(not confirmed: no finer setting has finished)" in said
    assert main([*published, "--scene", "stack", "--accuracy", "1e-4"]) == 0
    said = capsys.readouterr().out
    assert "stack: CD is recommended for an accuracy of 0.0001" in said
    assert "expected error 1e-06, 0.2 s for 10 steps of 4 disks" in said and "MD: not reached; its best is 0.01 in 0.2 s" in said
    assert "run.py scene=stack tolerance=0.1" in said


def test_recommend_counts_no_disks_where_all_motion_is_prescribed(capsys):
    assert main(["recommend", "--scene", "two_grain_path", "--accuracy", "1e-2"]) == 0
    said = capsys.readouterr().out
    assert " steps (" in said and "disks" not in said


def test_recommend_by_own_measurements(tmp_path, capsys):
    publish.write_table(tmp_path / "own.csv", rows(("MD step", [1e-5]), ("CD step", [1e-3])))
    assert main(["recommend", "--scene", "stack", "--accuracy", "1e-4", "--measured", str(tmp_path / "own.csv")]) == 0
    assert "stack: MD is recommended for an accuracy of 0.0001" in capsys.readouterr().out


def test_recommend_says_what_is_missing(published, capsys):
    assert main([*published, "--scene", "stack", "--accuracy", "1e-9"]) == 2
    assert "no measured setting reaches an accuracy of 1e-09; the best is 1e-06" in capsys.readouterr().err
    assert main([*published, "--scene", "nowhere"]) == 2
    said = capsys.readouterr().err
    assert "nowhere: there is no such scene; measured are" in said and "hopper, stack" in said
    with pytest.raises(SystemExit):
        main([*published, "--accuracy", "-1"])
    assert "must be a number above 0" in capsys.readouterr().err


def test_recommend_for_a_flow(published, capsys):
    """By the published study, whose errors have a spread."""
    assert main([*published, "--scene", "filling", "--accuracy", "0.02"]) == 0
    said = capsys.readouterr().out
    assert "filling, 500 disks: rigid contacts, few sweeps are recommended for an accuracy of 0.02 of the height" in said
    assert "standard error" in said and "springs (MD), kn=" in said and "springs in CD, cd_contacts=springs kn=" in said
    assert "Run it: yade -n -x yade_scripts/run.py scene=filling method=CD disks=500 seed=1 cd_dt=" in said
    assert main([*published, "--scene", "drum", "--accuracy", "0.02"]) == 0
    said = capsys.readouterr().out
    assert "whether it is within the accuracy is not certain" in said
    assert "rigid contacts, few sweeps: not reached; the nearest is off by -0.5 %, 1.06 s a run, but finer settings do not confirm it" in said
    assert main([*published, "--scene", "collapse", "--accuracy", "0.02"]) == 0
    assert "springs (MD): not reached; the nearest is off by 4.2 %" in capsys.readouterr().out
    assert main([*published, "--scene", "filling", "--accuracy", "1e-6"]) == 2
    assert "no measured setting reaches an accuracy of 1e-06" in capsys.readouterr().err


def test_recommend_for_each_kind_of_scene(published, capsys):
    assert main([*published, "--accuracy", "1e-3"]) == 0
    assert "piles at rest (1 scene): CD is recommended for an accuracy of 0.001" in capsys.readouterr().out


def measurement(setting, error):
    """The facts of a setting with this error, or of a failed one."""
    lost = isinstance(error, str)
    known = [] if lost else [{"name": "force", "measured": error, "exact": 0.0, "scale": 1.0, "deviation": 0.0}]
    return {"scene": "stack", "row": setting.row, "status": f"failed: {error}" if lost else "finished", "seconds": [] if lost else [0.1, 0.3, 0.2],
            "error": None if lost else error, "steps": 10, "disks": 4, "git_commit": "c" * 40, "yade_version": "2023.02a",
            "processor": "made up"}, known


def test_all_charts_are_drawn_and_say_where_they_come_from(tmp_path, capsys):
    """From measurements of the stack: MD and CD steps, the last of each a failure; and sizes."""
    for name in ("MD step", "CD step"):
        own = [one for one in settings.settings("stack", False) if one.series.name == name and not one.size]
        for rank, setting in enumerate(own):
            store.add(tmp_path / "charts", *measurement(setting, "x is not a number" if rank == len(own) - 1 else 10.0**-rank))
    for setting in settings.settings("stack", False):
        if setting.size:
            store.add(tmp_path / "charts", *measurement(setting, 1e-5))
    folder = tmp_path / "figures"
    folder.mkdir()
    (folder / "work_precision-incline.png").touch()  # of another time
    assert main(["charts", "--results", str(tmp_path), "-o", str(folder)]) == 0
    assert set(capsys.readouterr().out.splitlines()) == {str(folder / f"{name}.png") for name in
                                                         ("work_precision-stack", "profile", "cost_against_size", "by_kind")}
    for name in ("work_precision", "profile", "cost_against_size", "by_kind"):
        found = json.loads((folder / f"{name}.json").read_text())
        assert found["commits"] == ["c" * 40] and all((folder / file).read_bytes().startswith(b"\x89PNG") for file in found["figures"])
    written = table.from_csv(folder / "work_precision.csv")
    row = written[written.error == 0.1].iloc[0]
    assert row.seconds == 0.2 and row.worst == "force" and row.arguments.startswith("scene=stack method=MD ")


@pytest.mark.parametrize("count", (1, 2, 3))
def test_the_panels_of_kinds_stay_logarithmic_and_have_numbers_below(monkeypatch, tmp_path, count):
    """Also where their number is odd, so that one place stays empty."""
    seen, finish = [], style.finish
    monkeypatch.setattr(by_kind.style, "finish", lambda fig, *more: (finish(fig, *more), seen.extend(fig.axes)))
    rows = pandas.DataFrame([{"kind": f"kind {kind}", "accuracy": accuracy, "method": method, "seconds": 1e-2 / accuracy, "solved": 1, "scenes": 1}
                             for kind in range(count) for method in style.COLOUR for accuracy in (1e-3, 1e-1)])
    by_kind.draw(rows, tmp_path, "")
    shown = [axes for axes in seen if axes.get_title()]
    assert len(shown) == count and all(axes.get_xscale() == axes.get_yscale() == "log" for axes in shown)
    lowest = {axes.get_position().x0: axes for axes in sorted(shown, key=lambda axes: -axes.get_position().y0)}
    assert all(axes.get_xlabel() and any(label.get_visible() and label.get_text() for label in axes.get_xticklabels()) for axes in lowest.values())


def test_no_measurements_are_said_so(tmp_path, capsys):
    assert main(["charts", "--results", str(tmp_path), "-o", str(tmp_path / "figures")]) == 2
    assert "profile: " + str(tmp_path / "charts") + ": holds no measured setting; measure some: make charts" in capsys.readouterr().err
    store.add(tmp_path / "charts", *measurement(settings.settings("stack", False)[0], 0.1))
    assert main(["charts", "--results", str(tmp_path), "-o", str(tmp_path / "figures")]) == 0
    said = capsys.readouterr().err
    assert "profile: no scene was measured by both methods\n" in said and "cost_against_size: no scene was measured at several sizes\n" in said


def test_recommended_settings_reach_what_they_promise(tmp_path):
    """Every scene's cheapest setting of each method that takes less than 0.1 s, run anew."""
    promised, found = [], table.one_size(table.from_csv(table.PUBLISHED))
    for (scene, _), own in found.groupby(["scene", "method"], sort=False):
        row = choice.cheapest(own, 1e-2)
        if row is not None and row.seconds < 0.1:
            setting, = (one for one in settings.settings(scene, True)
                        if (one.series.name, one.rank, one.size) == (row.series, row["rank"], 0))
            promised.append(setting.row)
    anew = Yade(tmp_path).code(f"""
from yade_scripts.measuring.charts import measure
measure.LEAST = measure.MOST = 1
print(json.dumps([measure.measure(row, "results", 30, lambda seconds: None)[0] for row in json.loads({json.dumps(json.dumps(promised))})]))
""")
    assert len(anew) == len(promised) > 20
    assert {str(one["row"]): (one["status"], one["error"]) for one in anew if one["status"] != "finished" or one["error"] > 1e-2} == {}
