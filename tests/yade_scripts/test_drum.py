"""The profile of velocity in a drum, of beds whose motion is known."""
import math
from types import SimpleNamespace

import numpy as np
import pytest

from yade_scripts.scenes import drum

DEPTHS = np.arange(-0.15, 1.0, 0.1)  # [m], of layers 0.1 m thick


def profile(velocity, slope):
    """Return the mean velocities in the layers and the numbers of disks, of disks at random places with velocity(x, y) [m/s]."""
    found, moved = [0.0] * len(DEPTHS), [0.0] * len(DEPTHS)
    places = np.random.default_rng(1).uniform(-1.5, 1.5, (20000, 2)).tolist()
    states = [SimpleNamespace(pos=(*place, 0), vel=(*velocity(*place), 0)) for place in places]
    deep = np.array((math.sin(slope), -math.cos(slope)))
    for _ in range(2):  # a second look adds to the first
        drum._add_speeds(states, deep, 0.25, DEPTHS, found, moved)
    return np.array(moved) / found, np.array(found)


@pytest.mark.parametrize("slope", (0.0, 0.4, -0.3))
def test_a_bed_that_turns_with_the_drum_goes_up_the_slope_the_faster_the_deeper(slope):
    speed, found = profile(lambda x, y: (-y, x), slope)  # 1 rad/s about the axis
    # The mean depth of `found` / 2 disks in a layer, 0.1 m thick, has a standard deviation of 0.1 / sqrt(12 found / 2).
    assert (found > 150).all() and (abs(speed + DEPTHS) < 5 * 0.1 / np.sqrt(6 * found)).all()


@pytest.mark.parametrize("slope", (0.0, 0.4, -0.3))
def test_disks_that_slide_down_the_slope_have_a_positive_velocity(slope):
    """Down is where the axis lies to the left of the bed's centre of mass: towards -x for a slope that rises to +x."""
    speed, found = profile(lambda x, y: (-2 * math.cos(slope), -2 * math.sin(slope)), slope)
    assert speed == pytest.approx(2)


def test_only_the_middle_of_the_bed_counts():
    speed, found = profile(lambda x, y: (0 if abs(x) < 0.25 else -1e6, 0), 0.0)
    assert (found > 0).all() and not speed.any()
