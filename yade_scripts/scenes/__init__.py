"""What can be simulated: one scene a file, each with

    build(full, folder) -> Scene

which fills YADE's O (bodies, engines, dt) from a full row of parameters; `folder` holds the results and, in states/, the prepared packings.
"""
import importlib
import math
from dataclasses import dataclass, field
from typing import Callable

from yade import O

from yade_scripts import bodies, parameters, walls


@dataclass
class Known:
    """A quantity whose exact value is known: `measure()` after the last step against `exact`, both in `unit`."""
    name: str
    unit: str
    exact: float
    measure: Callable[[], float]


@dataclass
class Scene:
    """A scene that stands in O, ready to run.

    every: steps between samples, samples: intervals between them; the scene is over after every * samples steps.
    load: walls.Load, or None where no wall is loaded. law: the functor of MD that sums what its slips dissipate, else None. snapshots: numbers of the samples at which the whole sample is kept.
    extra: arrays that only this scene has, {name: (unit, meaning, array)}; instead of the array a function that gives it after the last
    step. observer: called at every sample.
    """
    every: int
    samples: int
    load: object = None
    law: object = None
    state_sha256: str = ""
    snapshots: set = field(default_factory=set)
    known: list = field(default_factory=list)
    extra: dict = field(default_factory=dict)
    observer: Callable[[], None] = lambda: None

    def __post_init__(self):
        self.snapshots |= {0, self.samples}


def set_step(full, largest):
    """Set O.dt <= largest [s] such that samples fall on whole steps; the number of steps between two."""
    interval = full["period"] / full["records_per_cycle"]
    every = math.ceil(interval / largest * (1 - 1e-12))
    O.dt = interval / every
    return every


def largest_step(full):
    """The largest step [s] of the row's method for the bodies in O."""
    if full["method"] == "CD":
        return full["cd_dt"]
    lightest = min(b.state.mass for b in O.bodies if b.state.blockedDOFs != "xyzXYZ")
    return full["md_dt_factor"] * math.sqrt(lightest / parameters.stiffness(full))


def set_engines(full, scene, goals=None):
    """O.engines of the row's method, walls loaded by goals(t) -> (sigma1, sigma2) [Pa] if given."""
    method(full).set_engines(full, scene, goals)


def load_walls(full, scene, goals):
    """The same for a scene in the biaxial box; its walls x+ and y+ are freed unless a servo moves them."""
    if full["method"] == "CD" or full["md_walls"] == "force":
        walls.set_free(full["wall_mass_ratio"] * bodies.mean_mass())
    set_engines(full, scene, goals)


def method(full):
    """The module md or cd."""
    return importlib.import_module(f"yade_scripts.{full['method'].lower()}")


def small(full, known):
    """The scene around bodies just placed, for scenes without loaded walls: step, engines, and what is known of its end."""
    scene = Scene(every=set_step(full, largest_step(full)), samples=full["records_per_cycle"] * full["cycles"], known=known)
    set_engines(full, scene)
    return scene


def build(full, folder):
    """Build the scene that a full row names."""
    O.reset()
    return importlib.import_module(f"yade_scripts.scenes.{full['scene']}").build(full, folder)
