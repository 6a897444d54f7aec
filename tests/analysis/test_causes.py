"""The table of causes on the first page, from small tables whose answers are known."""
import numpy as np
import pandas
import pytest

from analysis import causes, publish
from analysis.studies import fig3
from yade_scripts.results.reader import ResultError


def test_spread_counts_what_never_ended_as_longer_than_all():
    assert causes._spread([1, 2, 3, 4, 5]) == "3.00 times (quartiles 2.00 and 4.00; 5 cases)"
    assert causes._spread([1, 2, 3, np.inf, np.inf]) == "3.00 times (quartiles 2.00 and more than was run; 5 cases)"
    assert causes._spread([np.nan]) == causes.NOT_RUN


def test_collapse_counts_packings_that_stand_under_both_as_equal(tmp_path):
    cells = {"springs": (2, 4, 8, None), "rigid": (4, 6, 8, None), "springs, 10 k_n": (2, 4, 8, None), "rigid, packing of 10 k_n": (2, 4, 8, 5)}
    publish.write_table(tmp_path / "collapse.csv", [{"case": case, "dSigma": 0.3, "seed": seed, "collapses after": life}
                                                    for case, lives in cells.items() for seed, life in enumerate(lives)])
    stiffness = causes._stiffness_of_collapse(publish.read_table(tmp_path / "collapse.csv"))
    # 4/2, 6/4, 8/8 and both stand: quantiles of 1, 1, 1.5, 2; with stiff springs 1, 1, 1 and 5 cycles over more than was run.
    assert stiffness == ("cycles that CD stands, over those of springs of k_n: 1.25 times (quartiles 1.00 and 1.62; 4 cases) under dSigma = 0.3; "
                         "over those of springs of 10 k_n: 1.00 times (quartiles 0.75 and 1.00; 4 cases) under dSigma = 0.3 (cycles of 0.5 s)")


def test_a_run_that_only_the_walls_refuse_at_its_end_has_stood(tmp_path):
    """Of three runs of one packing one collapses, one is refused at its end and one in between, which says nothing."""
    refused = "failed: wall stress off its goal by up to 15 % of P0 until t = {} s, 288 of 801 samples off by more than 5 %"
    own = {"preparation_friction": 0.0, "stress_path": "mean", "delta_sigma": 0.3, "seed": 1, "cycles": 40, "method": "CD"}
    publish.write_table(tmp_path / "fig3.csv", [
        {"method": "MD", "stress path": "mean", "preparation friction": 0.0, "dSigma": 0.3, "seed": 1, "static limit": 1.2, "load over limit": 1.3 / 0.7 / 1.5,
         "cycles": 40, "collapses after": 11.0},
        {publish.STATUS: refused.format(20)} | own, {publish.STATUS: refused.format(7.5)} | own])
    found = fig3.standing(publish.read_table(tmp_path / "fig3.csv"))
    assert list(found.method) == ["MD", "CD"] and found["load over limit"].tolist() == pytest.approx(2 * [1.3 / 0.7 / 1.5])
    assert found["collapses after"].isna().tolist() == [False, True]


def test_a_ratio_is_of_the_same_packing():
    rows = pandas.DataFrame([dict(seed=seed, path=path, gamma=gamma) for seed, path, gamma in ((1, "mean", -4.0), (2, "mean", -9.0), (2, "constant", -3.0), (1, "constant", -2.0))])
    ratio = causes._over(rows, "gamma", rows.path == "mean", rows.path == "constant")
    assert ratio.loc[1] == 2 and ratio.loc[2] == 3


def test_studies_not_run_are_named(tmp_path):
    assert {text for texts in causes.table(tmp_path).values() for text in texts} == {causes.NOT_RUN, "not varied"}


def test_a_table_of_another_version_is_named(tmp_path):
    publish.write_table(tmp_path / "fig3.csv", [{"kind": "MD", "seed": 1}])
    with pytest.raises(ResultError, match="fig3.csv.*another version of the study"):
        causes.table(tmp_path)


def test_a_mistake_of_our_own_is_no_table_of_another_version(tmp_path, monkeypatch):
    publish.write_table(tmp_path / "fig4.csv", [{"method": "MD"}])
    monkeypatch.setattr(causes, "CELLS", {"Stress path": (("fig4", lambda rows: None.largest),)})
    with pytest.raises(AttributeError):
        causes.table(tmp_path)


@pytest.mark.parametrize("cause", causes.CELLS)
def test_every_cause_has_a_text_for_each_process(cause):
    assert len(causes.CELLS[cause]) == len(causes.PROCESSES)
