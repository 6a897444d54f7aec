"""Map of CD: tolerance against the distance of the slope from the angle of friction."""
import math

from yade_scripts.measuring.maps import Axis, INACCURATE, Map, NOT_SOLVED, TOLERANCES, UNSTABLE, judged, lines, logarithmic, product
from yade_scripts.running.sums import total

FRICTION, DISKS, STEPS, SETTLING, DT = 0.5, 5, 200, 10, 1e-3
ERROR = 0.1
SIDES = ("steeper", "flatter")

MAP = Map(
    order=6,
    title="Rigid contacts: rest or slide near the angle of friction",
    question="How close to the angle of friction does the engine still decide correctly whether a body rests?",
    criterion="Five touching disks that cannot turn (mu = 0.5) rest on a slope of tangent mu/2. The slope then changes to "
              "tan(slope) = mu (1 + d) or mu (1 - d) for 200 steps of 1 ms. Inaccurate: the mean speed is off by more than a tenth of mu d g "
              "cos(slope) t. Unstable: by more than all of it. Too slow on the steeper slope is called false rest, anything else false "
              "motion.",
    remedy="Below the angle of friction bodies may creep, above it none stays at rest. The error of the speed is about the tolerance times "
           "the speed that the weight would give: choose a tolerance below the distance from the angle that matters to you.",
    x=Axis("tolerance", "tolerance"), y=Axis("distance", r"$d=|\tan(\mathrm{slope})/\mu-1|$"), panels="side",
    measures={"speed_error": "of the mean speed, over mu d g cos(slope) t", "unconverged": "share of the steps that missed the tolerance"},
    grid=lambda full: product(side=SIDES, tolerance=logarithmic(1e-10, 1e-1, 10) if full else logarithmic(1e-9, 1e-1, 5),
                              distance=logarithmic(1e-9, 1e-1, 9) if full else logarithmic(1e-7, 1e-1, 4)),
    searches=lambda full: lines("distance", 0.3, 1e-9, 1.05 if full else 1.5, side=SIDES,
                                tolerance=logarithmic(1e-8, 1e-1, 8) if full else [1e-6, 1e-3]),
    marks=TOLERANCES)


def weight(tangent):
    """Return gravity [m/s^2] in axes along and normal to a slope of this tangent."""
    from yade_scripts.measuring import rigid
    angle = math.atan(tangent)
    return rigid.GRAVITY * math.sin(angle), -rigid.GRAVITY * math.cos(angle), 0


def probe(case):
    from yade import O
    from yade_scripts.measuring import rigid
    ground = rigid.ground(FRICTION)
    ground.floor(1000 * rigid.RADIUS)
    row = [ground.disk((2 * k * rigid.RADIUS, rigid.RADIUS), blocked="zXYZ") for k in range(DISKS)]
    engine = rigid.engine(DT, weight(FRICTION / 2), tolerance=case["tolerance"])
    O.run(SETTLING, True)
    steeper = case["side"] == "steeper"
    tangent = FRICTION * (1 + case["distance"] if steeper else 1 - case["distance"])
    engine.gravity = weight(tangent)
    O.run(STEPS, True)
    unit = FRICTION * case["distance"] * rigid.GRAVITY * math.cos(math.atan(tangent)) * STEPS * DT
    error = (total(disk.state.vel[0] for disk in row) / DISKS - (unit if steeper else 0.0)) / unit
    measures = {"speed_error": error, "unconverged": engine.unconvergedSteps / (STEPS + SETTLING)}
    reason = "false rest" if steeper and error < 0 else "false motion"
    return judged(measures, rigid.told(engine), (NOT_SOLVED, "non-convergence", engine.unconvergedSteps),
                  (UNSTABLE, reason, abs(error) > 1), (INACCURATE, reason, not abs(error) <= ERROR))
