"""Which settings the charts of speed against accuracy try: per scene, series of rows from coarse to fine. Needs no YADE.

A series varies one thing about the scene's own defaults and keeps the rest. The time that an MD step may take shrinks with the root of the
stiffness, so the series of stiffness costs more and more; damping costs nothing, and its series goes nowhere.
"""
from dataclasses import dataclass, field

from yade_scripts import parameters, scenes

# Scenes that have no chart: no exact value (biaxial, frozen_packing), or one that is about the number of sweeps itself (chain).
WITHOUT = ("biaxial", "frozen_packing", "chain")
# What a chart changes in a scene: the collapse is known for 400 disks, and 4000 would take minutes a run.
BASE = {"collapse": {"disks": 400}}
# By how much longer than others a scene's runs may take.
PATIENCE = {"collapse": 2, "yield_ramp": 2}
# Scenes that start from a packing prepared with the row's own springs: it takes long to make them stiffer, and damping makes another packing.
PREPARED = ("packing_at_rest", "elastic_step", "yield_ramp")
# What is no setting in a scene, since the exact answer depends on it: in MD damping is the restitution.
PHYSICS = {"bounce": ("beta_n",), "zeno": ("beta_n",), "cradle": ("beta_n",), "thin_wall": ("beta_n",), "two_grain_path": ("stiffening", "beta_n"),
           "collapse": ("beta_n",), **dict.fromkeys(PREPARED, ("beta_n",))}
# Scenes in which disks roll on or around each other under load, so that the tangential law can matter; against walls there is one law.
ROLLING = ("two_grain_path", "arch", "pyramid", "elastic_step", "yield_ramp", "collapse")
# Of a scene that holds each law against its own theory: what springs without a memory leave.
EXACT = {"two_grain_path": {"left_force": 0.0, "loop_work": 0.0}}
# Scenes for the cost against the number of disks: numbers tried.
SIZES = {"stack": (4, 16, 64, 256), "loaded_box": (25, 100, 400, 1600, 6400), "elastic_step": (60, 240, 960)}
SCALED = ("MD step", "CD accelerated", "CD nsgs")  # series tried at every size


ACCURACY = "accuracy"  # yade_scripts/accuracy.py instead of run.py


@dataclass(frozen=True)
class Series:
    """Rows of one method from coarse to fine; `every` second one in a quick chart.

    costlier: a finer row takes longer, so none is tried behind one that ran out of time.
    """
    name: str
    method: str
    parameter: str
    values: tuple
    fixed: dict = field(default_factory=dict)
    relative: bool = False  # values are multiples of the scene's own
    costlier: bool = True

    def rows(self, scene, quick):
        """The rows for a scene, each {parameter: value} with its method."""
        own = parameters.complete({"scene": scene})[self.parameter] if self.relative else 1
        values = self.values[::-1][::2][::-1] if quick else self.values
        return [{"scene": scene, "method": self.method} | BASE.get(scene, {}) | self.fixed | {self.parameter: value * own if self.relative else value}
                for value in values]


@dataclass(frozen=True)
class Setting:
    """One row of a series: rank 0 is the coarsest; size: number of disks where that is varied, else 0."""
    series: str
    rank: int
    row: tuple
    size: int = 0
    costlier: bool = True

    @property
    def full(self):
        """All parameters."""
        return parameters.complete(split(dict(self.row))[0])

    @property
    def name(self):
        """That of the record."""
        return name(dict(self.row))


def split(row):
    """(the row of parameters, the accuracy asked for or None): rows of the series that asks for one have it as a value."""
    own = {name: value for name, value in row.items() if name != ACCURACY}
    return own, row.get(ACCURACY)


def name(row):
    """Of a record: scene, method and hash, as of a result file, and the accuracy where one is asked for."""
    own, asked = split(row)
    return parameters.result_name(parameters.complete(own)) + (f"-{ACCURACY}-{asked:g}" if asked else "")


STEPS = (0.8, 0.4, 0.2, 0.1, 0.05, 0.02, 0.01)
STIFFER = (1.0, 10.0, 100.0, 1000.0, 10000.0)
TOLERANCES = (1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12)


def _solvers():
    """Names of the contact solvers; those known when the engine is not built."""
    try:
        from cd_engine import core
        return core.methods()
    except ImportError:
        return ["nsgs", "accelerated"]


def series(scene):
    """The series of a scene."""
    stiffer = STIFFER[:2] if scene in PREPARED else STIFFER
    found = [
        Series("MD step", "MD", "md_dt_factor", STEPS),
        Series("MD stiffness", "MD", "stiffening", stiffer),
        Series("MD stiffness, fine step", "MD", "stiffening", stiffer[:4], {"md_dt_factor": 0.05}),
        Series("MD damping", "MD", "beta_n", (0.0, 0.05, 0.1, 0.3, 0.9), costlier=False),
        *(Series(f"MD law {law}", "MD", "md_dt_factor", STEPS, {"tangential_law": law}) for law in ("avoid_ratcheting", "path_independent")
          if scene in ROLLING),
        Series("CD step", "CD", "cd_dt", (16, 8, 4, 2, 1, 1 / 2, 1 / 4, 1 / 8, 1 / 16), relative=True,
               costlier=False),  # long steps are fewer and harder
        *(Series(f"CD {solver}", "CD", "tolerance", TOLERANCES, {"method_cd": solver}) for solver in _solvers()),
        Series("CD accuracy", "CD", ACCURACY, (1e-1, 1e-2, 1e-3, 1e-4, 1e-6), {"cd_dt": 8 * parameters.complete({"scene": scene})["cd_dt"]}),
        Series("CD sweeps", "CD", "fixed_iterations", (1, 3, 10, 30, 100, 300, 1000)),
    ]
    physics = PHYSICS.get(scene, ())
    return [one for one in found if one.method in scenes.module(scene).METHODS and one.parameter not in physics]


def charted():
    """The scenes that have a chart."""
    return [name for name in scenes.names() if name not in WITHOUT]


def of_scene(scene, quick):
    """Its settings in the order in which they are run: the coarse ones of all series first."""
    found = [Setting(one.name, rank, tuple(row.items()), 0, one.costlier)
             for one in series(scene) for rank, row in enumerate(one.rows(scene, quick))]
    return sorted(found, key=lambda setting: setting.rank)


def of_sizes(scene, quick):
    """Its settings at several numbers of disks, small ones first."""
    sizes = SIZES.get(scene, ())
    return [Setting(one.name, rank, tuple((row | {"disks": size}).items()), size, one.costlier)
            for size in (sizes[:-1] if quick else sizes) for one in series(scene) if one.name in SCALED for rank, row in enumerate(one.rows(scene, True))]


def everything(scene, quick):
    """All settings that a scene is run with."""
    return of_scene(scene, quick) + of_sizes(scene, quick)
