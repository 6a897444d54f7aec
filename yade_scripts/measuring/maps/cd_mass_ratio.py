"""Map of CD: tolerance against the ratio of masses, for a heavy or light disk on another disk."""
from yade_scripts.measuring.maps import Axis, Map, SWEEPS, TOLERANCES, lines, logarithmic, product

STEPS = 20
TRIED = {True: logarithmic(1e-12, 1e-2, 11), False: logarithmic(1e-10, 1e-2, 5)}  # tolerances of the full and of the quick map

MAP = Map(
    order=5,
    title="Rigid contacts: heavy on light",
    question="How much heavier may a body be than the one that carries it?",
    criterion="A disk on a disk on the floor, 20 steps of 1 ms from rest without forces. Inaccurate: a contact force is off by more than 1 "
              "%. Unstable: bodies overlap by more than 1 % of the radius although the steps count as solved. Not solved: steps missed the "
              "tolerance.",
    remedy="Sweeps pass a heavy weight on slowly; a step in which they have not finished says so. method='auto' continues with Newton's "
           "method, which solves far larger ratios. A heavy body below a light one is no problem.",
    x=Axis("tolerance", "tolerance"), y=Axis("mass_ratio", "mass above / mass below"), panels="method",
    measures={"force_error": "largest error of the two contact forces, relative to its own exact value",
              "penetration": "largest overlap over the radius", "unconverged": "share of the steps that missed the tolerance"},
    grid=lambda full: product(method=SWEEPS[full], tolerance=TRIED[full], mass_ratio=logarithmic(1e-8, 1e8, 17 if full else 9)),
    searches=lambda full: lines("mass_ratio", 1.0, 1e8, 1.05 if full else 1.3, method=SWEEPS[full], tolerance=TRIED[full]),
    marks=TOLERANCES)


def probe(case):
    from yade_scripts.measuring import rigid
    return rigid.column([1, case["mass_ratio"]], STEPS, method=case["method"], tolerance=case["tolerance"])
