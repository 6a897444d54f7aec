"""Values in wrong units give a warning; the project's own tables give none."""
import pytest

from analysis import studies
from yade_scripts import parameters
from yade_scripts.running import plausible


@pytest.mark.parametrize("row, words", [
    ({"radius_mean": 10.0, "depth": 50.0}, "in mm"), ({"density": 2.6}, "g/cm"), ({"kn": 2.0}, "MPa"), ({"method": "CD", "cd_dt": 1.0}, "in ms"), ({"scene": "stack", "gravity": 98100.0}, "gravity"),
    ({"scene": "incline", "slope": 0.5236}, "radians"), ({"period": 1e-3}, "like an impact")])
def test_other_units_are_doubted(row, words):
    found = plausible.doubts(parameters.complete(row))
    assert found and words in " ".join(found) and next(name for name in row if name not in ("scene", "method")) in " ".join(found)


@pytest.mark.parametrize("name", studies.names())
def test_no_row_of_ours_is_doubted(name):
    assert [doubt for full in studies.rows(name, False) + studies.rows(name, True) for doubt in plausible.doubts(full)] == []
