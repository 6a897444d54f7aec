"""Helpers of the studies: one row for each run, and groups of runs or rows."""
import functools


def each(row):
    """Decorate row(run): return a function summarize(runs) that returns one row for each run."""
    return functools.wraps(row)(lambda runs: [row(run) for run in runs])


def groups(items, key, ordered=True):
    """Return {key(item): [items]} in the order of the keys, or of the items."""
    found = {}
    for item in items:
        found.setdefault(key(item), []).append(item)
    return dict(sorted(found.items())) if ordered else found
