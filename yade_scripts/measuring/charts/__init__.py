"""The settings that the charts of speed against accuracy compare: for each scene, series of rows from coarse to fine. Needs no YADE.

A series varies one parameter and keeps the scene's own defaults for the others. Exceptions of a scene stand in its CHART.
"""
import math
from dataclasses import dataclass, field

from yade_scripts import declared, parameters, scenes
from yade_scripts.measuring import store
from yade_scripts.results.schema import STATUS_FAILED, STATUS_FINISHED, relative_error

FOLDER = "charts"
LIMIT = {False: 2, True: 8}  # s of processor time that a run may take, quick and full
DIVERGED = 100.0             # error, in scales of its known quantity, beyond which a run counts as diverged
SCALED = ("MD step", "CD accelerated", "CD nsgs")  # series tried at every number of disks
STEPS = (0.8, 0.4, 0.2, 0.1, 0.05, 0.02, 0.01)
STIFFER = (1.0, 10.0, 100.0, 1000.0, 10000.0)
TOLERANCES = (1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12)


@dataclass(frozen=True)
class Series:
    """Rows of one method from coarse to fine; a quick chart takes every second one.

    costlier: a finer row takes longer, so none finer is tried after one that ran out of time.
    """
    name: str
    method: str
    parameter: str
    values: tuple
    fixed: dict = field(default_factory=dict)
    costlier: bool = True

    def rows(self, scene, quick):
        """Return the rows for a scene, each {parameter: value} with its method."""
        values = self.values[::-1][::2][::-1] if quick else self.values
        common = {"scene": scene, "method": self.method} | chart_of(scene).base | self.fixed
        return [common | {self.parameter: value} for value in values]


@dataclass(frozen=True)
class Setting:
    """One row of a series. rank: its place, 0 for the coarsest; size: number of disks where the chart varies it, else 0."""
    series: Series
    rank: int
    row: dict
    size: int = 0

    @property
    def name(self):
        return store.name_of({"row": self.row})

    def slower_than(self, other):
        """Tell whether it takes longer than another setting for sure: it comes later in the same series."""
        return self.series == other.series and self.size == other.size and self.rank > other.rank and self.series.costlier


def chart_of(scene):
    """Return the Chart of a scene; None if it has none."""
    return scenes.module(scene).CHART


def names(broken=None):
    """Return the names of the scenes that have a Chart. broken: as of declared.readable."""
    return [name for name in declared.readable(scenes.names(), _check, broken) if chart_of(name)]


def _check(scene):
    """Raise ImportError, with the file, if the Chart of a scene sets what its rows cannot have."""
    file = scenes.module(scene)
    with declared.located(file.__file__):
        parameters.complete({"scene": scene, "method": file.METHODS[-1]} | (file.CHART.base if file.CHART else {}))


def series(scene):
    chart, own_step = chart_of(scene), parameters.complete({"scene": scene})["cd_dt"]
    stiffer, space = STIFFER[:2] if chart.prepared else STIFFER, scenes.module(scene).IN_SPACE
    laws = parameters.REGISTRY["tangential_law"].choices[1:] if chart.rolling else ()
    found = [
        Series("MD step", "MD", "md_dt_factor", STEPS),
        Series("MD stiffness", "MD", "stiffening", stiffer),
        Series("MD stiffness, fine step", "MD", "stiffening", stiffer[:4], {"md_dt_factor": 0.05}),
        Series("MD damping", "MD", "beta_n", (0.0, 0.05, 0.1, 0.3, 0.9), costlier=False),
        *(Series(f"MD law {law}", "MD", "md_dt_factor", STEPS, {"tangential_law": law}) for law in laws),
        # Longer steps are fewer but harder to solve, so the cost need not rise with the rank.
        Series("CD step", "CD", "cd_dt", tuple(own_step * 2.0**k for k in range(4, -5, -1)), costlier=False),
        *(Series(f"CD {solver}", "CD", "tolerance", TOLERANCES, {"method_cd": solver})
          for solver in parameters.REGISTRY["method_cd"].choices if not (space and solver in parameters.PLANAR_SOLVERS)),
        Series("CD accuracy", "CD", store.ACCURACY, (1e-1, 1e-2, 1e-3, 1e-4, 1e-6), {"cd_dt": 8 * own_step}),
        Series("CD sweeps", "CD", "fixed_iterations", (1, 3, 10, 30, 100, 300, 1000)),
        *(Series(f"CD springs {name}", "CD", parameter, values, {"cd_contacts": "springs"}, costlier=False) for name, parameter, values in (
            ("step", "cd_dt", tuple(own_step * 2.0**k for k in range(4, -5, -1))), ("tolerance", "tolerance", (1.0, 1e-1, 1e-2, 1e-3)),
            ("stiffness", "stiffening", stiffer))),
    ]
    soft = parameters.defaults(scene)["cd_contacts"] == "springs"  # no rigid contacts there
    return [one for one in found if one.method in scenes.module(scene).METHODS and one.parameter not in chart.physics
            and not (soft and one.method == "CD" and not one.fixed.get("cd_contacts"))]


