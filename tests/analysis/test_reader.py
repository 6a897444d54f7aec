"""What is read back from result files, and what is refused: damage of any kind, other runs, missing or impossible numbers."""
import errno
import io
import json
import os
import random
import threading

import h5py
import numpy as np
import pytest

from analysis.__main__ import main
from tests.analysis.conftest import history, lattice, write
from yade_scripts import parameters, results
from yade_scripts.results import reader, schema, sealed


def refused(path, *words, read=reader.load):
    """The message of a refusal, which must name the file and hold the words."""
    with pytest.raises(reader.ResultError) as caught:
        read(path)
    message = str(caught.value)
    assert str(path) in message and all(word in message for word in words), message
    return message


def harm(path, change):
    """The file with its content changed by a function of the open file, sealed again: what a mistake of the writer would leave."""
    content = io.BytesIO(path.read_bytes())
    with h5py.File(content, "r+") as file:
        change(file)
    sealed.write(path, content.getvalue())
    return path


def test_a_wrong_name_of_a_quantity_is_told_with_the_right_ones(md):
    run = reader.load(md)
    refused(md, "runs have no quantity 'gama'; did you mean gamma?", read=lambda path: run.values("gama"))
    refused(md, "a run of MD has no iterations; runs of CD have it", read=lambda path: run.values("iterations"))
    run.history["gamma"][:] = np.nan
    refused(md, "/history/gamma has no value; its scene, or its settings, do not measure this", read=lambda path: run.values("gamma"))
    with pytest.raises(KeyError, match="radii; there are .*radius"):
        run.snapshots[0]["radii"]
    with pytest.raises(KeyError, match="height; there are none"):
        run.known["height"]


def test_a_finished_run_is_read_back(md):
    run = reader.load(md)
    assert (run.method, run.pressure, run.parameters["disks"]) == ("MD", 1200.0, 400)
    np.testing.assert_array_equal(run.values("gamma"), history("MD")["gamma"])
    assert [snapshot["time"] for snapshot in run.snapshots] == [0.0, 0.5, 1.0]


def test_any_program_can_open_a_result_file(md):
    with h5py.File(md, "r") as file:
        assert file.attrs["status"] == "finished"


def test_snapshots_come_in_numerical_order(tmp_path):
    small = lattice(3, "MD")
    times = {0.1 * k: small for k in range(12)}
    assert [snapshot["time"] for snapshot in reader.load(write(tmp_path / "run.h5", snapshots=times)).snapshots] == sorted(times)


def test_every_flipped_bit_is_detected(md):
    good, draw = md.read_bytes(), random.Random(1)
    for _ in range(300):
        bad, place = bytearray(good), draw.randrange(len(good))
        bad[place] ^= 1 << draw.randrange(8)
        md.write_bytes(bad)
        refused(md)
        assert results.status(md).startswith("failed: ") and "checksum" in results.status(md)


def test_a_nan_is_found_by_check(tmp_path, capsys):
    columns = history("MD")
    columns["gamma"][7] = np.nan
    path = write(tmp_path / "run.h5", columns=columns)
    assert main(["check", str(path)]) == 1
    assert "/history/gamma is nan at sample 7 (1 of 201 samples)" in capsys.readouterr().out


def test_what_is_not_finite_in_a_snapshot_is_found_by_check(md, capsys):
    """Also in a dataset that the schema does not know; a box that is not there may be NaN in a scene without one only."""
    def spoil(file):
        file["snapshots/0/radius"][3] = np.inf
        file["snapshots/1"]["more"] = [1.0, np.nan]
        file["snapshots/2"].attrs["time"] = np.nan
        file["snapshots/2/box"][:] = np.nan
    harm(md, spoil)
    assert main(["check", str(md)]) == 1
    found = [f"/snapshots/{name} is not finite" for name in ("0/radius", "1/more", "2/box", "2/time")]
    assert "; ".join(found) in capsys.readouterr().out

    def unload(file):
        for name in schema.OF_A_BOX:
            file[f"history/{name}"][:] = np.nan
    harm(md, unload)
    refused(md, "; ".join(found[:2] + found[3:]))
    harm(md, lambda file: file.attrs.__setitem__("finished", False))
    assert reader.load(md, finished=False)


def test_a_run_of_other_parameters_is_not_taken_for_this_one(tmp_path):
    full = parameters.complete(dict(method="MD", delta_sigma=0.3))
    path = results.path_of(full, tmp_path)
    write(path, row=dict(delta_sigma=0.3))
    assert results.finished(path) and reader.load_row(full, tmp_path).finished
    write(path, row=dict(delta_sigma=0.4))
    assert not results.finished(path) and "holds another run than its name says" in results.status(path)
    refused(path, "another run", read=lambda _: reader.load_row(full, tmp_path))


def test_parameters_younger_than_a_file_have_their_defaults(cd):
    younger = json.loads(reader.load(cd).attributes["parameters"])
    full = parameters.complete(dict(younger))
    del younger["flow_tolerance"]
    harm(cd, lambda file: file.attrs.__setitem__("parameters", json.dumps(younger)))
    assert "flow_tolerance" not in reader.load(cd).parameters
    path = cd.rename(results.path_of(full, cd.parent))
    assert reader.load_row(full, path.parent).parameters == full


def test_a_result_of_a_removed_scene_is_listed_with_the_reason(md, cd, capsys):
    harm(md, lambda file: file.attrs.__setitem__("parameters", '{"scene": "spin_drop"}'))
    assert main(["check", str(md), str(cd)]) == 1
    said = capsys.readouterr().out.splitlines()
    assert said[0].startswith(f"{md}: the present program refuses the parameters stored in this file: scene = 'spin_drop': must be one of")
    assert f"{cd}: finished" in said[1]
    path = md.rename(results.path_of(parameters.complete({}), md.parent))
    refused(path, "spin_drop", read=lambda _: reader.load_row(parameters.complete({}), path.parent))


