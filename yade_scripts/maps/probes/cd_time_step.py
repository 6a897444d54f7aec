"""Thirty disks fall into a trough and settle."""
import math
import random

from yade import O, utils

from yade_scripts import bodies, hooks
from yade_scripts.maps import INACCURATE, NOT_SOLVED, STABLE, UNSTABLE, Outcome
from yade_scripts.maps.probes import rigid
from yade_scripts.sums import total

COLUMNS, ROWS, DURATION = 6, 5, 20
GROWTH = 1e-5  # what the tolerance leaves
TOLERANCE = 1e-5
UNSOLVED = 0.01  # share of the steps


def probe(case):
    """See the map of this name."""
    pour(case["friction"])
    unit = math.sqrt(rigid.RADIUS / rigid.GRAVITY)
    dt = case["dt"] * unit
    fall = rigid.GRAVITY * total(b.state.mass for b in bodies.disks()) * ROWS * rigid.RADIUS

    def energy():
        return utils.kineticEnergy() + rigid.GRAVITY * total(b.state.mass * b.state.pos[1] for b in bodies.disks())

    first, most = energy(), [-math.inf]

    def look():
        most[0] = max(most[0], energy() - first)

    engine = rigid.engine(dt, tolerance=TOLERANCE, restitution=case["restitution"])
    O.engines = O.engines + [hooks.runner(look, iterPeriod=1)]
    steps = max(1, round(DURATION / case["dt"]))
    hooks.simulate(steps)
    balance = (energy() - first + engine.dissipatedEnergy) / fall
    measures = {"penetration": engine.deepestPenetration / rigid.RADIUS, "energy_balance": balance, "energy_gain": most[0] / fall,
                "unconverged": engine.unconvergedSteps / steps}
    if measures["energy_gain"] > GROWTH or abs(balance) > GROWTH:
        return Outcome(UNSTABLE, "energy growth", rigid.told(engine), measures)
    if any(not inside(b.state.pos) for b in bodies.disks()):
        return Outcome(UNSTABLE, "tunnelled", rigid.told(engine), measures)
    if measures["penetration"] > rigid.DEEP:
        return Outcome(INACCURATE, "penetration", rigid.told(engine), measures)
    if measures["unconverged"] > UNSOLVED:
        return Outcome(NOT_SOLVED, "non-convergence", rigid.told(engine), measures)
    return Outcome(STABLE, measures=measures)


def pour(friction):
    """The trough and, above each other, rows of disks set off their places at random."""
    rigid.material(friction)
    rigid.floor()
    width, r = COLUMNS * 2.4 * rigid.RADIUS, rigid.RADIUS
    for side in (-1, 1):
        rigid.box((side * (width / 2 + r), 50 * r), (r, 50 * r))
    draw = random.Random(3)
    for k in range(COLUMNS * ROWS):
        column, row = k % COLUMNS, k // COLUMNS
        rigid.disk(((2.4 * column + 1.2 + draw.uniform(-0.15, 0.15)) * r - width / 2, (2 + 3 * row) * r))


def inside(place):
    """Whether a disk's centre is above the floor and between the walls."""
    return place[1] > 0 and abs(place[0]) < COLUMNS * 1.2 * rigid.RADIUS