def settings(scene, full):
    """Return all settings of a scene in the order in which they are run: the coarse ones of all series first, then those at several sizes."""
    several, sizes = series(scene), chart_of(scene).sizes[:None if full else -1]
    found = [Setting(one, rank, row) for one in several for rank, row in enumerate(one.rows(scene, not full))]
    return sorted(found, key=lambda setting: setting.rank) + [
        Setting(one, rank, row | {"disks": size}, size)
        for size in sizes for one in several if one.name in SCALED for rank, row in enumerate(one.rows(scene, True))]


def errors(known):
    """Return {name: relative error} of what was measured, from the rows of a measurement."""
    return {one["name"]: relative_error(*(one[name] for name in ("measured", "exact", "scale", "deviation")))
            for one in known if one["measured"] is not None}


def error(known):
    """Return the largest relative error of a measurement's rows; NaN if one was not measured."""
    return max(errors(known).values()) if known and all(one["measured"] is not None for one in known) else math.nan


def status(known):
    """Return 'finished', or why the measured values are not a solution."""
    if not known:
        return f"{STATUS_FAILED}the scene has no quantity with a known value"
    if lost := [one["name"] for one in known if one["measured"] is None]:
        return f"{STATUS_FAILED}{lost[0]} is not a number"
    return STATUS_FINISHED if error(known) <= DIVERGED else f"{STATUS_FAILED}wrong by more than {DIVERGED:g} times its scale"


class Work:
    """All measurements of one scene, for the runner and for the process that measures."""

    def __init__(self, scene, full, results, series=""):
        """series: beginning of the names of the series to measure."""
        self.name, self.folder = scene, results / FOLDER
        self.limit = LIMIT[full] * chart_of(scene).patience
        # Several series may hold one row, such as the scene's defaults: it is measured once.
        self.settings = [one for one in settings(scene, full) if one.series.name.startswith(series)]

    def left(self):
        """Return the settings without a measurement, or with one that ran out of a shorter time limit; of those with one name only the first."""
        first = {}
        for setting in self.settings:
            first.setdefault(setting.name, setting)
        return [setting for name, setting in first.items() if not self._done(store.get(self.folder, name))]

    def _done(self, found):
        return found is not None and (not found.get("out_of_time") or found["limit"] >= self.limit)

    def failed(self, name, reason, late):
        """Store as failed the setting that ended its process and, if it was too slow (`late`), the settings that would take even longer."""
        culprits = [setting for setting in self.settings if setting.name == name]
        self._enter(culprits[0], reason, late)
        left = {setting.name for setting in self.left()} if late else ()
        for setting in self.settings:
            if setting.name in left and any(setting.slower_than(culprit) for culprit in culprits):
                self._enter(setting, f"not tried: a coarser setting {reason}", True)

    def _enter(self, setting, reason, late):
        store.add(self.folder, {"row": setting.row, "limit": self.limit, "out_of_time": late, "status": STATUS_FAILED + reason, "seconds": []})
