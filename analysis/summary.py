"""Runs and rows in groups and pairs, for the studies."""

import numpy as np


def finite(values):
    """Return the finite numbers of `values` as an array."""
    values = np.array([value for value in values if not isinstance(value, str)], float)
    return values[np.isfinite(values)]


def groups(items, key):
    """Return {key(item): [items]} in the order of the keys."""
    found = {}
    for item in items:
        found.setdefault(key(item), []).append(item)
    return dict(sorted(found.items()))
