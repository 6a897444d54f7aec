"""A disk thrown at a fixed box, by springs or as a rigid body."""
import math

from yade import O

from yade_scripts import hooks, md, parameters
from yade_scripts.maps import INACCURATE, STABLE, UNSTABLE, Outcome
from yade_scripts.maps.probes import rigid

DISTANCES = (2.13, 2.38, 2.63, 2.88)  # in ways of a step: the phases at which the step meets the wall
CD_STEPS, MD_STEPS, CD_DT = 12, 400, 1e-4
NEAR = (0.1, 0.2, 0.3, 0.4)  # the same for a flight that begins in front of the wall, within half a step
SETTINGS = {"CD": {}, "CD e=0.5": {"restitution": 0.5}, "CD from near": {}, "CD colliderMargin=0": {"colliderMargin": 0.0}}
DEPTH = 0.5


def probe(case):
    """See the map of this name."""
    throw = springs if case["kind"] == "MD" else rigidly
    flights = []
    for distance in NEAR if case["kind"] == "CD from near" else DISTANCES:
        O.reset()
        rigid.material(0.0)
        rigid.box((0, 0), (1000 * rigid.RADIUS, case["thickness"] * rigid.RADIUS / 2))
        flights.append(throw(case, case["thickness"] * rigid.RADIUS / 2 + rigid.RADIUS, distance))
    measures = {"through": sum(beyond for beyond, _, _ in flights) / len(flights), "penetration": max(depth for _, depth, _ in flights) / rigid.RADIUS}
    told = next((said for _, _, said in flights if said), "")
    if measures["through"]:
        return Outcome(UNSTABLE, "tunnelled", told, measures)
    if measures["penetration"] > DEPTH:
        return Outcome(INACCURATE, "penetration", told, measures)
    return Outcome(STABLE, measures=measures)


def springs(case, contact, distance):
    """(whether it got through, largest overlap [m], ''): the default springs and their default step, without dashpots."""
    full = parameters.complete({})
    for material in O.materials:
        material.betan = 0.0
    dt = full["md_dt_factor"] * math.sqrt(rigid.MASS / parameters.stiffness(full))
    velocity = case["speed"] * rigid.RADIUS * math.sqrt(parameters.stiffness(full) / rigid.MASS)
    disk = rigid.disk((0, contact + distance * velocity * dt), velocity=(0, -velocity))
    state, lowest = O.bodies[disk].state, [math.inf]

    def look():
        lowest[0] = min(lowest[0], state.pos[1])

    O.engines = md.contact_engines(full) + [md.integrator(full), hooks.runner(look, iterPeriod=1)]
    O.dt = dt
    hooks.simulate(MD_STEPS)
    return state.pos[1] < 0, max(0.0, contact - lowest[0]), ""


def rigidly(case, contact, distance):
    """(whether it got through, largest overlap [m], what the engine said)."""
    velocity = case["speed"] * rigid.RADIUS / CD_DT
    disk = rigid.disk((0, contact + distance * velocity * CD_DT), velocity=(0, -velocity))
    engine = rigid.engine(CD_DT, (0, 0, 0), tolerance=1e-10, **SETTINGS[case["kind"]])
    O.run(CD_STEPS, True)
    return O.bodies[disk].state.pos[1] < 0, engine.deepestPenetration, rigid.told(engine)
