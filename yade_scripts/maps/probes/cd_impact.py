"""A disk with spin thrown at the bottom of a groove, so that both sides are hit at once."""
import math
import random

from yade import O, Quaternion, utils

from yade_scripts.maps import STABLE, UNSTABLE, Outcome
from yade_scripts.maps.probes import rigid

DRAWS, STEPS, DT = 60, 6, 1e-4
SPEED = 1.0  # [m/s]
GAIN = 1e-9  # above round-off and the tolerance


def probe(case):
    """See the map of this name."""
    draw = random.Random(1)
    gains, deficit = [], 0
    for _ in range(DRAWS):
        O.reset()
        gain, dissipated = throw(case, math.radians(draw.uniform(20, 70)), 0.5 * draw.uniform(-1, 1), 3 * draw.uniform(-1, 1))
        gains.append(gain)
        deficit += dissipated < 0
    measures = {"energy_gain": max(gains), "draws_that_gain": sum(gain > GAIN for gain in gains) / DRAWS}
    if max(gains) > GAIN:
        return Outcome(UNSTABLE, "energy growth", f"dissipatedEnergy falls in {deficit} draws" if deficit else "", measures)
    return Outcome(STABLE, measures=measures)


def throw(case, angle, aside, spin):
    """Largest relative gain of kinetic energy, and the energy that the engine says was dissipated; aside, spin in units of SPEED."""
    rigid.material(case["friction"])
    for side in (-1, 1):
        rigid.box((1.5 * side * rigid.RADIUS * math.sin(angle), -1.5 * rigid.RADIUS * math.cos(angle)), (5 * rigid.RADIUS, 0.5 * rigid.RADIUS),
                  orientation=Quaternion((0, 0, 1), side * angle))
    disk = rigid.disk((0, 1e-6 * rigid.RADIUS), velocity=(aside * SPEED, -SPEED))
    O.bodies[disk].state.angVel = (0, 0, spin * SPEED / rigid.RADIUS)
    first, gain = utils.kineticEnergy(), 0.0
    engine = rigid.engine(DT, (0, 0, 0), tolerance=1e-12, restitution=case["restitution"])
    for _ in range(STEPS):
        O.step()
        gain = max(gain, utils.kineticEnergy() / first - 1)
    return gain, engine.dissipatedEnergy
