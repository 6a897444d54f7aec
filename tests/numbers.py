"""Compares the numbers in a text with known values: every number must be known, and be its value rounded to the digits written. Known
numbers stand in the order of the text, so that two that have changed places are found."""
import re
from decimal import Decimal

import numpy as np

NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e-?\d+)?(?![\w])")
# Numbers that are no values: of figures, equations and sections, or in names such as k_n x 10.
NAMES = re.compile(r"(?:Figs?\.|eqs?\.|section|sigma\d|h/2R)\s*[\d.]*|\(\d{4}\)")


def written(text):
    """The numbers of a text, as they stand there."""
    return [found.rstrip(".") for found in NUMBER.findall(NAMES.sub(" ", text))]


def agrees(number, value):
    """Whether a number is the value rounded to the digits that are written."""
    last = Decimal(number).as_tuple().exponent
    return abs(float(number) - float(value)) <= 0.5000001 * 10.0**last


def wrong(text, known, given=()):
    """What is wrong with the numbers of a text: sentences, empty if nothing is."""
    found = [f"{number}: nothing in the tables stands behind it" for number in dict.fromkeys(written(text)) if number not in known
             and number not in given]
    found += [f"{number} is not in the text" for number in known if number not in written(text)]
    first = [number for number in dict.fromkeys(written(text)) if number in known]
    swapped = [pair for pair in zip(first, (number for number in known if number in first)) if pair[0] != pair[1]]
    found += [f"{number} stands where {other} is expected" for number, other in swapped[:1]]
    return found + [f"{number}: the table says {value:g}" for number, values in known.items() for value in np.atleast_1d(values)
                    if not agrees(number, value)]


def misplaced(text, values):
    """What is wrong where the numbers of a text have to be these values one by one, each of them one number or several that are alike."""
    found = written(text)
    if len(found) != len(values):
        return [f"{len(found)} numbers for {len(values)} values: {' '.join(found)}"]
    return [f"{number}, number {place}: the table says {value}" for place, (number, value) in enumerate(zip(found, values), 1)
            if not all(agrees(number, one) for one in np.atleast_1d(value))]
