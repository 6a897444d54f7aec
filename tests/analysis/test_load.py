"""Every kind of bad result file is refused with its file, the reason and a remedy."""

import os

import h5py
import numpy as np
import pytest

from analysis import load, schema
from tests.analysis.conftest import history, write
from yade_scripts import parameters


def refused(path, *words):
    """The message of load(path), which must name the file and hold the words."""
    with pytest.raises(load.ResultError) as caught:
        load.load(path)
    message = str(caught.value)
    assert str(path) in message
    for word in words:
        assert word in message
    return message


def test_finished_run_is_read_back(md):
    run = load.load(md)
    assert (run.method, run.pressure, run.parameters["disks"]) == ("MD", 1200.0, 400)
    np.testing.assert_array_equal(run.values("gamma"), history("MD")["gamma"])
    assert [snapshot["time"] for snapshot in run.snapshots] == [0.0, 0.5, 1.0]


def test_snapshots_come_in_numerical_order(tmp_path):
    times = {0.1 * k: write_small() for k in range(12)}
    run = load.load(write(tmp_path / "run.h5", snapshots=times))
    assert [snapshot["time"] for snapshot in run.snapshots] == sorted(times)


def write_small():
    """One disk, no contact."""
    sizes = {"n": 1, "m": 0}
    return {name: np.zeros([sizes.get(length, length) for length in field.shape]) for name, field in schema.SNAPSHOT.items()}


def test_missing_file(tmp_path):
    refused(tmp_path / "none.h5", "no such file", "make study")


@pytest.mark.parametrize("share", [0.999, 0.5, 0.01])
def test_truncated_file(md, share):
    os.truncate(md, int(md.stat().st_size * share))
    refused(md, "truncated", "run it again")


def test_damaged_file(md):
    with open(md, "r+b") as file:
        file.seek(8)
        file.write(b"\xff" * 512)
    refused(md, "damaged")


def test_foreign_files(tmp_path):
    text = tmp_path / "text.h5"
    text.write_text("time gamma\n0 0\n")
    refused(text, "not a readable HDF5 file")
    empty = tmp_path / "empty.h5"
    empty.touch()
    refused(empty, "not a readable HDF5 file")
    other = tmp_path / "other.h5"
    with h5py.File(other, "w") as file:
        file["W"] = np.eye(2)
    refused(other, "root attributes missing", "schema_version", "yade_scripts/run.py")


def test_failed_run_gives_its_reason(tmp_path):
    path = write(tmp_path / "run.h5", finished=False, status="failed: walls locked")
    refused(path, "did not finish", "failed: walls locked")
    assert load.load(path, finished=False).attributes["status"] == "failed: walls locked"


def test_file_that_contradicts_itself_is_no_success(tmp_path):
    refused(write(tmp_path / "run.h5", finished=True, status="failed: walls locked"), "did not finish")
    refused(write(tmp_path / "two.h5", finished=False, status=schema.STATUS_FINISHED), "did not finish")


def test_unfinished_run(md):
    partial = md.rename(md.with_suffix(load.PARTIAL_SUFFIX))
    refused(partial, "unfinished", "start the run again")


@pytest.mark.parametrize("harm, words", [
    (lambda file: file["history/gamma"].attrs.__delitem__("unit"), ("/history/gamma", "no attribute 'unit'", "'1'")),
    (lambda file: file["history/sigma2"].attrs.__setitem__("unit", "kPa"), ("/history/sigma2", "'kPa'", "'Pa'")),
    (lambda file: file.__delitem__("history/strain1"), ("/history/strain1 missing",)),
    (lambda file: file.__delitem__("history"), ("group /history missing",)),
    (lambda file: file["snapshots/1"].__delitem__("force_normal"), ("/snapshots/1/force_normal missing",)),
    (lambda file: file["snapshots/1"].attrs.__delitem__("cycle"), ("/snapshots/1", "'cycle'")),
    (lambda file: file.attrs.__delitem__("git_commit"), ("git_commit",)),
    (lambda file: file.attrs.__setitem__("method", "ED"), ("'ED'", "MD, CD")),
    (lambda file: file.attrs.__setitem__("schema_version", 99), ("version 99",)),
    (lambda file: file.attrs.__setitem__("parameters", "{"), ("'parameters'", "JSON")),
])
def test_harmed_file(md, harm, words):
    with h5py.File(md, "r+") as file:
        harm(file)
    refused(md, *words)


def test_fields_of_different_length(tmp_path):
    columns = history("MD")
    columns["gamma"] = columns["gamma"][:-1]
    refused(write(tmp_path / "run.h5", columns=columns), "differ in shape", "gamma (200,)")


def test_snapshot_arrays_must_agree(md):
    with h5py.File(md, "r+") as file:
        group = file["snapshots/0"]
        shorter = group["force_normal"][:-1]
        del group["force_normal"]
        group["force_normal"] = shorter
    refused(md, "/snapshots/0/", "shape")


