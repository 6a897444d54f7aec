"""Map of springs in Contact Dynamics: time step against dashpot, for a disk that hits a wall."""
import math

from yade_scripts.measuring.maps import Axis, INACCURATE, Map, UNSTABLE, judged, lines, logarithmic, product

STIFFNESS, SPEED, OFF = 2e6, 0.1, 0.05  # N/m, m/s, of the speed of the impact
DAMPING = {True: (0.0, 0.1, 0.2, 0.4, 0.6), False: (0.0, 0.4)}  # of the full and of the quick map

MAP = Map(
    order=12,
    title="Springs in Contact Dynamics: rebounds",
    question="Up to which step does a contact rebound as its spring and dashpot do?",
    criterion="A disk hits a box at 0.1 m/s without gravity. Inaccurate: it leaves with a speed that differs from that of the exact spring and "
              "dashpot by more than 5 % of the speed of the impact. Unstable: faster than it came.",
    remedy="Longer steps damp rebounds, up to rest, and never add energy; the program does not warn. Use MD for the impacts and waves of springs.",
    x=Axis("omega_h", r"$dt\,\sqrt{k_n/m}$"), y=Axis("damping_ratio", "damping ratio"),
    measures={"rebound": "speed after the impact over that before", "exact": "the same of the exact spring and dashpot"},
    grid=lambda full: product(damping_ratio=DAMPING[full], omega_h=logarithmic(3e-3, 3, 9 if full else 4)),
    searches=lambda full: lines("omega_h", 1e-3, 3.0, 1.02 if full else 1.2, damping_ratio=DAMPING[full]))


def probe(case):
    from yade import O
    from yade_scripts.measuring import rigid
    ground = rigid.ground(0.0)
    ground.floor()
    disk = ground.disk((0, rigid.RADIUS * (1 + 1e-6)), velocity=(0, -SPEED))
    dt = case["omega_h"] * math.sqrt(rigid.MASS / STIFFNESS)
    engine = rigid.engine(dt, (0, 0, 0), stiffness=STIFFNESS, tangentialStiffness=STIFFNESS / 2, dampingRatio=case["damping_ratio"])
    O.run(math.ceil(10 / case["omega_h"]) + 10, True)
    measures = {"rebound": disk.state.vel[1] / SPEED, "exact": rebound(case["damping_ratio"])}
    return judged(measures, rigid.told(engine), (UNSTABLE, "energy growth", measures["rebound"] > 1 + 1e-9),
                  (INACCURATE, "wrong motion", abs(measures["rebound"] - measures["exact"]) > OFF))


def rebound(z):
    """Return the restitution of a spring with a dashpot of damping ratio z below 0.7 that never pulls (cd_engine/README.md)."""
    s = math.sqrt(1 - z * z)
    return math.exp(-z / s * (math.pi - math.atan2(2 * z * s, 1 - 2 * z * z)))
