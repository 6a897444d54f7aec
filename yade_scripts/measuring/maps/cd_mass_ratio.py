"""Map of CD: tolerance against the ratio of masses, for a heavy or light disk on another disk.

The probe: two rigid disks stand one above the other on the floor. They start at rest and without contact forces.
"""
from yade_scripts.measuring.maps import Axis, INACCURATE, Map, NOT_SOLVED, Outcome, STABLE, Search, UNSTABLE, logarithmic, product

STEPS, DT = 20, 1e-3
FORCE_ERROR = 0.01

METHODS = ("accelerated", "nsgs")


def grid(full):
    """Return the cases of the grid: tolerance by mass ratio, a panel for each solver."""
    tolerances, ratios = ((logarithmic(1e-12, 1e-2, 11), logarithmic(1e-8, 1e8, 17)) if full
                          else (logarithmic(1e-10, 1e-2, 5), logarithmic(1e-8, 1e8, 9)))
    return product(method=METHODS if full else METHODS[:1], tolerance=tolerances, mass_ratio=ratios)


def searches(full):
    """Return for each tolerance a search of the largest ratio whose steps are solved with right forces."""
    return [Search(at, "mass_ratio", 1.0, 1e8, 1.05 if full else 1.3)
            for at in product(method=METHODS if full else METHODS[:1], tolerance=logarithmic(1e-12, 1e-2, 11) if full else logarithmic(1e-10, 1e-2, 5))]


MAP = Map(
    group="Where rigid contacts fail", order=5,
    title="Rigid contacts: heavy on light",
    question="How much heavier may a body be than the one that carries it?",
    criterion="A disk on a disk on the floor, 20 steps of 1 ms from rest without forces. Inaccurate: a contact force is off by more than 1 "
              "%. Unstable: bodies overlap by more than 1 % of the radius although the steps count as solved. Not solved: steps missed the "
              "tolerance.",
    remedy="Sweeps pass a heavy weight on slowly; a step in which they have not finished does not count as solved and says so. method='auto' "
           "continues with Newton's method, which solves two disks up to a ratio of 1e9 at a tolerance of 1e-6. A heavy body below a light "
           "one is no problem.",
    x=Axis("tolerance", "tolerance"), y=Axis("mass_ratio", "mass above / mass below"), panels="method",
    measures={"force_error": ("1", "largest error of the two contact forces, relative to its own exact value"),
              "penetration": ("1", "largest overlap over the radius"), "unconverged": ("1", "share of the steps that missed the tolerance")},
    grid=grid, searches=searches, marks={"default of runs": 1e-8, "of the engine": 1e-6})


def probe(case):
    """Measure a case inside YADE and return its Outcome."""
    from yade import O

    from yade_scripts.measuring import rigid
    rigid.material(0.5)
    floor = rigid.floor()
    below = rigid.disk((0, rigid.RADIUS))
    above = rigid.disk((0, 3 * rigid.RADIUS), mass=case["mass_ratio"] * rigid.MASS)
    engine = rigid.engine(DT, method=case["method"], tolerance=case["tolerance"])
    O.run(STEPS, True)
    weights = rigid.GRAVITY * O.bodies[above].state.mass, rigid.GRAVITY * (O.bodies[above].state.mass + O.bodies[below].state.mass)
    forces = rigid.normal_force(below, above), rigid.normal_force(floor, below)
    error = max(abs(force / weight - 1) for force, weight in zip(forces, weights))
    penetration = engine.deepestPenetration / rigid.RADIUS
    measures = {"force_error": error, "penetration": penetration, "unconverged": engine.unconvergedSteps / STEPS}
    if engine.unconvergedSteps:
        return Outcome(NOT_SOLVED, "non-convergence", rigid.told(engine), measures)
    if penetration > rigid.DEEP:
        return Outcome(UNSTABLE, "penetration", rigid.told(engine), measures)
    if error > FORCE_ERROR:
        return Outcome(INACCURATE, "wrong forces", rigid.told(engine), measures)
    return Outcome(STABLE, measures=measures)
