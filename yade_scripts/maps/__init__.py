"""Where the methods fail: maps of what a probe finds over two parameters, and the boundaries between. Needs no YADE.

A map is a module of this package with MAP, a `Map`: the cases of its grid, the lines along which a boundary is searched, and the
theory of that boundary where there is one. The probe of its cases, which runs YADE, has the same name in probes/:

    probe(case) -> Outcome

    /usr/bin/python3 yade_scripts/maps/run.py [--full] [--only NAME]      runs what is missing, into results/maps
"""
import importlib
from dataclasses import dataclass, field
from typing import Callable

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

# In the order of the figures.
ORDER = ("md_contact", "md_packing", "servo", "cd_sweeps", "cd_tolerance", "cd_mass_ratio", "cd_friction", "cd_load_step", "cd_time_step", "cd_impact",
         "tunnelling")


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
        """The case at one point of the line."""
        return self.at | {self.along: round(value) if isinstance(self.good, int) else float(f"{value:.6g}")}


@dataclass(frozen=True)
class Map:
    """One map. grid(full), searches(full): the quick or the full lists of cases and searches.

    x, y: axes; panels: the parameter whose values have a panel each, or ''. measures: {name: (unit, meaning)}.
    criterion: in words, what a case must do to be stable, and what makes it inaccurate or unstable.
    remedy: what the program does about these failures, or what a user has to keep to.
    theory: function of a case without `theory_along` -> the boundary along it, or NaN; where there is none, a measure `theory` may hold it.
    marks: {words: value on the x axis} worth a line, such as a default.
    """
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

    @property
    def parameters(self):
        """Names of the parameters of a case, in their order."""
        return tuple(self.grid(False)[0])


def names():
    """The maps there are."""
    return list(ORDER)


def get(name):
    """The Map of a name."""
    return importlib.import_module(f"{__name__}.{name}").MAP


def product(**values):
    """Cases of all combinations: {name: values} -> list of {name: value}."""
    cases = [{}]
    for name, several in values.items():
        cases = [case | {name: value} for case in cases for value in several]
    return cases


def logarithmic(low, high, count):
    """`count` numbers from low to high, evenly in the logarithm, of three digits."""
    return [float(f"{low * (high / low)**(k / (count - 1)):.3g}") for k in range(count)]
