"""The scenes: one file each, simulated by MD and by CD if both make sense. Needs no YADE until a scene is built.

A scene's file declares
    TITLE       what is simulated
    KIND        kind of scene, in words that several scenes share: charts compare scenes of one kind
    HORIZON     one sentence: up to which time the errors of its known quantities mean something; with a full stop
    LEFT_OUT    what the model leaves out, and why that is acceptable; without a full stop
    DEFAULTS    {name: value} for the general parameters whose defaults it changes
    build(full, folder)     -> Scene; puts bodies, engines and time step into YADE's O. full: {name: value} of all parameters. folder: of the
                            results; its subfolder states/ has the prepared packings
and may declare
    METHODS     ("MD",) or ("CD",), if only one of them can run it; then also
    ONLY        why: a clause that ends the sentence 'the scene runs by CD only, since'
    PARAMETERS  the parameters that only this scene has, a tuple of parameter.Parameter
    IN_SPACE    True if its grains are spheres that move in space
    POSITIVE    names of general parameters that must be above 0
    CHART       Chart: what the charts of speed against accuracy vary; only if an exact value is known
    check(full)             raises ParameterError if values of parameters do not fit together
It imports modules that need YADE inside `build`, so that the rest can be read without YADE.
"""
import importlib
from dataclasses import dataclass, field
from typing import Callable

from yade_scripts import declared
from yade_scripts.errors import ParameterError


@dataclass
class Known:
    """A quantity whose exact value is known. `measure()` is called after the last step; its result is compared with `exact`, both in `unit`.
    A run whose result is not finite, as of something that has not happened, counts as failed.

    scale: the error is divided by this [unit]; by default |exact|, or 1 if that is 0. source: where the exact value comes from: a formula,
    a paper, or 'converged: ' with settings and values. deviation: standard deviation of one run [unit] if `exact` is a mean over runs that differ
    by chance; the error then counts as at least this. The error of a scene is the largest error of its quantities.
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

    base: parameters that the chart changes. patience: factor on the time that a run may take. prepared: the scene starts from a packing that is
    prepared with the springs of the row; this takes long for stiff springs. physics: parameters that are not varied, since the exact answer
    depends on them. rolling: disks roll under load, so the tangential law may matter. exact: {known: value}, if the chart compares
    all laws with one value. sizes: numbers of disks for the chart of cost against size.
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
    """A scene that has been built in O and is ready to run.

    every: steps between two samples. samples: number of these intervals; the scene ends after every * samples steps (MD makes one more).
    load: walls.Load, or None if no wall is loaded. snapshots: numbers of the samples at which all disks and contacts are
    stored. known: list of Known.
    extra: quantities of this scene only, {name: (unit, meaning, array)}; a function instead of the array is called after the last
    step. observer: called at every sample. kept: {name: list} of the lists in which the scene's functions collect values; checkpoints store them.
    None if the scene cannot be resumed, because its functions hold objects of YADE or it has permanent forces.
    """
    every: int
    samples: int
    load: object = None
    state_sha256: str = ""
    snapshots: set = field(default_factory=set)
    known: list = field(default_factory=list)
    extra: dict = field(default_factory=dict)
    observer: Callable[[], None] = lambda: None
    kept: dict | None = None

    def __post_init__(self):
        self.snapshots |= {0, self.samples}


def names():
    """Return the scenes: the names of the files in this folder."""
    return tuple(declared.names(__name__))


def module(name):
    """Return the module of a scene, with defaults for what it does not declare. Raise ParameterError if it lacks what it has to declare."""
    file = declared.load(__name__, name, ("TITLE", "KIND", "HORIZON", "LEFT_OUT", "DEFAULTS", "build"),
                         {"METHODS": ("MD", "CD"), "ONLY": "its METHODS say so", "PARAMETERS": (), "POSITIVE": (), "IN_SPACE": False, "CHART": None,
                          "check": lambda full: None})
    if wrong := [one for one in ("METHODS", "PARAMETERS", "POSITIVE") if not isinstance(vars(file)[one], (tuple, list))]:
        raise ParameterError(f"{file.__file__}: {' and '.join(wrong)} must be a tuple; one with a single element ends with a comma: (element,)")
    return file


def method(full):
    return importlib.import_module(f"yade_scripts.running.{full['method'].lower()}")


def build(full, folder):
    """Build the scene of a full row in O. Return its Scene."""
    from yade import O

    import cd_engine
    cd_engine.methods()  # raises ImportError, with the remedy, in a YADE of another precision
    O.reset()
    file = module(full["scene"])
    with declared.located(file.__file__, ImportError):
        built = file.build(full, folder)
    if not isinstance(built, Scene):
        raise ParameterError(f"build() of scene {full['scene']} must return a Scene")
    names = [known.name for known in built.known]
    if wrong := [name for name in (*names, *built.extra) if not name or "/" in name or name == "."]:
        raise ParameterError(f"build() of scene {full['scene']} names a quantity {wrong[0]!r}: take a name without '/', such as v_over_v0")
    if twice := sorted({name for name in names if names.count(name) > 1}):
        raise ParameterError(f"build() of scene {full['scene']} returns more than one Known of the name {', '.join(twice)}: give each its own")
    return built
