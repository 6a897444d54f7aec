"""Map of CD: tolerance against the height of a column."""
from yade_scripts.measuring.maps import Axis, Map, SWEEPS, TOLERANCES, lines, logarithmic, product, whole
from yade_scripts.measuring.maps.cd_sweeps import HEIGHTS

STEPS = 20

MAP = Map(
    order=4,
    title="Rigid contacts: the tolerance under a column",
    question="How tall may a column be at a given tolerance, and at which tolerance are its forces right?",
    criterion="A column of equal disks, 20 steps of 1 ms from rest without forces, at most 20000 sweeps. Not solved: steps missed the "
              "tolerance. Unstable: bodies overlap by more than 1 % of the radius. Inaccurate: a contact force is off by more than 1 %.",
    remedy="In a column at rest every contact force is right to the tolerance: off by at most {{ (cells.force_error / "
           "cells.tolerance)[cells.verdict != 'not solved'].max() | fixed(2) }} of it in columns of up to {{ cells.disks.max() }} disks. "
           "Tall columns take many sweeps: raise maxIterations, or let method='auto' go on to Newton's method.",
    x=Axis("tolerance", "tolerance"), y=Axis("disks", "disks in the column"), panels="method",
    measures={"force_error": "largest error of a contact force, relative to the weight above it",
              "penetration": "largest overlap over the radius", "unconverged": "share of the steps that missed the tolerance"},
    grid=lambda full: product(method=SWEEPS[full], disks=whole(logarithmic(1, 300, 9) if full else logarithmic(1, 100, 4)),
                              tolerance=logarithmic(1e-12, 1e-1, 12) if full else logarithmic(1e-10, 1e-1, 5)),
    searches=lambda full: lines("tolerance", 1e-7, 1.0, 1.05 if full else 1.3, method=SWEEPS[full], disks=HEIGHTS[full]),
    marks=TOLERANCES)


def probe(case):
    from yade_scripts.measuring import rigid
    return rigid.column([1] * case["disks"], STEPS, method=case["method"], tolerance=case["tolerance"])
