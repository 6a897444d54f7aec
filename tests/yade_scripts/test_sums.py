"""Sums are plain additions in the order of the values, in every Python."""
import math

from yade_scripts.running.sums import total


def test_round_off_is_that_of_additions_from_left_to_right():
    values = [1e16, 1.0, 1.0]
    assert total(values) == (1e16 + 1.0) + 1.0 != math.fsum(values)
    assert total(iter([])) == 0
