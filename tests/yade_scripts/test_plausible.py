"""Values in wrong units give a warning; the project's own tables give none."""
import pytest

from analysis import studies
from yade_scripts import parameters
from yade_scripts.running import plausible


@pytest.mark.parametrize("row, words", [
    ({"radius_mean": 10.0, "depth": 50.0}, "in mm"), ({"density": 2.6}, "g/cm"), ({"kn": 2.0}, "MPa"), ({"method": "CD", "cd_dt": 1.0}, "in ms"),
    ({"scene": "stack", "gravity": 98100.0}, "gravity"),
    ({"scene": "stack", "method": "CD", "cd_dt": 0.05}, "lower records_per_cycle"),
    ({"scene": "stack", "method": "CD", "method_cd": "nsgs", "fixed_iterations": 5}, "no effect with fixed_iterations = 5"),
    ({"method": "MD", "tangential_damping": 1.0, "beta_n": 0.0}, "no effect without normal dashpots"),
    ({"scene": "incline", "slope": 0.5236}, "radians"), ({"period": 1e-3}, "like an impact")])
def test_other_units_are_doubted(row, words):
    found = plausible.doubts(parameters.complete(row))
    assert found and words in " ".join(found) and next(name for name in row if name not in ("scene", "method")) in " ".join(found)


def test_a_value_that_no_row_reads_is_doubted():
    """One that the method of another row reads is that of a table of both methods; a default is none that somebody gave."""
    springs, rigid = (parameters.complete({"scene": "stack", "tolerance": 1e-3, "method": method}) for method in ("MD", "CD"))
    assert plausible.unread([springs]) == ["tolerance = 0.001 has no effect: only method=CD reads it"]
    assert plausible.unread([springs, rigid]) == plausible.unread([parameters.complete({"scene": "stack", "method": "MD"})]) == []


@pytest.mark.parametrize("name", studies.names())
def test_no_row_of_ours_is_doubted(name):
    for rows in (studies.rows(name, False), studies.rows(name, True)):
        assert [doubt for full in rows for doubt in plausible.doubts(full)] + plausible.unread(rows) == []


def test_values_that_a_run_has_not_read_are_named():
    row = {"scene": "stack", "method": "CD", "slope": 20.0, "friction": 0.3, "density": 1.0, "md_walls": "force"}
    full = plausible.Watched(parameters.complete(row))
    assert full["friction"] == 0.3 and (full | {"seed": 2})["density"] == 1.0  # a changed copy counts, too
    assert plausible.ignored(full) == ["slope = 20.0 has no effect in the scene stack"]  # of md_walls `unread` tells


def test_a_seed_without_effect_is_named(yade60):
    """Nothing is drawn in this scene, so runs of other seeds are no other runs. The bookkeeping of a run reads what it stores, which is no effect."""
    said = yade60.script("run.py", "scene=incline", "method=CD", "seed=7", "disks=50", "kn=5e7", "period=0.1").stderr
    assert all(f"{value} has no effect in the scene incline" in said for value in ("seed = 7", "disks = 50", "kn = 50000000.0")), said
