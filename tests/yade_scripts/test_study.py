"""The runner of tables: which rows count as done, and its exit status."""
import errno
import json
import os

import pytest

from yade_scripts import batch, parameters, results, run, tables
from yade_scripts.measuring import regression


@pytest.fixture
def table(tmp_path):
    """Writes a table."""
    def write(text):
        path = tmp_path / "table.txt"
        path.write_text(text)
        return str(path)
    return write


def test_study_runs_reports_failures_and_skips_what_is_finished(yade60, table, capsys):
    """Three rows from one packing, one of which fails (walls too heavy for the load); the second call runs the failed row alone."""
    path = table("description disks method period records_per_cycle md_walls wall_mass_ratio delta_sigma\n"
                 "good 60 MD 0.05 2 servo 20 0.2\nrigid 60 CD 0.05 2 = = =\nheavy 60 MD 0.02 200 force 1e5 0.5\n")
    folder = str(yade60.folder / "results")
    assert batch.main([path, "--jobs", "1", "--results", folder]) == 1
    first = capsys.readouterr()
    assert ".h5: failed: wall stress off" in first.err and first.out.count(": finished") == 2
    rows = [parameters.complete(row) for row in tables.read(path).values()]
    assert [results.finished(results.path_of(row, folder)) for row in rows] == [True, True, False]
    assert batch.main([path, "--jobs", "1", "--results", folder]) == 1
    assert "3 runs, 2 already finished" in capsys.readouterr().out


@pytest.mark.parametrize("made, now, words", [
    ("a" * 40, "a" * 40, None), ("b" * 40, "a" * 40, "(commit bbbbbbbbbbbb; the code is at aaaaaaaaaaaa)"),
    ("a" * 40 + "-dirty", "a" * 40 + "-dirty", "(commit aaaaaaaaaaaa with changes that are not committed or not built)"),
    ("unknown", "unknown", "(commit unknown)")])
def test_results_of_other_code_are_named(tmp_path, monkeypatch, capsys, made, now, words):
    """Two dirty states of one commit may differ, or may not; so may two of which git says nothing."""
    monkeypatch.setattr(batch.provenance, "git_commit", lambda: now)
    monkeypatch.setattr(results, "ending", lambda path: (results.STATUS_FINISHED, made))
    assert batch.work_off(batch.jobs_of([{}], tmp_path), 1) == []
    said = capsys.readouterr()
    assert said.out == "1 run, 1 already finished\n"
    assert said.err == (f"batch: some results may come from other code {words}. Delete a file to run it again.\n" if words else "")
    assert run.execute({}, tmp_path) == 0
    said = capsys.readouterr()
    assert "is already finished" in said.out
    assert said.err == (f"run: it may come from other code {words}. Delete a file to run it again.\n" if words else "")


@pytest.mark.parametrize("text, message", [("seed frction\n1 0.1\n", "did you mean friction"), ("seed\n", "at least one line")])
def test_wrong_table_stops_before_the_first_run(table, capsys, text, message):
    assert batch.main([table(text)]) == 2
    assert message in capsys.readouterr().err


@pytest.mark.parametrize("number, cure", [(errno.ENOSPC, "free some space"), (errno.EDQUOT, "free some space"), (errno.EACCES, "correct this")])
def test_a_folder_that_cannot_be_and_a_full_disk_are_messages(table, tmp_path, monkeypatch, capsys, number, cure):
    path, folder = table("seed\n1\n"), tmp_path / "file"
    folder.touch()
    assert batch.main([path, "--results", str(folder)]) == 2
    assert f"{folder} cannot be used as the folder for results" in capsys.readouterr().err

    def full(job, mode="w"):
        raise OSError(number, os.strerror(number), str(job.log))
    monkeypatch.setattr(batch.Row, "start", full)
    assert batch.main([path, "--results", str(tmp_path / "results")]) == 1
    assert os.strerror(number) in (said := capsys.readouterr().err) and f"; {cure} and give the same command again." in said


def test_a_row_without_result_file_is_a_failure(yade60, table, capsys, tmp_path, monkeypatch):
    """If YADE ends before it can write, the end of the log is shown."""
    (tmp_path / "broken").mkdir()
    (tmp_path / "broken" / "h5py.py").write_text("raise ImportError('libhdf5 is of another version')")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path / "broken"))
    path = table("disks method\n60 CD\n")
    assert batch.main([path, "--results", str(tmp_path / "results")]) == 1
    assert "libhdf5 is of another version" in capsys.readouterr().out


def test_foreign_file_is_no_result(tmp_path):
    path = tmp_path / "x.h5"
    assert results.status(path) is None
    path.write_text("not HDF5")
    assert results.status(path).startswith("failed: ") and not results.finished(path)


def test_regression_sees_a_drift_and_a_failure(monkeypatch, capsys):
    """The comparison itself, with runs replaced: a number inside its tolerance, one outside, NaN, and a failed run."""
    values = {"a": 1.0 + 5e-4, "b": 1.0 + 2e-3, "c": float("nan")}
    monkeypatch.setattr(regression, "run_cases", lambda cases, folder: {"ran": ("file", None), "broke": (None, "it broke")})
    monkeypatch.setattr(regression, "value", lambda path, quantity: values[quantity])
    number = lambda name: {"quantity": name, "value": 1.0, "exact": False, "tolerance": 1e-3, "reason": "test"}
    cases = [{"name": "ran", "numbers": [number("a"), number("b"), number("c")]}, {"name": "broke", "numbers": []}]
    assert regression.compare(cases, "") == 3
    out = capsys.readouterr().out
    assert out.count("DRIFTED") == 2 and "it broke" in out


def test_regression_overwrites_nothing(tmp_path):
    path = tmp_path / "there.json"
    path.write_text("{}")
    assert regression.main(["--record", str(path)]) == 2
    assert path.read_text() == "{}"


def test_stored_numbers_have_reasons_and_runnable_rows():
    for case in json.loads(regression.STORED.read_text())["cases"]:
        parameters.complete(case["row"])
        assert all(number["tolerance"] >= 0 and number["reason"].strip() for number in case["numbers"])
