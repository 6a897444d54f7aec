"""CD: the tolerance against the height of a column."""
from yade_scripts.maps import Axis, Map, Search, logarithmic, product
from yade_scripts.maps.cd_sweeps import whole

METHODS = ("accelerated", "nsgs")


def grid(full):
    """tolerance by number of disks, a panel for each solver."""
    tolerances, disks = ((logarithmic(1e-12, 1e-1, 12), logarithmic(1, 300, 9)) if full else (logarithmic(1e-10, 1e-1, 5), logarithmic(1, 100, 4)))
    return product(method=METHODS if full else METHODS[:1], disks=whole(disks), tolerance=tolerances)


def searches(full):
    """The loosest tolerance whose forces are right, for each height."""
    return [Search(at, "tolerance", 1e-7, 1.0, 1.05 if full else 1.3)
            for at in product(method=METHODS if full else METHODS[:1], disks=whole(logarithmic(2, 100, 6)) if full else [3, 10, 30])]


MAP = Map(
    title="Rigid contacts: the tolerance under a column",
    question="How tall may a column be at a tolerance, and at what tolerance are its forces right?",
    criterion="Equal disks on each other, 20 steps of 1 ms from rest without forces, at most 20000 sweeps. Not solved: steps that missed the tolerance. "
              "Unstable: bodies overlap by more than 1 % of the radius. Inaccurate: a contact force off by more than 1 %.",
    remedy="The error e is one of all contacts together, and light loads on tall columns bear the most of it: a single force was off by 5 times the "
           "tolerance at 4 disks, 120 at 21, 500 at 147, 3400 at 300. Take the tolerance as much below the accuracy that single forces must have.",
    x=Axis("tolerance", "tolerance"), y=Axis("disks", "disks in the column"), panels="method",
    measures={"force_error": ("1", "largest error of a contact force, relative to the weight above it"),
              "penetration": ("1", "largest overlap over the radius"), "unconverged": ("1", "share of the steps that missed the tolerance")},
    grid=grid, searches=searches, marks={"default of runs": 1e-8, "of the engine": 1e-6})
