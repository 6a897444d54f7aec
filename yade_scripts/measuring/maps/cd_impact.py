"""Map of CD: restitution against friction, for a disk thrown into a groove."""
import math
import random

from yade_scripts.measuring.maps import Axis, Map, UNSTABLE, judged, lines, product

DRAWS, STEPS, DT = 60, 6, 1e-4
SPEED = 1.0  # [m/s]
GAIN = 1e-9  # smallest relative gain of energy that counts: above round-off and solver error

MAP = Map(
    order=9,
    title="Rigid contacts: restitution with friction",
    question="Where does restitution together with friction create energy?",
    criterion="A spinning disk is thrown at the bottom of a groove and hits both sides at once; 60 random angles, velocities and spins. "
              "Unstable: its kinetic energy exceeds the first by more than 1e-9 after one of the next six steps.",
    remedy="With friction Newton's law of impact creates energy in simultaneous impacts when e is near 1 (Kane and Levinson 1985). The "
           "engine lowers e there, so disks rebound more slowly than e says.",
    x=Axis("restitution", "restitution e"), y=Axis("friction", r"friction $\mu$"),
    measures={"energy_gain": "largest kinetic energy over the first, less 1", "draws_that_gain": "share of the draws"},
    grid=lambda full: product(restitution=[0.0, 0.2, 0.4, 0.6, 0.8, 0.9, 0.95, 1.0] if full else [0.0, 0.5, 0.9, 1.0],
                              friction=[0.0, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 2.0] if full else [0.0, 0.1, 0.5, 1.0]),
    searches=lambda full: lines("restitution", 0.1, 1.0, 1.003 if full else 1.02, friction=[0.1, 0.2, 0.3, 0.5] if full else [0.1, 0.5]))


def probe(case):
    from yade import O
    draw = random.Random(1)
    gains, deficit = [], 0
    for _ in range(DRAWS):
        O.reset()
        gain, dissipated = throw(case, math.radians(draw.uniform(20, 70)), 0.5 * draw.uniform(-1, 1), 3 * draw.uniform(-1, 1))
        gains.append(gain)
        deficit += dissipated < 0
    measures = {"energy_gain": max(gains), "draws_that_gain": sum(gain > GAIN for gain in gains) / DRAWS}
    told = f"dissipatedEnergy falls in {deficit} draws" if deficit else ""
    return judged(measures, told, (UNSTABLE, "energy growth", max(gains) > GAIN))


def throw(case, angle, aside, spin):
    """Return the largest relative gain of kinetic energy, and dissipatedEnergy [J]; aside (velocity along x) and spin in units of SPEED."""
    from yade import O, utils
    from yade_scripts.measuring import rigid
    ground, radius = rigid.ground(case["friction"]), rigid.RADIUS
    for side in (-1, 1):
        ground.box((1.5 * side * radius * math.sin(angle), -1.5 * radius * math.cos(angle)), (5 * radius, 0.5 * radius), side * angle)
    disk = ground.disk((0, 1e-6 * radius), velocity=(aside * SPEED, -SPEED))
    disk.state.angVel = (0, 0, spin * SPEED / radius)
    first, gain = utils.kineticEnergy(), 0.0
    engine = rigid.engine(DT, (0, 0, 0), tolerance=1e-12, restitution=case["restitution"])
    for _ in range(STEPS):
        O.step()
        gain = max(gain, utils.kineticEnergy() / first - 1)
    return gain, engine.dissipatedEnergy
