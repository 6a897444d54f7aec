"""The load at which a packing yields, from dynamics and from a linear programme without dynamics; and the studies on small runs."""
import numpy as np
import pytest

from analysis.studies import critical_load, indeterminacy


def ramp(yade, **row):
    """A ramp of 60 disks to 2.2 P0, ended soon after it yields."""
    common = dict(loading="ramp", ramp_rate=0.4, period=3, records_per_cycle=300, cd_dt=5e-3, tolerance=1e-8, collapse_strain=0.02, md_walls="force")
    return yade.load(**common | row)


@pytest.fixture(scope="module")
def ramps(yade60):
    return [ramp(yade60, method="CD"), ramp(yade60, method="CD", network_seed=1), ramp(yade60, method="MD")]


def test_cd_yields_at_the_static_limit_of_its_contacts_from_any_network(ramps):
    """2 %: two steps of the ramp, and what a packing of 60 disks gains by the contacts that its first motion closes."""
    own, other, md = critical_load.summarize(ramps)
    assert [other["limit load"], md["limit load"]] == pytest.approx([own["limit load"]] * 2, rel=1e-9)  # one geometry, to the programme's tolerance
    for row in (own, other):
        assert row["load at 0.0001"] == pytest.approx(row["limit load"], rel=0.02)
    assert abs(own["load at 0.0001"] - other["load at 0.0001"]) < 0.01 * own["limit load"]


def test_below_the_limit_only_springs_move(ramps):
    """Creep of the solver against elastic strain: at a tolerance of 1e-8 a hundredth of it and less."""
    own, other, md = critical_load.summarize(ramps)
    assert max(own["gamma at 0.95 limit"], other["gamma at 0.95 limit"]) < 0.01 * md["gamma at 0.95 limit"]


def test_forces_change_where_no_grain_moves(ramps):
    own, _, md = critical_load.summarize(ramps)
    assert own["force change, median"] > 0.3 * md["force change, median"]  # the same load, carried by the same contacts
    assert own["motion over R, median"] < 0.01 * md["motion over R, median"]


def test_studies_draw(ramps, yade60, tmp_path):
    walk = yade60.load(scene="frozen_packing", records_per_cycle=60)
    for study, runs in ((critical_load, ramps), (indeterminacy, [walk])):
        rows = study.summarize(runs)
        study.draw(runs, rows, tmp_path / "study.png")
        assert (tmp_path / "study.png").stat().st_size > 10000
    assert np.isfinite([row["limit load"] for row in critical_load.summarize(ramps)]).all()
