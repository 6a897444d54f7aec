"""Numbers into words for the studies' answers: medians with their range over packings, ratios of paired runs, plain decimals."""

import math

import numpy as np


def number(value, digits=2):
    """A number for a sentence: 0.23, 1.2e-5, 340; 'none' where there is none."""
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "none"
    if value == 0 or 1e-3 <= abs(value) < 1e4:
        return f"{float(f'{value:.{digits - 1}e}'):g}"
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def spread(values, digits=2):
    """The median of the finite values, with their range in brackets where there are several."""
    values = finite(values)
    if not len(values):
        return "none"
    if len(values) == 1 or values.min() == values.max():
        return number(float(values[0]), digits)
    median, low, high = (number(float(choose(values)), digits) for choose in (np.median, np.min, np.max))
    return f"{median} ({low} to {high})"


def between(values):
    """'3', or '3 to 5' where they differ."""
    values = list(values)
    low, high = min(values), max(values)
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"


def percent(share):
    """A share as a percentage: 0.12 %."""
    return f"{number(100 * share)} %"


def finite(values):
    """The finite numbers of `values` as an array."""
    values = np.array([value for value in values if not isinstance(value, str)], float)
    return values[np.isfinite(values)]


def largest(values):
    """The largest absolute value of the finite ones; NaN if there is none."""
    values = np.abs(finite(values))
    return float(values.max()) if len(values) else math.nan


def paired_ratio(above, below, keys, name):
    """|above|/|below| of the column `name`, for rows that agree in the columns `keys`; without pairs whose lower number is 0."""
    partner = {tuple(row[key] for key in keys): row[name] for row in below}
    pairs = [(row[name], partner.get(tuple(row[key] for key in keys))) for row in above]
    return [abs(a / b) for a, b in pairs if b]


def pairs(rows, keys):
    """[(MD row, CD row)] that agree in `keys`."""
    partner = {tuple(row[key] for key in keys): row for row in rows if row["method"] == "CD"}
    return [(row, partner[key]) for row in rows if row["method"] == "MD" and (key := tuple(row[key] for key in keys)) in partner]


def groups(items, key):
    """{key(item): [items]} in the order of the keys."""
    found = {}
    for item in items:
        found.setdefault(key(item), []).append(item)
    return dict(sorted(found.items()))


def commonest(values):
    """The value that occurs most often, the first of several such."""
    values = list(values)
    return max(values, key=values.count)


def count(number_of, what):
    """'1 run', '3 runs'."""
    return f"{number_of} {what}{'' if number_of == 1 else 's'}"
