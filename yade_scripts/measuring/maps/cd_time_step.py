"""Map of CD: time step against restitution, for disks that fall into a trough."""
import itertools
import math
import random

from yade_scripts.measuring.maps import Axis, INACCURATE, Map, NOT_SOLVED, UNSTABLE, judged, lines, logarithmic, product
from yade_scripts.running.sums import total

COLUMNS, ROWS, DURATION = 6, 5, 20
GROWTH = 1e-5  # growth of energy over that of the fall that the tolerance can explain
TOLERANCE = 1e-5
UNSOLVED = 0.01  # share of the steps

MAP = Map(
    order=8,
    title="Rigid contacts: the step of a fall",
    question="How long a time step do falling and settling disks allow?",
    criterion="30 disks fall into a trough and settle within 20 sqrt(R/g), tolerance 1e-5. Unstable: kinetic, potential and dissipated "
              "energy together grow by more than 1e-5 of the energy of the fall, or a disk leaves the trough. Inaccurate: bodies overlap by "
              "more than 1 % of the radius. Not solved: more than 1 % of the steps missed the tolerance.",
    remedy="Without restitution contacts hold at any step. With restitution, contacts that close during an impact elsewhere overlap by up to "
           "their displacement in a step, of which the engine warns; from dt sqrt(g/R) = "
           "{{ cells.dt[cells.reason == 'energy growth'].min() | fixed(3) }} on energy may grow.",
    x=Axis("dt", r"$dt\,\sqrt{g/R}$"), y=Axis("restitution", "restitution e"), panels="friction",
    measures={"penetration": "largest overlap over the radius",
              "energy_balance": "kinetic, potential and dissipated energy less the first, over the fall's",
              "energy_gain": "largest kinetic and potential energy less the first, over the fall's",
              "unconverged": "share of the steps that missed the tolerance"},
    grid=lambda full: product(friction=[0.0, 0.5] if full else [0.5],
                              restitution=[0.0, 0.2, 0.4, 0.6, 0.8, 1.0] if full else [0.0, 0.5, 0.9],
                              dt=logarithmic(0.003, 3, 10) if full else logarithmic(0.01, 3, 6)),
    searches=lambda full: lines("dt", 0.003, 10.0, 1.05 if full else 1.2, friction=[0.0, 0.5] if full else [0.5],
                                restitution=[0.0, 0.2, 0.4, 0.6, 0.8] if full else [0.0, 0.5]),
    marks={"1 ms at R = 1 cm": 1e-3 * math.sqrt(9.81 / 0.01)})


def probe(case):
    from yade import O, utils
    from yade_scripts.measuring import rigid
    from yade_scripts.running import bodies, hooks
    pour(case["friction"])
    dt = case["dt"] * math.sqrt(rigid.RADIUS / rigid.GRAVITY)
    fall = rigid.GRAVITY * total(b.state.mass for b in bodies.disks()) * ROWS * rigid.RADIUS

    def energy():
        return utils.kineticEnergy() + rigid.GRAVITY * total(b.state.mass * b.state.pos[1] for b in bodies.disks())

    first, energies = energy(), []
    engine = rigid.engine(dt, tolerance=TOLERANCE, restitution=case["restitution"])
    O.engines = O.engines + [hooks.runner(lambda: energies.append(energy()), iterPeriod=1)]
    steps = max(1, round(DURATION / case["dt"]))
    hooks.simulate(steps)
    balance = (energy() - first + engine.dissipatedEnergy) / fall
    measures = {"penetration": engine.deepestPenetration / rigid.RADIUS, "energy_balance": balance,
                "energy_gain": (max(energies) - first) / fall, "unconverged": engine.unconvergedSteps / steps}
    # In the trough: above its floor and between its walls.
    inside = all(b.state.pos[1] > 0 and abs(b.state.pos[0]) < COLUMNS * 1.2 * rigid.RADIUS for b in bodies.disks())
    return judged(measures, rigid.told(engine), (UNSTABLE, "energy growth", measures["energy_gain"] > GROWTH or abs(balance) > GROWTH),
                  (UNSTABLE, "tunnelled", not inside), (INACCURATE, "penetration", measures["penetration"] > rigid.DEEP),
                  (NOT_SOLVED, "non-convergence", measures["unconverged"] > UNSOLVED))


def pour(friction):
    """Build the trough and the disks above it, in rows and displaced at random."""
    from yade_scripts.measuring import rigid
    ground = rigid.ground(friction)
    ground.floor(1000 * rigid.RADIUS)
    width, r = COLUMNS * 2.4 * rigid.RADIUS, rigid.RADIUS
    for side in (-1, 1):
        ground.box((side * (width / 2 + r), 50 * r), (r, 50 * r))
    draw = random.Random(3)
    for row, column in itertools.product(range(ROWS), range(COLUMNS)):
        ground.disk(((2.4 * column + 1.2 + draw.uniform(-0.15, 0.15)) * r - width / 2, (2 + 3 * row) * r))
