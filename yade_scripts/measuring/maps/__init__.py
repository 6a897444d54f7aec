"""Where the methods fail: maps of what a probe finds over two parameters, and the boundaries between. Needs no YADE.

A map is a file of this folder with

    MAP               its grid, the lines along which a boundary is searched, and the theory of that boundary where there is one
    probe(case)       -> Outcome, inside YADE: imports what needs YADE within its functions
"""
import functools
import importlib
import json
import math
import pathlib
import time
from dataclasses import dataclass, field
from typing import Callable

from yade_scripts import parameters
from yade_scripts.measuring import store
from yade_scripts.tables import product

__all__ = ["product"]
FOLDER = "maps"
CASE_SECONDS = 180  # of processor time that a case may take

# In the order of the question: what was found of the way a case ended.
STABLE, INACCURATE, UNSTABLE, NOT_SOLVED = VERDICTS = ("stable", "inaccurate", "unstable", "not solved")

# Why a case is not stable.
REASONS = {
    "energy growth": "energy appears that nothing has put in",
    "penetration": "bodies overlap by more than the map allows",
    "wrong motion": "a motion that is known is off by more than the map allows",
    "false motion": "what must rest moves",
    "false rest": "what must move rests, or moves too little",
    "wrong forces": "the forces of a body at rest do not carry its load",
    "tunnelled": "a body is through a wall that must stop it",
    "locked walls": "walls flip to and fro instead of carrying their load",
    "load missed": "walls follow their load too late",
    "non-convergence": "the solver did not reach its tolerance",
    "refused": "the program ended the run by an error",
    "crashed": "the process ended by itself",
    "timed out": "no answer within the time a case may take",
}

@dataclass(frozen=True)
class Outcome:
    """What a probe found of a case.

    told: how the program itself says that something is wrong, '' where it does not; a failure without is one that looks like success.
    measures: {name: number}, the names those of the map.
    """
    verdict: str
    reason: str = ""
    told: str = ""
    measures: dict = field(default_factory=dict)

    def __post_init__(self):
        if self.verdict not in VERDICTS or (self.verdict == STABLE) != (self.reason == "") or self.reason not in ("", *REASONS):
            raise ValueError(f"no outcome: {self.verdict!r} because of {self.reason!r}")


@dataclass(frozen=True)
class Axis:
    """One parameter of a map; `label` is what the figure writes."""
    name: str
    label: str


@dataclass(frozen=True)
class Search:
    """A line across a boundary: `along` runs from `good` to `bad`, everything else is fixed `at`.

    It is bisected in the logarithm until the two sides are within `precision` of each other (integers: neighbours at most).
    accepted: the verdicts of the good side.
    """
    at: dict
    along: str
    good: float
    bad: float
    precision: float = 1.02
    accepted: tuple = (STABLE,)

    def case(self, value):
        """Return the case at one point of the line."""
        return self.at | {self.along: round(value) if isinstance(self.good, int) else float(f"{value:.6g}")}


@dataclass(frozen=True)
class Map:
    """One map. grid(full), searches(full): the quick or the full lists of cases and searches.

    group: heading of the report under which it stands, order: its place there. x, y: axes; panels: the parameter whose values have a panel each, or ''. measures: {name: (unit, meaning)}.
    criterion: in words, what a case must do to be stable, and what makes it inaccurate or unstable.
    remedy: what the program does about these failures, or what a user has to keep to.
    theory: function of a case without `theory_along` -> the boundary along it, or NaN; where there is none, a measure `theory` may hold it.
    marks: {words: value on the x axis} worth a line, such as a default.
    """
    group: str
    title: str
    question: str
    criterion: str
    remedy: str
    x: Axis
    y: Axis
    panels: str
    measures: dict
    grid: Callable
    searches: Callable
    theory: Callable | None = None
    theory_label: str = ""
    theory_along: str = ""
    marks: dict = field(default_factory=dict)
    order: int = 100

    @property
    def parameters(self):
        """Names of the parameters of a case, in their order."""
        return tuple(self.grid(False)[0])


def names():
    """Return the maps there are, in the order of the report."""
    found = [path.stem for path in pathlib.Path(__file__).parent.glob("*.py") if not path.stem.startswith("_")]
    return sorted(found, key=lambda name: (get(name).order, name))


@functools.cache
def module(name):
    """Return the file of a map."""
    return importlib.import_module(f"{__name__}.{name}")


def get(name):
    """Return the Map of a name."""
    return module(name).MAP


def logarithmic(low, high, count):
    """Return `count` numbers from low to high, evenly in the logarithm, of three digits."""
    return [float(f"{low * (high / low)**(k / (count - 1)):.3g}") for k in range(count)]


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
    """Return the Boundary along a Search. probe(case) -> an object with verdict and reason.

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


class Work:
    """The cases of one map, for the runner, the process that probes, and the figures."""

    def __init__(self, name, full, results):
        self.name, self.map, self.full, self.folder, self.limit = name, get(name), full, pathlib.Path(results) / FOLDER, CASE_SECONDS

    def find(self, case):
        """Return what was measured of a case: its facts, or None."""
        return store.get(self.folder, self._file(case))

    def _file(self, case):
        return f"{self.name}-{parameters.digest(case)}"

    def enter(self, case, outcome, seconds, origin):
        """Keep the Outcome of a case."""
        store.add(self.folder, self._file(case), {"map": self.name, "case": case, "seconds": seconds, "verdict": outcome.verdict, "reason": outcome.reason,
                                                  "told": outcome.told, "measures": {name: float(value) for name, value in outcome.measures.items()}} | origin)

    def failed(self, name, reason, late, origin):
        """Enter a case that ended its process; its name is the case as JSON."""
        self.enter(json.loads(name), Outcome(NOT_SOLVED, "timed out" if late else "crashed", reason), 0, origin)

    def measure(self, begun):
        """In YADE: probe the cases of the grid, then along the searches; begun(case, seconds) is called before each."""
        from yade import O

        def probe(case):
            if (known := self.find(case)) is not None:
                return outcome(known)
            begun(json.dumps(case), CASE_SECONDS)
            started = time.perf_counter()
            O.reset()
            try:
                found = module(self.name).probe(case)
            except RuntimeError as error:  # what engines and checks raise; all else is a mistake of the probe
                found = Outcome(NOT_SOLVED, "refused", " ".join(str(error).split()))
            self.enter(case, found, round(time.perf_counter() - started, 3), store.origin())
            print(f"{self.name}: {json.dumps(case)}: {found.verdict} {found.reason}", flush=True)
            return found

        for case in self.map.grid(self.full):
            probe(case)
        for line in self.map.searches(self.full):
            bisect(line, probe)


def outcome(facts):
    """Return the Outcome that was kept."""
    return Outcome(facts["verdict"], facts["reason"], facts["told"], facts["measures"])
