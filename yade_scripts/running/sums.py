"""Sums that are the same bits in every Python."""
import functools
import operator


def total(values):
    """Return the sum from left to right. The built-in one is that up to Python 3.11; from 3.12 on it makes up for round-off, and a packing would be another."""
    return functools.reduce(operator.add, values, 0)
