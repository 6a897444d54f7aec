"""Bisection to a boundary in the logarithm of a parameter. Needs no YADE."""
import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Boundary:
    """What a search found: the last good and the first bad value, the reason of the bad side, and what stands in for a boundary
    where there is none ('' otherwise).
    """
    good: float
    bad: float
    reason: str
    note: str = ""

    @property
    def value(self):
        """The geometric mean of the two sides; NaN without a boundary."""
        return math.nan if self.note else math.sqrt(self.good * self.bad)


def bisect(search, probe):
    """The Boundary along a Search. probe(case) -> an object with verdict and reason.

    One crossing is assumed. A map that has more shows them in its cells, and the search ends at one of them.
    """
    good, bad = search.good, search.bad
    first, last = probe(search.case(good)), probe(search.case(bad))
    if first.verdict not in search.accepted:
        return Boundary(good, bad, first.reason, f"{first.reason} already at {good:g}")
    if last.verdict in search.accepted:
        return Boundary(good, bad, "", f"none up to {bad:g}")
    reason = last.reason
    whole = isinstance(search.good, int)
    while max(good, bad) / min(good, bad) > search.precision and not (whole and abs(good - bad) <= 1):
        middle = search.case(math.sqrt(good * bad))[search.along]
        if middle in (good, bad):
            break
        outcome = probe(search.case(middle))
        if outcome.verdict in search.accepted:
            good = middle
        else:
            bad, reason = middle, outcome.reason
    return Boundary(good, bad, reason)
