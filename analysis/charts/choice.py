"""Which of the measured settings reach an accuracy, and which of them is the cheapest.

A setting counts as reaching an accuracy only if it and all finer ones of its series do, since an error can pass through zero by chance. Finer
settings that ran out of time are ignored; one that failed for another reason counts against it. The series of damping does not go from coarse to
fine: there the neighbours have to reach the accuracy as well.
"""

import math

from analysis.charts import table

NO_LADDER = ("MD damping",)


def reaches(row, series, accuracy):
    """Tell whether a row of `series` (its rows from coarse to fine) can be relied on to be within `accuracy`."""
    if not _within(row, accuracy):
        return False
    place = series.index(row)
    others = series[max(0, place - 1):place + 2] if row["series"] in NO_LADDER else series[place:]
    return all(_within(other, accuracy) for other in others if not _out_of_time(other))


def _within(row, accuracy):
    return not row["status"] and row["error"] is not None and row["error"] <= accuracy


def _out_of_time(row):
    return "took more than" in row["status"]


def reliable(rows, accuracy):
    """Return the rows of one scene and size that reach the accuracy."""
    return [row for own in table.by_series(rows).values() for row in own if reaches(row, own, accuracy)]


def cheapest(rows, accuracy):
    """Return the fastest of them, or None."""
    return min(reliable(rows, accuracy), key=lambda row: row["seconds"], default=None)


def finer(row, rows):
    """Return how many finer settings of its series confirm a row."""
    return sum(other["series"] == row["series"] and other["rank"] > row["rank"] and not other["status"] for other in rows)


def best_error(rows):
    """Return the smallest accuracy that any setting reaches, and that setting; (inf, None) if none has finished."""
    found = (math.inf, None)
    for own in table.by_series(rows).values():
        for row in own:
            if row["error"] is not None and row["error"] < found[0] and reaches(row, own, row["error"] * (1 + 1e-12)):
                found = (row["error"], row)
    return found


def of_kind(rows, accuracy):
    """Return {method: (setting, series, rows of the scenes that it solves, scenes that it does not)} for scenes of one kind.

    One setting for all: the one that solves most scenes, then the fastest by the geometric mean. Settings are the same where series and rank
    are: time steps of CD are relative to what a scene has of its own.
    """
    scenes = {}
    for row in rows:
        scenes.setdefault(row["scene"], []).append(row)
    solved = {}
    for own in scenes.values():
        for row in reliable(own, accuracy):
            solved.setdefault((row["method"], row["series"], row["rank"]), []).append(row)
    found = {}
    for (method, series, _), own in solved.items():
        rank = (-len(own), math.prod(row["seconds"] for row in own)**(1 / len(own)))
        if method not in found or rank < found[method][0]:
            found[method] = (rank, series, own)
    return {method: (series, own, [scene for scene in scenes if scene not in {row["scene"] for row in own}]) for method, (_, series, own) in found.items()}
