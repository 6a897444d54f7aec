"""Map of CD: a fixed number of sweeps against the height of a column."""
from yade_scripts.measuring.maps import Axis, Map, lines, logarithmic, product, whole

STEPS = 50
HEIGHTS = {True: whole(logarithmic(2, 100, 6)), False: [3, 10, 30]}  # of columns whose boundary the full and the quick map search

MAP = Map(
    order=3,
    title="Rigid contacts: too few sweeps under a column",
    question="How many sweeps a step does a column of disks need if the error is not checked?",
    criterion="A column of equal disks, 50 steps of 1 ms from rest without forces, with fixedIterations. Unstable: bodies overlap by more "
              "than 1 % of the radius. Inaccurate: a contact force is off by more than 1 %.",
    remedy="Look at residual, or use a tolerance instead. The engine warns of overlaps beyond 1 % of the radius.",
    x=Axis("sweeps", "sweeps a step"), y=Axis("disks", "disks in the column"), panels="start",
    measures={"force_error": "largest error of a contact force, relative to the weight above it",
              "penetration": "largest overlap over the radius", "residual": "error e of the last step"},
    grid=lambda full: product(start=("warm", "cold"), disks=whole(logarithmic(1, 100, 9) if full else logarithmic(1, 30, 4)),
                              sweeps=whole(logarithmic(1, 1e4, 13) if full else logarithmic(1, 1e3, 7))),
    searches=lambda full: lines("sweeps", 30000, 1, 1.02 if full else 1.2, start=("warm", "cold"), disks=HEIGHTS[full]))


def probe(case):
    from yade_scripts.measuring import rigid
    return rigid.column([1] * case["disks"], STEPS, fixedIterations=case["sweeps"], warmStart=case["start"] == "warm")
