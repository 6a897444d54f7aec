"""Five touching disks that cannot turn, on a slope that changes from half the angle of friction to just off it."""
import math

from yade import O

from yade_scripts.maps import INACCURATE, NOT_SOLVED, STABLE, UNSTABLE, Outcome
from yade_scripts.maps.probes import rigid
from yade_scripts.sums import total

FRICTION, DISKS, STEPS, SETTLING, DT = 0.5, 5, 200, 10, 1e-3
ERROR = 0.1


def weight(tangent):
    """Acceleration of free fall seen from a slope of that tangent."""
    angle = math.atan(tangent)
    return rigid.GRAVITY * math.sin(angle), -rigid.GRAVITY * math.cos(angle), 0


def probe(case):
    """See the map of this name."""
    rigid.material(FRICTION)
    rigid.floor()
    row = [rigid.disk((2 * k * rigid.RADIUS, rigid.RADIUS), blocked="zXYZ") for k in range(DISKS)]
    engine = rigid.engine(DT, weight(FRICTION / 2), tolerance=case["tolerance"])
    O.run(SETTLING, True)
    sign = 1 if case["side"] == "steeper" else -1
    tangent = FRICTION * (1 + sign * case["distance"])
    engine.gravity = weight(tangent)
    O.run(STEPS, True)
    unit = FRICTION * case["distance"] * rigid.GRAVITY * math.cos(math.atan(tangent)) * STEPS * DT
    exact = unit if sign > 0 else 0.0
    error = (total(O.bodies[k].state.vel[0] for k in row) / DISKS - exact) / unit
    measures = {"speed_error": error, "unconverged": engine.unconvergedSteps / (STEPS + SETTLING)}
    if engine.unconvergedSteps:
        return Outcome(NOT_SOLVED, "non-convergence", rigid.told(engine), measures)
    if abs(error) <= ERROR:
        return Outcome(STABLE, measures=measures)
    reason = "false rest" if sign > 0 and error < 0 else "false motion"
    return Outcome(UNSTABLE if abs(error) > 1 else INACCURATE, reason, rigid.told(engine), measures)
