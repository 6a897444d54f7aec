"""The deposit of which the column is made, and its collapse."""
import random

import numpy as np
import pytest
from scipy.optimize import nnls

from yade_scripts.running.deposit import deposit


def heap(count, seed, width):
    draw = random.Random(seed)
    radii = np.array([draw.uniform(0.007, 0.013) for _ in range(count)])
    return deposit(radii, width, draw.random), radii


@pytest.mark.parametrize("count, seed, width", [(1, 1, 0.1), (60, 2, 0.03), (60, 3, 5.0), (500, 1, 0.3)])
def test_every_disk_rests_and_none_overlaps(count, seed, width):
    """Rest: pushes of walls, floor and disks that lay there before balance the weight without friction. Contacts to 1e-12 of a radius: each
    position is computed from those it rests on, the error does not add up."""
    place, radii = heap(count, seed, width)
    gaps = np.linalg.norm(place[:, None] - place, axis=2) - radii[:, None] - radii
    np.fill_diagonal(gaps, 1)
    left, right, floor = place[:, 0] - radii, width - place[:, 0] - radii, place[:, 1] - radii
    close = 1e-12 * 0.013
    assert min(gaps.min(), left.min(), right.min(), floor.min()) > -close
    for k in range(count):
        before = np.flatnonzero(np.abs(gaps[k, :k]) < close)
        away = (place[k] - place[before]) / np.linalg.norm(place[k] - place[before], axis=1)[:, None]
        pushes = np.vstack([away, *([way] for way, gap in (((1, 0), left[k]), ((-1, 0), right[k]), ((0, 1), floor[k])) if abs(gap) < close)])
        assert nnls(pushes.T, np.array([0.0, 1.0]))[1] < 1e-9, f"disk {k} does not rest"  # contacts 1e-14 m apart turn a push by 1e-12


def test_same_seed_same_heap():
    assert (heap(100, 5, 0.2)[0] == heap(100, 5, 0.2)[0]).all() and (heap(100, 5, 0.2)[0] != heap(100, 6, 0.2)[0]).any()


def test_disk_wider_than_the_trough_is_refused():
    with pytest.raises(ValueError, match="does not fit between walls"):
        deposit([0.01, 0.1], 0.15, random.random)


def test_column_collapses_to_where_many_did(yade60):
    """Front and height are within three standard deviations of one run, and the heap rests: m g R of one disk in 400."""
    with yade60.run(scene="collapse", disks=400, cd_dt=2e-3, tolerance=1e-2, period=1.2) as file:
        for name, tolerance in (("front", 0.4), ("height", 0.1)):
            known = file[f"known/{name}"]
            assert abs(known[()] - known.attrs["exact"]) < tolerance and "standard deviation" in known.attrs["source"]
        assert file["history/kinetic_energy"][:].max() > 100 > 0.5 > file["history/kinetic_energy"][-1]


def test_columns_nobody_has_measured_have_no_known_answer(yade60):
    """Columns of another shape, with rebound, or that still fall at the end have none; the measured one has."""
    assert yade60.code("""
from yade_scripts import parameters, scenes
rows = (dict(column_aspect=1.0), dict(method="MD", beta_n=0.1), dict(restitution=0.5), dict(period=0.3), dict(gravity=0.2), {})
built = (scenes.build(parameters.complete(dict(scene="collapse", disks=400) | row), "results") for row in rows)
print(json.dumps([[known.name for known in one.known] for one in built]))
""") == [[], [], [], [], [], ["front", "height"]]
