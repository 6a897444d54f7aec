"""Sums with the same bits in every version of Python."""
import functools
import operator


def total(values):
    """Return the sum from left to right. The built-in sum corrects round-off from Python 3.12 on, which would change the packings."""
    return functools.reduce(operator.add, values, 0)
