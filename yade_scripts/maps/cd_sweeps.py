"""CD: a fixed number of sweeps against the height of a column."""
from yade_scripts.maps import Axis, Map, Search, logarithmic, product


def whole(values):
    """Rounded, without repetitions."""
    return list(dict.fromkeys(round(value) for value in values))


def grid(full):
    """sweeps by number of disks, a panel with and without warm start."""
    sweeps, disks = ((logarithmic(1, 1e4, 13), logarithmic(1, 100, 9)) if full else (logarithmic(1, 1e3, 7), logarithmic(1, 30, 4)))
    return product(start=("warm", "cold"), disks=whole(disks), sweeps=whole(sweeps))


def searches(full):
    """The fewest sweeps that carry the column, for each height."""
    return [Search(at, "sweeps", 30000, 1, 1.02 if full else 1.2) for at in product(start=("warm", "cold"), disks=whole(logarithmic(2, 100, 6)) if full else [3, 10, 30])]


MAP = Map(
    title="Rigid contacts: too few sweeps under a column",
    question="How many sweeps a step does a column of disks need, that are made without asking for the error?",
    criterion="Equal disks on each other, 50 steps of 1 ms from rest without forces, fixedIterations. Unstable: bodies overlap by more than 1 % of the radius. "
              "Inaccurate: a contact force off by more than 1 %.",
    remedy="After fixedIterations look at residual, which says what is missing, or use a tolerance; overlaps beyond 1 % of the "
           "radius are warned of.",
    x=Axis("sweeps", "sweeps a step"), y=Axis("disks", "disks in the column"), panels="start",
    measures={"force_error": ("1", "largest error of a contact force, relative to the weight above it"),
              "penetration": ("1", "largest overlap over the radius"), "residual": ("1", "error e of the last step")},
    grid=grid, searches=searches)