def test_a_file_without_its_history_is_not_finished(tmp_path):
    path = results.path_of(parameters.complete({}), tmp_path)
    write(path)
    harm(path, lambda file: file.__delitem__("history"))
    assert not results.finished(path)
    refused(path, "/history lacks time")
    write(path, columns={name: values[:0] for name, values in history("MD").items()})
    assert not results.finished(path)


def test_what_is_no_file_is_said_in_a_sentence(tmp_path):
    refused(tmp_path / "none.h5", "there is no such file", "make study")
    fifo, folder = tmp_path / "fifo.h5", tmp_path / "folder.h5"
    os.mkfifo(fifo)
    folder.mkdir()
    answer = []
    for path, words in ((fifo, "not a regular file, move it away"), (folder, "is a folder")):
        asked = threading.Thread(target=lambda: answer.append(results.status(path)), daemon=True)
        asked.start()
        asked.join(30)
        assert answer and words in answer.pop()
        refused(path, words)


def test_what_was_never_a_result_is_not_called_damaged(tmp_path, md, root):
    """It may be somebody's only copy; a result that was cut off is one that can be made again. One that no longer says so cannot be told from it."""
    other, latest = tmp_path / "other.h5", tmp_path / "latest.h5"
    for path, version in ((other, "earliest"), (latest, "latest")):
        with h5py.File(path, "w", libver=version) as file:
            file["W"] = np.eye(2)
    sealed.write(tmp_path / "sealed.h5", other.read_bytes())  # as measurements are
    (tmp_path / "unmarked.h5").write_bytes(md.read_bytes().replace(reader.MARK, b"x" * len(reader.MARK)))
    for path in (root / "README.md", root / "yade_scripts/results/schema.py", other, latest, tmp_path / "sealed.h5", tmp_path / "unmarked.h5"):
        assert refused(path) == f"{path}: is no result of this project; if it was one, it is damaged: make it again"
    whole = md.read_bytes()
    for length in (100, 700, 2000, len(whole) - 100, len(whole) - 1):
        md.write_bytes(whole[:length])
        refused(md, "is damaged", "run it again")


def test_a_file_that_must_not_be_read_is_not_to_be_run_again(md, monkeypatch):
    def denied(path):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
    monkeypatch.setattr(sealed.pathlib.Path, "read_bytes", denied)
    assert refused(md) == f"{md}: cannot be read (Permission denied)"


def test_failed_and_unfinished_runs_give_their_reason(tmp_path, md):
    path = write(tmp_path / "run.h5", finished=False, status="failed: walls locked")
    refused(path, "did not finish", "failed: walls locked")
    assert reader.load(path, finished=False).attributes["status"] == "failed: walls locked"
    refused(write(tmp_path / "two.h5", finished=True, status="failed: walls locked"), "did not finish")
    refused(md.rename(md.with_suffix(reader.PARTIAL_SUFFIX)), "under way or was interrupted")


@pytest.mark.parametrize("change, words", [
    (lambda file: file["history/sigma2"].attrs.__setitem__("unit", "kPa"), ("/history/sigma2", "'kPa'", "'Pa'")),
    (lambda file: file.__delitem__("history/strain1"), ("/history lacks strain1",)),
    (lambda file: file["snapshots/1"].__delitem__("force_normal"), ("/snapshots/1 lacks force_normal",)),
    (lambda file: file.attrs.__setitem__("method", "ED"), ("'ED'", "MD, CD")),
    (lambda file: file.attrs.__setitem__("schema_version", 99), ("version is 99",)),
    (lambda file: file.attrs.__setitem__("parameters", "{"), ("no result file",))])
def test_a_file_that_the_writer_got_wrong(md, change, words):
    refused(harm(md, change), *words)


def test_fields_of_different_length(tmp_path):
    columns = history("MD")
    columns["gamma"] = columns["gamma"][:-1]
    refused(write(tmp_path / "run.h5", columns=columns), "differ in length")


def add_known(path, name, measured, **attributes):
    harm(path, lambda file: file.create_dataset(f"known/{name}", data=measured).attrs.update(
        {"unit": "m", "scale": 1.0, "source": "", "deviation": 0.0} | attributes))


def test_a_known_quantity_without_its_exact_value_is_refused(md):
    add_known(md, "way", 2.5)
    refused(md, "/known/way lacks exact")


def test_error_of_a_run_is_the_largest_of_what_is_known(md):
    assert np.isnan(reader.load(md).error)
    add_known(md, "way", 2.5, exact=2.0, scale=10.0, source="a formula")
    add_known(md, "height", 0.01, exact=0.0, scale=0.5, source="balance")
    run = reader.load(md)
    assert run.known["way"] == reader.Known(2.5, exact=2.0, unit="m", scale=10.0, source="a formula")
    assert run.error == run.known["way"].error == pytest.approx(0.05)
    add_known(md, "lost", np.nan, exact=1.0)
    assert reader.load(md).error == np.inf


def test_summary_says_what_is_known(md, capsys):
    add_known(md, "way", 2.5, exact=2.0, scale=10.0)
    add_known(md, "share", 0.5, exact=0.5, unit="1")
    assert main(["summary", str(md)]) == 0
    assert capsys.readouterr().out.splitlines()[-2:] == [f"{md.name}: share: 0.5, exact 0.5, error 0",
                                                         f"{md.name}: way: 2.5 m, exact 2 m, error 0.05"]


def test_names_of_the_schema_have_units():
    assert all(field.unit for field in schema.HISTORY.values())
