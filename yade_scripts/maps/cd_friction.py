"""CD: the tolerance against the distance from the angle of friction."""
from yade_scripts.maps import Axis, Map, Search, logarithmic, product

SIDES = ("steeper", "flatter")


def grid(full):
    """tolerance by distance from tan(slope) = mu, a panel for each side."""
    tolerances, distances = ((logarithmic(1e-10, 1e-1, 10), logarithmic(1e-9, 1e-1, 9)) if full
                             else (logarithmic(1e-9, 1e-1, 5), logarithmic(1e-7, 1e-1, 4)))
    return product(side=SIDES, tolerance=tolerances, distance=distances)


def searches(full):
    """How near the angle of friction the answer is right, for each tolerance."""
    return [Search(at, "distance", 0.3, 1e-9, 1.05 if full else 1.5)
            for at in product(side=SIDES, tolerance=logarithmic(1e-8, 1e-1, 8) if full else [1e-6, 1e-3])]


MAP = Map(
    title="Rigid contacts: rest or slide near the angle of friction",
    question="How near the angle of friction is it still decided rightly whether a body rests?",
    criterion="Five touching disks that cannot turn, mu = 0.5, rest on a slope of half the angle, which then changes to tan(slope) = mu (1 + d) or "
              "mu (1 - d); 200 steps of 1 ms. Their mean speed is off by more than a tenth of mu d g cos(slope) t, what they gain or lack. "
              "Steeper and too slow: false rest; otherwise false motion. Inaccurate up to that amount itself, unstable beyond.",
    remedy="Nothing rests that must move. Nearer to the angle of friction than the tolerance speeds are off by about the tolerance times the speed that the "
           "weight would give, until what rests is proven to and sleeps; keep the tolerance below the distance from the angle that matters.",
    x=Axis("tolerance", "tolerance"), y=Axis("distance", r"$d=|\tan(\mathrm{slope})/\mu-1|$"), panels="side",
    measures={"speed_error": ("1", "of the mean speed, over mu d g cos(slope) t"), "unconverged": ("1", "share of the steps that missed the tolerance")},
    grid=grid, searches=searches, marks={"default of runs": 1e-8, "of the engine": 1e-6})
