"""Runs and rows in groups, for the studies."""
import functools


def each(row):
    """Turn row(run) into a summary that has one row a run."""
    return functools.wraps(row)(lambda runs: [row(run) for run in runs])


def groups(items, key, ordered=True):
    """Return {key(item): [items]} in the order of the keys, or of the items."""
    found = {}
    for item in items:
        found.setdefault(key(item), []).append(item)
    return dict(sorted(found.items())) if ordered else found
