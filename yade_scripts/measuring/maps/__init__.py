"""Maps of stability: the outcomes of a test (probe) over two parameters, and the boundaries between them. Needs no YADE.

A map is a file of this folder with

    MAP               a Map: its grid, the lines along which a boundary is searched, and the theory of that boundary where there is one
    probe(case)       -> Outcome; it runs inside YADE and imports what needs YADE within its functions
"""
import functools
import json
import math
import pathlib
import time
from collections import namedtuple
from dataclasses import dataclass, field, fields
from typing import Callable

import numpy as np

from yade_scripts import declared, scenes
from yade_scripts.errors import ParameterError
from yade_scripts.measuring import store
from yade_scripts.tables import product

__all__ = ["product"]  # for the maps
FOLDER = "maps"
CASE_SECONDS = 180  # of processor time that a case may take

# Possible results of a probe, from best to worst.
STABLE, INACCURATE, UNSTABLE, NOT_SOLVED = VERDICTS = ("stable", "inaccurate", "unstable", "not solved")
TOLERANCES = {"default of runs": 1e-8, "of the engine": 1e-6}  # marks on an axis of tolerances
SWEEPS = {False: ("accelerated",), True: ("accelerated", "nsgs")}  # methods that the quick and the full maps compare

# Why a case is not stable.
REASONS = {
    "energy growth": "the energy grows without any work done",
    "penetration": "bodies overlap by more than the map allows",
    "wrong motion": "a motion that is known is off by more than the map allows",
    "false motion": "a body moves that must stay at rest",
    "false rest": "a body that must move stays at rest or moves too little",
    "wrong forces": "the forces of a body at rest do not carry its load",
    "tunnelled": "a body passed through a wall that must stop it",
    "locked walls": "walls reverse their motion at most steps and do not carry their load",
    "load missed": "walls follow their load too late",
    "non-convergence": "the solver did not reach its tolerance",
    "refused": "the program ended the run by an error",
    "crashed": "the process ended by itself",
    "timed out": "no answer within the time a case may take",
}


@dataclass(frozen=True)
class Outcome:
    """The result of a probe for one case.

    reason: one of REASONS, '' if the case is stable.
    told: the program's message that something is wrong, '' if there is none. A failure without a message looks like a success to the user.
    measures: {name: number}, with the names that the map declares.
    """
    verdict: str
    reason: str = ""
    told: str = ""
    measures: dict = field(default_factory=dict)

    def __post_init__(self):
        if self.verdict not in VERDICTS or (self.verdict == STABLE) != (self.reason == "") or self.reason not in ("", *REASONS):
            raise ValueError(f"no outcome: {self.verdict!r} because of {self.reason!r}. Verdicts are {', '.join(VERDICTS)}; reasons, of all but the "
                             f"first, {', '.join(REASONS)}")


def judged(measures, told, *failures):
    """Return the Outcome of a case: the first of its `failures` (verdict, reason, whether it is so), else stable, with nothing told."""
    for verdict, reason, so in failures:
        if so:
            return Outcome(verdict, reason, told, measures)
    return Outcome(STABLE, measures=measures)


Axis = namedtuple("Axis", "name label")  # a parameter of a map, and what it is called in the figure


@dataclass(frozen=True)
class Search:
    """A line across a boundary: the parameter `along` runs from `good` to `bad`; `at` holds the values of all others.

    The line is bisected in the logarithm until the two sides are within a factor `precision` (integers: neighbours at most).
    accepted: the verdicts of the good side.
    """
    at: dict
    along: str
    good: float
    bad: float
    precision: float = 1.02
    accepted: tuple = (STABLE,)

    def case(self, value):
        return self.at | {self.along: round(value) if isinstance(self.good, int) else float(f"{value:.6g}")}


def lines(along, good, bad, precision, accepted=(STABLE,), **others):
    """Return a Search along `along` for each product of the values of the `others`."""
    return [Search(at, along, good, bad, precision, accepted) for at in product(**others)]


@dataclass(frozen=True)
class Map:
    """One map. grid(full), searches(full): the quick or the full lists of cases and of lines across the boundary.

    title, question: its heading in the report and what it answers. order: its place there.
    criterion: in words, what makes a case stable, inaccurate or unstable. remedy: what the program does about these failures, or what a user can
    do; a template (analysis/texts.py), in which `cells` is the published table of the map. x, y: axes. The others are optional. panels: the
    parameter with a panel for each value. measures: {name: meaning}, without units.
    theory: function of a case without `theory_along` -> the boundary along it, or NaN. Instead of it a measure `theory` may hold the boundary.
    marks: {label: value on the x axis} of lines to draw, such as a default.
    """
    title: str
    question: str
    criterion: str
    remedy: str
    x: Axis
    y: Axis
    grid: Callable
    searches: Callable
    panels: str = ""
    measures: dict = field(default_factory=dict)
    theory: Callable | None = None
    theory_label: str = ""
    theory_along: str = ""
    marks: dict = field(default_factory=dict)
    order: int = 100


