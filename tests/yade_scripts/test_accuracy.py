"""Asking for an accuracy: the search on made-up runs whose error is known, and one in YADE."""
import math

import h5py
import pytest

from yade_scripts import accuracy, parameters, results

ROW = {"scene": "slide_to_roll", "method": "CD"}
OWN = parameters.complete(ROW)["cd_dt"]


def made_up(missed=lambda row: 0, motion=lambda row: 0.0, penetration=0.0):
    """A run whose answer 1 is wrong by 40 steps [s] and 3 tolerances, as a first-order scheme's; it takes 1/cd_dt."""
    def run(row):
        return accuracy.Level(row, {"answer": 1 + 40 * row["cd_dt"] + 3 * row["tolerance"]}, penetration, motion(row), missed(row), 1 / row["cd_dt"])
    return run


@pytest.mark.parametrize("asked", [1e-1, 1e-2, 1e-3, 1e-4])
def test_the_error_is_within_the_accuracy_and_the_search_costs_twice_its_last_run(asked):
    levels = accuracy.search(ROW, asked, made_up())
    last, estimated = levels[-1]
    assert abs(last.values["answer"] - 1) <= asked and estimated <= asked
    assert sum(level.seconds for level, _ in levels) < 2 * last.seconds
    # Not more than the two levels that the next power of two and the estimate by the last change can cost.
    assert len(levels) <= 3 or abs(levels[-3][0].values["answer"] - 1) > asked
    assert [level.row["cd_dt"] for level, _ in levels] == [OWN / 2**k for k in range(len(levels))]
    assert max(level.row["tolerance"] for level, _ in levels) <= accuracy.LOOSEST  # for any accuracy: with a looser tolerance packings creep


def test_levels_that_agree_do_not_count_while_an_event_can_be_stepped_over():
    levels = accuracy.search(ROW, 0.5, made_up(motion=lambda row: row["cd_dt"] / OWN * 3.9))
    assert [math.isinf(error) for _, error in levels] == [True, True, True, False, False]  # 3.9, 1.95, 0.975, 0.49 and 0.24 radii a step


def test_levels_with_missed_steps_do_not_count_and_the_search_gives_up_saying_why():
    assert len(accuracy.search(ROW, 0.5, made_up(missed=lambda row: int(row["cd_dt"] > OWN / 3)))) == 5  # neither of two may have missed steps
    with pytest.raises(accuracy.AccuracyError, match="7 steps miss their tolerance"):
        accuracy.search(ROW, 0.5, made_up(missed=lambda row: 7))


def test_one_agreement_is_luck():
    """Two coarse levels have the same wrong value, as for a disk that jitters under a loose tolerance and never comes to rest."""
    run = made_up()
    wrong = [0.0, 0.0]
    levels = accuracy.search(ROW, 0.01, lambda row: accuracy.Level(row, {"answer": wrong.pop()} if wrong else run(row).values, 0.0, 0.0, 0, 1.0))
    assert [error <= 0.01 for _, error in levels[:3]] == [False, True, False]
    assert abs(levels[-1][0].values["answer"] - 1) <= 0.01


def test_overlap_counts_as_error():
    with pytest.raises(accuracy.AccuracyError, match="its error is about 0.02"):
        accuracy.search(ROW, 0.01, made_up(penetration=0.02))


def test_a_number_that_is_none_is_no_answer():
    with pytest.raises(accuracy.AccuracyError):
        accuracy.search(ROW, 0.5, lambda row: accuracy.Level(row, {"answer": math.nan}, 0.0, 0.0, 0, 1.0))


@pytest.mark.parametrize("row, asked, words", [
    ({"scene": "stack", "method": "MD"}, 1e-3, "only for method = CD"), ({"scene": "stack", "fixed_iterations": 5}, 1e-3, "only for method = CD"),
    ({"scene": "stack", "tolerance": 1e-3}, 1e-3, "tolerance = 0.001: .*leave it out"),
    ({"scene": "stack"}, 2.0, r"must be a number in \[1e-08, 1\)"), ({"scene": "stack"}, math.nan, "must be a number")])
def test_what_cannot_be_asked_for_is_refused(row, asked, words):
    with pytest.raises(parameters.ParameterError, match=words):
        accuracy.check(row, asked)


def test_the_stack_to_an_accuracy_by_one_command(yade60):
    """Fifty disks from no forces at all; the error that counts is that of the result file, against statics."""
    done = yade60.script("accuracy.py", "accuracy=1e-3", "scene=stack", "cd_dt=0.008")
    assert done.returncode == 0, done.stderr
    assert "estimated error" in done.stdout and "tolerance = 2.5e-09: " in done.stdout
    found = [results.status(path) for path in (yade60.folder / "results").glob("stack-CD-*.h5")]
    assert found == ["finished"]
    path, = (yade60.folder / "results").glob("stack-CD-*.h5")
    with h5py.File(path) as file:
        known = file["known/worst_force_error"]
        assert known[()] <= 1e-3 * known.attrs["scale"]
        assert file["history/unconverged_steps"][-1] == 0


def test_a_mistake_is_said_in_a_sentence(yade60):
    for arguments, words in ((["scene=stack"], "accuracy=..."), (["accuracy=1e-3", "scene=stack", "method=MD"], "only for method = CD"),
                             (["accuracy=1e-3", "scene=chain", "fixed_iterations=0"], "no quantity of it has a known value")):
        done = yade60.script("accuracy.py", *arguments)
        assert done.returncode == 2 and words in done.stderr and "Traceback" not in done.stderr
