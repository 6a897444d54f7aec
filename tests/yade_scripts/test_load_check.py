"""Which histories count as a collapse, and which as walls that do not work."""
import pytest

from yade_scripts import parameters
from yade_scripts.running.wall_check import COLLAPSE_STEP, Collapse, LoadCheck, StressError

FULL = parameters.complete({})
P0 = parameters.pressure(FULL)


def ends(samples, length=100, full=FULL):
    """Return (number of the sample that ends a run of `length` intervals, how) or None; samples: (gamma, sigma2 below its goal in P0)."""
    check = LoadCheck(full, length)
    for number, (gamma, off) in enumerate(samples):
        row = dict(time=0.1 * number, gamma=gamma, sigma1=P0, sigma1_goal=P0, sigma2=P0 * (1 - off), sigma2_goal=P0)
        try:
            check.look(row)
        except (Collapse, StressError) as event:
            return number, type(event)
    return None


MOVING = [(-0.004 * k, 0.3) for k in range(12)]


def test_a_sample_that_gives_way_and_stops_has_not_collapsed():
    """A stress off its goal ends a run only if gamma does not change meanwhile; a strain beyond collapse_strain always does."""
    assert ends(MOVING + [(-0.045, 0.0)] * 10) is None
    assert ends(MOVING + [(-0.21, 0.3)]) == (12, Collapse)


@pytest.mark.parametrize("row", [dict(method="CD"), dict(md_walls="force")])
def test_pushed_walls_of_a_sample_that_has_given_way_cannot_lock(row):
    """The packing stops beyond a tenth of collapse_strain, its walls swing, and it yields again. A servo may lock there, too."""
    stops = MOVING + [(-0.045, 0.3)] * 10 + [(-0.21, 0.3)]
    assert ends(stops, full=parameters.complete(row)) == (22, Collapse)
    assert ends(MOVING + [(-0.015, 0.3)] * 10, full=parameters.complete(row)) is None  # it swings back
    assert ends(MOVING + [(-0.015, 1.0)] * 89, full=parameters.complete(row)) == (100, StressError)  # it hangs loose to the end
    swings = [(-0.02 - 0.005 * (k % 2), (0.3, -0.3)[k % 2]) for k in range(101)]
    assert ends(swings, full=parameters.complete(row)) is None  # it yields in every cycle: off in all samples, but not in the mean
    flies = [(-0.021, -5.5), (0.0, -5.5), (-0.3, 0.0)]
    assert ends(flies, full=parameters.complete(row)) == (2, StressError)  # blows above 5 P0 are no collapse, nor is the run complete
    assert ends(stops) == (16, StressError)
    assert ends([(-0.015, 0.3)] * 10, full=parameters.complete(row))[1] is StressError


def test_walls_that_stay_are_locked():
    """The fifth sample in a row off its goal ends the run, whatever the sign; one on its goal resets the count."""
    for off in (0.3, -0.3):
        assert ends([(-1e-4, off)] * 10) == (4, StressError)
    assert ends(([(-1e-4, 0.3)] * 4 + [(-1e-4, 0.0)]) * 3) is None


def test_walls_that_swing_widely_are_locked_too():
    """gamma steps to and fro by far more than COLLAPSE_STEP; only the first swing leaves its former range."""
    swing = [((-1)**k * 5 * COLLAPSE_STEP, 0.9) for k in range(20)]
    assert ends(swing) == (6, StressError)


@pytest.mark.parametrize("growth", [0.011, 0.05])
def test_walls_that_fly_apart_are_no_collapse(growth):
    """Every swing is wider than the last, finally beyond collapse_strain; the excess stress in every other sample shows the cause."""
    assert ends([((-1)**k * growth * (k + 1), 1.0 if k % 2 else -20.0) for k in range(40)])[1] is StressError


def test_a_run_too_short_for_five_misses_is_not_spared():
    """Two intervals give three samples: locked to the end, or off only at the load maximum, as with walls too heavy to follow. In a long run a single
    sample may be off, since more follow."""
    assert ends([(0, 0), (1e-5, 0.5), (1e-5, 0.5)], length=2) == (2, StressError)
    assert ends([(0, 0), (1e-5, 0.2), (1e-5, 0.0)], length=2) == (2, StressError)
    assert ends([(0, 0)] * 10 + [(1e-5, 0.2)] + [(0, 0)] * 10, length=20) is None