def names(broken=None):
    """Return the names of all maps, in the order of the report. broken: as of declared.readable."""
    return sorted(declared.readable(declared.names(__name__), get, broken), key=lambda name: (get(name).order, name))


@functools.cache
def module(name):
    """Return the file of a map. Raise ParameterError if it lacks what it has to have, has the name of a scene, or axes that are not in its cases;
    ImportError for any other fault of the file."""
    file = declared.load(__name__, name, ("MAP", "probe"), {})
    if name in scenes.names():
        raise ParameterError(f"{file.__file__}: there is a scene of this name, whose chart it would replace: rename the file")
    with declared.located(file.__file__):
        case = file.MAP.grid(False)[0]
    if wrong := [axis for axis in (file.MAP.x.name, file.MAP.y.name, file.MAP.panels) if axis and axis not in case]:
        raise ParameterError(f"{file.__file__}: MAP has axes or panels {', '.join(wrong)}, but its cases have {', '.join(case)}")
    return file


def get(name):
    return module(name).MAP


def logarithmic(low, high, count):
    """Return `count` numbers from low to high, evenly spaced in the logarithm and rounded to three digits."""
    return [float(f"{value:.3g}") for value in np.geomspace(low, high, count)]


def whole(values):
    """Return the values rounded to integers, without repetitions."""
    return list(dict.fromkeys(round(value) for value in values))


def on_line(search, case):
    """Return the value along a Search of a case that lies on it; None for one that does not."""
    return case[search.along] if search.at | {search.along: case.get(search.along)} == case else None


@dataclass(frozen=True)
class Boundary:
    """The result of a search: the last good and the first bad value, the reason of the bad side; note: why there is no boundary, else ''."""
    good: float
    bad: float
    reason: str
    note: str = ""

    @property
    def value(self):
        """The geometric mean of the two sides; NaN if there is no boundary."""
        return math.nan if self.note else math.sqrt(self.good * self.bad)


def bisect(search, probe):
    """Return the Boundary along a Search. probe(case) -> an object with verdict and reason.

    If there are several crossings, the search ends at one of them.
    """
    good, bad = search.good, search.bad
    first, last = probe(search.case(good)), probe(search.case(bad))
    if first.verdict not in search.accepted:
        return Boundary(good, bad, first.reason, f"{first.reason} already at {good:g}")
    if last.verdict in search.accepted:
        return Boundary(good, bad, "", f"none up to {bad:g}")
    reason = last.reason
    while max(good, bad) / min(good, bad) > search.precision:
        middle = search.case(math.sqrt(good * bad))[search.along]
        if middle in (good, bad):  # rounded: there is no value between the two
            break
        outcome = probe(search.case(middle))
        if outcome.verdict in search.accepted:
            good = middle
        else:
            bad, reason = middle, outcome.reason
    return Boundary(good, bad, reason)


class Work:
    """The cases of one map, for the runner, for the process that probes and for the figures."""

    def __init__(self, name, full, results):
        self.name, self.map, self.full, self.folder, self.limit = name, get(name), full, pathlib.Path(results) / FOLDER, CASE_SECONDS

    def find(self, case):
        """Return the stored facts of a case, or None."""
        return store.get(self.folder, store.name_of({"map": self.name, "case": case}))

    def enter(self, case, outcome, seconds):
        measures = {name: float(value) for name, value in outcome.measures.items()}
        store.add(self.folder, {"map": self.name, "case": case, "seconds": seconds} | vars(outcome) | {"measures": measures})

    def failed(self, name, reason, late):
        """Store a case that ended its process as not solved. name: the case as JSON."""
        self.enter(json.loads(name), Outcome(NOT_SOLVED, "timed out" if late else "crashed", reason), 0)

    def measure(self, begun):
        """In YADE: probe the cases of the grid, then those of the searches. Before each case call begun(case as JSON, seconds)."""
        from yade import O

        def probe(case):
            if (known := self.find(case)) is not None:
                return outcome(known)
            begun(json.dumps(case), self.limit)
            started = time.perf_counter()
            O.reset()
            try:
                found = module(self.name).probe(case)
                if not isinstance(found, Outcome):
                    raise TypeError(f"probe() of the map {self.name} must return an Outcome, not {found!r}")
            except RuntimeError as error:  # engines and checks raise it; any other exception is a mistake in the probe
                found = Outcome(NOT_SOLVED, "refused", " ".join(str(error).split()))
            self.enter(case, found, round(time.perf_counter() - started, 3))
            print(f"{self.name}: {json.dumps(case)}: {found.verdict} {found.reason}", flush=True)
            return found

        for case in self.map.grid(self.full):
            probe(case)
        for line in self.map.searches(self.full):
            bisect(line, probe)


def outcome(facts):
    return Outcome(**{one.name: facts[one.name] for one in fields(Outcome)})
