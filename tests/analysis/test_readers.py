"""Damaged files of every kind are refused in one sentence, or do no harm; see tests/readers.py."""
import h5py
import pytest

from analysis import load
from tests import readers

from .conftest import write


@pytest.mark.parametrize("name", readers.READERS)
def test_damaged_files(tmp_path, name):
    readers.feed(name, tmp_path, 150)


@pytest.mark.parametrize("name, value", [("status", 3), ("parameters", 1.5), ("parameters", "[]"), ("finished", "yes"), ("pressure", "much"),
                                         ("method", [1, 2]), ("seed", "two"), ("outcome", 7)])
def test_attributes_of_another_kind(tmp_path, name, value):
    path = write(tmp_path / "run.h5")
    with h5py.File(path, "r+") as file:
        file.attrs[name] = value
    with pytest.raises(load.ResultError, match=name):
        load.load(path)


def unit(name):
    def harm(file):
        del file[name].attrs["unit"]
    return harm


@pytest.mark.parametrize("harm, words", [
    (lambda file: file.create_group("snapshots/one"), "/snapshots/one"), (lambda file: file.__setitem__("snapshots/7", 1.0), "not a result file"),
    (lambda file: file.__setitem__("known/x", [1.0, 2.0]), "not a result file"), (lambda file: file["history/gamma"].attrs.__setitem__("unit", 5), "gamma is in '5'"),
    (unit("snapshots/0/position"), "/snapshots/0/position has no attribute 'unit'")])
def test_parts_of_another_kind(tmp_path, harm, words):
    path = write(tmp_path / "run.h5")
    with h5py.File(path, "r+") as file:
        harm(file)
    with pytest.raises(load.ResultError, match=words):
        load.load(path)