def test_cd_must_have_its_residual(tmp_path):
    columns = history("CD")
    del columns["residual"]
    refused(write(tmp_path / "run.h5", "CD", columns), "/history/residual missing")


def test_nan_is_named_where_it_is_used(tmp_path):
    columns = history("MD")
    columns["gamma"][7] = np.nan
    run = load.load(write(tmp_path / "run.h5", columns=columns))
    with pytest.raises(load.ResultError, match=r"gamma is nan at sample 7 \(1 such of 201\)"):
        run.values("gamma")


def test_pair_in_either_order(md, cd):
    for files in ((md, cd), (cd, md)):
        assert [run.path for run in load.pair(*files)] == [md, cd]


def test_pair_of_one_method(md):
    with pytest.raises(load.ResultError, match="both are MD runs"):
        load.pair(md, md)


@pytest.mark.parametrize("change, word", [
    (dict(state_sha256="00" * 32), "state_sha256"),
    (dict(row=dict(delta_sigma=0.3)), r"delta_sigma \(0.2 and 0.3\)"),
])
def test_pair_that_is_not_comparable(md, tmp_path, change, word):
    other = write(tmp_path / "other.h5", "CD", **change)
    with pytest.raises(load.ResultError, match="not comparable.*" + word):
        load.pair(md, other)


def test_settings_of_one_method_may_differ(md, tmp_path):
    load.pair(md, write(tmp_path / "other.h5", "CD", row=dict(tolerance=1e-4)))


def test_mixed_commits_only_on_request(md, tmp_path):
    other = write(tmp_path / "other.h5", "CD", git_commit="d" * 40)
    with pytest.raises(load.ResultError, match="different commits"):
        load.pair(md, other)
    assert load.pair(md, other, mixed_commits=True)[1].path == other


def test_newest_pair(md, cd, tmp_path):
    newer = write(tmp_path / "b-CD.h5", "CD", row=dict(tolerance=1e-4))
    write(tmp_path / "c-CD.h5", "CD", row=dict(delta_sigma=0.3))
    write(tmp_path / "d-CD.h5", "CD", finished=False, status="failed: x")
    for age, path in enumerate((newer, cd, md)):
        os.utime(path, (1e9 - age, 1e9 - age))
    os.utime(md, (2e9, 2e9))
    assert [run.path for run in load.newest_pair(tmp_path)] == [md, newer]


def test_no_pair(md, tmp_path):
    with pytest.raises(load.ResultError, match="1 finished MD and 0 finished CD.*make study"):
        load.newest_pair(tmp_path)


def test_pair_of_a_table(tmp_path):
    table = tmp_path / "two.txt"
    table.write_text("description method delta_sigma\na 'MD' 0.3\nb 'CD' 0.3\n")
    paths = [write(tmp_path / (parameters.result_name(parameters.complete(row)) + ".h5"), row["method"], row=row)
             for row in (dict(method="MD", delta_sigma=0.3), dict(method="CD", delta_sigma=0.3))]
    assert [run.path for run in load.pair_of_table(table, tmp_path)] == paths
    paths[1].unlink()
    with pytest.raises(load.ResultError, match="no such file"):
        load.pair_of_table(table, tmp_path)


@pytest.mark.parametrize("text, word", [
    ("method\n'MD'\n", "holds 1 rows"), ("method delta\n'MD' 1\n'CD' 1\n", "unknown parameter 'delta'"), ("", "a table is")])
def test_table_that_is_no_pair(tmp_path, text, word):
    table = tmp_path / "bad.txt"
    table.write_text(text)
    with pytest.raises(load.ResultError, match=word):
        load.pair_of_table(table, tmp_path)


def add_known(path, name, measured, **attributes):
    with h5py.File(path, "r+") as file:
        file.create_dataset(f"known/{name}", data=measured).attrs.update({"unit": "m"} | attributes)


def test_error_of_a_run_is_the_largest_of_what_is_known(md):
    assert np.isnan(load.load(md).error)
    add_known(md, "way", 2.5, exact=2.0, scale=10.0, source="a formula")
    add_known(md, "height", 0.01, exact=0.0, scale=0.5, source="balance")
    run = load.load(md)
    assert run.known["way"] == load.Known(2.5, 2.0, "m", 10.0, "a formula")
    assert run.error == run.known["way"].error == pytest.approx(0.05)


@pytest.mark.parametrize("exact, scale", [(-4.0, 4.0), (0.0, 1.0)])
def test_files_from_before_scales_are_read(md, exact, scale):
    add_known(md, "way", 3.0, exact=exact)
    assert load.load(md).known["way"] == load.Known(3.0, exact, "m", scale, "")


def test_a_measured_number_that_is_none_is_infinitely_wrong(md):
    add_known(md, "way", np.nan, exact=1.0, scale=1.0, source="")
    add_known(md, "height", 1.0, exact=1.0, scale=1.0, source="")
    assert load.load(md).error == np.inf
