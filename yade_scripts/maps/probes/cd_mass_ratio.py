"""A disk on a disk on the floor, rigid, from rest and without forces."""
from yade import O

from yade_scripts.maps import INACCURATE, NOT_SOLVED, STABLE, UNSTABLE, Outcome
from yade_scripts.maps.probes import rigid

STEPS, DT = 20, 1e-3
FORCE_ERROR = 0.01


def probe(case):
    """See the map of this name."""
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
