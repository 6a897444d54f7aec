"""Finds the measured settings that reach an accuracy, and the cheapest of them.

A setting counts only if it and all finer settings of its series reach the accuracy, since an error can be small by chance. Finer
settings that ran out of time are ignored; one that failed for another reason counts against it. The series of damping does not go from coarse to
fine: there the two neighbours have to reach the accuracy as well.
"""
import math

import numpy as np
import pandas

from analysis.charts import table

NO_LADDER = ("MD damping",)


def reaches(own, accuracy):
    """Return the mask of the rows of a series, from coarse to fine, that reach `accuracy` by this rule."""
    within = (own.status == "") & (own.error <= accuracy)
    agrees = within | own.status.str.contains("took more than")
    if own.series.iloc[0] in NO_LADDER:
        return within & agrees.shift(1, fill_value=True) & agrees.shift(-1, fill_value=True)
    return within & np.logical_and.accumulate(agrees.to_numpy()[::-1])[::-1]


def reliable(rows, accuracy):
    """Return the rows of one scene and size that reach the accuracy."""
    return rows.loc[[index for _, own in table.by_series(rows) for index in own.index[reaches(own, accuracy)]]]


def cheapest(rows, accuracy):
    """Return the fastest row of one scene and size that reaches the accuracy, or None."""
    found = reliable(rows, accuracy)
    return found.loc[found.seconds.idxmin()] if len(found) else None


def fields(row, *names):
    """Return {name: value} of a row, None for each where there is no row."""
    return {name: None if row is None else row[name] for name in names}


def confirming(row, rows):
    """Return how many settings of its series that have finished confirm a setting, and what they are: the finer ones; of damping its neighbours."""
    own = rows[(rows.series == row.series) & (rows.status == "")]
    if row.series in NO_LADDER:
        return int((np.abs(own["rank"] - row["rank"]) == 1).sum()), "neighbouring"
    return int((own["rank"] > row["rank"]).sum()), "finer"


def best(rows):
    """Return the row with the smallest error among those whose finer settings have no larger error; None if there are none."""
    found = [row for _, own in table.by_series(rows) for index, row in own.iterrows() if reaches(own, row.error * (1 + 1e-12))[index]]
    return min(found, key=lambda row: row.error, default=None)


def of_kind(rows, accuracy):
    """Return {method: (series, rows of the scenes that its best setting solves, scenes that it does not solve)} for scenes of one kind.

    The best setting solves most scenes and, among those that solve as many, is the fastest by the geometric mean. Two settings count as the same
    if series and rank are the same, since time steps of CD are relative to the scene's default.
    """
    solved = pandas.concat([reliable(own, accuracy) for _, own in rows.groupby("scene", sort=False)])
    found = {}
    for method, of_method in solved.groupby("method", sort=False):
        settings = [own for _, own in of_method.groupby(["series", "rank"], sort=False)]
        own = min(settings, key=lambda own: (-len(own), math.prod(own.seconds)**(1 / len(own))))
        found[method] = own.series.iloc[0], own, [scene for scene in rows.scene.unique() if scene not in set(own.scene)]
    return found
