"""Equal rigid disks on each other, from rest and without forces: what two maps ask about."""
from yade import O

from yade_scripts.maps import INACCURATE, NOT_SOLVED, STABLE, UNSTABLE, Outcome
from yade_scripts.maps.probes import rigid

DT = 1e-3
FORCE_ERROR = 0.01


def stand(disks, steps, **settings):
    """(engine, measures) after `steps` steps."""
    rigid.material(0.5)
    below, pairs = rigid.floor(), []
    for k in range(disks):
        disk = rigid.disk((0, (2 * k + 1) * rigid.RADIUS))
        pairs.append((below, disk))
        below = disk
    engine = rigid.engine(DT, **settings)
    O.run(steps, True)
    weight = rigid.GRAVITY * rigid.MASS
    error = max(abs(rigid.normal_force(*pair) / ((disks - k) * weight) - 1) for k, pair in enumerate(pairs))
    return engine, {"force_error": error, "penetration": engine.deepestPenetration / rigid.RADIUS,
                    "unconverged": engine.unconvergedSteps / steps, "residual": engine.residual}


def judge(engine, measures):
    """The Outcome of what was measured."""
    if measures["unconverged"]:
        return Outcome(NOT_SOLVED, "non-convergence", rigid.told(engine), measures)
    if measures["penetration"] > rigid.DEEP:
        return Outcome(UNSTABLE, "penetration", rigid.told(engine), measures)
    if measures["force_error"] > FORCE_ERROR:
        return Outcome(INACCURATE, "wrong forces", rigid.told(engine), measures)
    return Outcome(STABLE, measures=measures)
