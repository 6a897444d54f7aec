"""CD: the tolerance against the ratio of masses, a disk on a disk."""
from yade_scripts.maps import Axis, Map, Search, logarithmic, product

METHODS = ("accelerated", "nsgs")


def grid(full):
    """tolerance by mass ratio, a panel for each solver."""
    tolerances, ratios = ((logarithmic(1e-12, 1e-2, 11), logarithmic(1e-8, 1e8, 17)) if full
                          else (logarithmic(1e-10, 1e-2, 5), logarithmic(1e-8, 1e8, 9)))
    return product(method=METHODS if full else METHODS[:1], tolerance=tolerances, mass_ratio=ratios)


def searches(full):
    """The largest ratio at which forces are right, and where a step is still solved, for each tolerance."""
    return [Search(at, "mass_ratio", 1.0, 1e8, 1.05 if full else 1.3)
            for at in product(method=METHODS if full else METHODS[:1], tolerance=logarithmic(1e-12, 1e-2, 11) if full else logarithmic(1e-10, 1e-2, 5))]


MAP = Map(
    title="Rigid contacts: heavy on light",
    question="How much heavier than what carries it may a body be?",
    criterion="A disk on a disk on the floor, 20 steps of 1 ms from rest without forces. Inaccurate: a contact force off by more than 1 %. "
              "Unstable: bodies overlap by more than 1 % of the radius though the steps count as solved. Not solved: steps that missed the tolerance.",
    remedy="Sweeps hand a heavy weight on slowly. A step in which they have not done so does not count as solved, and says so. method='auto' goes on to "
           "Newton's method, which solves two disks up to a ratio of 1e9 at a tolerance of 1e-6. Heavy below light is no matter.",
    x=Axis("tolerance", "tolerance"), y=Axis("mass_ratio", "mass above / mass below"), panels="method",
    measures={"force_error": ("1", "largest error of the two contact forces, relative to its own exact value"),
              "penetration": ("1", "largest overlap over the radius"), "unconverged": ("1", "share of the steps that missed the tolerance")},
    grid=grid, searches=searches, marks={"default of runs": 1e-8, "of the engine": 1e-6})
