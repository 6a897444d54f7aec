"""What can be simulated: one scene a file, by MD and by CD where both make sense. Needs no YADE until a scene is built.

A scene's file declares
    TITLE       what is simulated
    KIND        what it is like, in words that several scenes share: charts compare scenes of one kind
    HORIZON     one sentence: over which time the errors of its known quantities mean something
    LEFT_OUT    what the model leaves out, and why that is safe; of a method that it does not have, why
    DEFAULTS    the general parameters' defaults that it changes, {} for none
    build(full, folder)     -> Scene; fills YADE's O (bodies, engines, dt) from a full row of parameters; `folder` holds the results and,
                            in states/, the prepared packings
and where there is need
    METHODS     ("MD",) or ("CD",), where only one of them can run it
    PARAMETERS  the parameters that only it has
    CHART       Chart: what the charts of speed against accuracy try on it; not where nothing exact is known
    check(full)             where values have to fit each other: ParameterError where they do not
and imports what needs YADE inside `build`, so that lists of parameters and charts can read the rest.
"""
import importlib
from dataclasses import dataclass, field
from typing import Callable

from yade_scripts import declared


@dataclass
class Known:
    """A quantity whose value is known: `measure()` after the last step against `exact`, both in `unit`.

    scale: the size [unit] its error is held against, |exact| unless given, 1 where that is 0. source: where the knowledge comes from,
    a formula, a paper, or 'converged: ' with settings and values. deviation: standard deviation of one run [unit], where `exact` is a mean
    over runs that differ by chance: an error is not counted as less. The error of a scene is the largest of its quantities'.
    """
    name: str
    unit: str
    exact: float
    measure: Callable[[], float]
    scale: float | None = None
    source: str = ""
    deviation: float = 0.0

    def __post_init__(self):
        if self.scale is None:
            self.scale = abs(self.exact) or 1.0
        if not self.scale > 0:
            raise ValueError(f"{self.name}: scale = {self.scale!r}, must be above 0")


@dataclass(frozen=True)
class Chart:
    """What the charts of speed against accuracy do differently in a scene.

    base: parameters that the chart changes. patience: times as long as others a run may take. prepared: it starts from a packing that is
    prepared with the row's own springs, which takes long to make stiffer. physics: parameters that are no settings, since the exact answer
    depends on them. rolling: disks roll under load, so that the tangential law may matter. exact: {known: value} where the chart holds
    all laws against one value. sizes: numbers of disks for the cost against the size.
    """
    base: dict = field(default_factory=dict)
    patience: float = 1
    prepared: bool = False
    physics: tuple = ()
    rolling: bool = False
    exact: dict = field(default_factory=dict)
    sizes: tuple = ()


@dataclass
class Scene:
    """A scene that stands in O, ready to run.

    every: steps between samples, samples: intervals between them; the scene is over after every * samples steps (MD makes one more).
    load: walls.Load, or None where no wall is loaded. losses: losses.Losses, in MD. watch: cd.Watch,
    in CD. snapshots: numbers of the samples at which the whole sample is kept.
    extra: arrays that only this scene has, {name: (unit, meaning, array)}; instead of the array a function that gives it after the last
    step. observer: called at every sample. kept: the lists, by name, in which functions of the scene itself keep what they have seen, for
    checkpoints; None: the scene cannot be resumed, as where its functions hold on to objects of YADE, or forces are permanent.
    """
    every: int
    samples: int
    load: object = None
    losses: object = None
    watch: object = None
    state_sha256: str = ""
    snapshots: set = field(default_factory=set)
    known: list = field(default_factory=list)
    extra: dict = field(default_factory=dict)
    observer: Callable[[], None] = lambda: None
    kept: dict | None = None

    def __post_init__(self):
        self.snapshots |= {0, self.samples}


def converged(full, found, same, unit, measure):
    """Return what is known of a scene's mean over many runs, as a list of Known: empty for other sizes, other grains and grains that bounce.

    found: {disks: ({name: (mean, standard deviation of one run)}, how it was found)}. same: {parameter: the value it was found with}.
    measure(name): the quantity of the run in O, in `unit`.
    """
    from yade_scripts import parameters
    if full["disks"] not in found or any(full[name] != value for name, value in same.items()) or parameters.restitution(full) > 0.01:
        return []
    quantities, how = found[full["disks"]]
    return [Known(name, unit, mean, lambda name=name: measure(name), source=f"converged: {how}; standard deviation of one run {deviation}",
                  deviation=deviation)
            for name, (mean, deviation) in quantities.items()]


def names():
    """Return the scenes: the names of the files in this folder."""
    return tuple(declared.names(__name__))


def module(name):
    """Return the file of a scene, with what it need not declare. Raise ParameterError if it lacks what it has to."""
    return declared.load(__name__, name, ("TITLE", "KIND", "HORIZON", "LEFT_OUT", "DEFAULTS", "build"), {"METHODS": ("MD", "CD"), "PARAMETERS": (), "CHART": None})


def method(full):
    return importlib.import_module(f"yade_scripts.running.{full['method'].lower()}")


def build(full, folder):
    """Build the scene of a full row in O. Return its Scene."""
    from yade import O
    from yade_scripts.parameters import ParameterError
    from yade_scripts.running import precision
    precision.check()
    O.reset()
    built = module(full["scene"]).build(full, folder)
    if not isinstance(built, Scene):
        raise ParameterError(f"build() of scene {full['scene']} must return a Scene")
    return built
