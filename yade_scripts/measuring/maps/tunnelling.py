"""Map of both methods: speed against the thickness of a wall that must stop a disk."""
import math

from yade_scripts import parameters
from yade_scripts.measuring.maps import Axis, INACCURATE, Map, STABLE, UNSTABLE, judged, lines, logarithmic, product

DISTANCES = (2.13, 2.38, 2.63, 2.88)  # start from the wall, in displacements of a step, to vary when in a step the disk arrives
CD_STEPS, MD_STEPS, CD_DT = 12, 400, 1e-4
NEAR = (0.1, 0.2, 0.3, 0.4)  # the same for flights of the last kind
DEPTH = 0.5
KINDS = ("MD", "CD", "CD e=0.5", "CD from near")  # the last: flights that begin within half a step of the wall
THICKNESSES = {True: logarithmic(0.01, 10, 4), False: [0.1, 1.0]}  # of the full and of the quick map


def turning(at):
    """Return for springs the speed, in R sqrt(k_n/m), at which the centre reaches the wall's mid-plane: there a box reverses its contact normal."""
    return 1 + at["thickness"] / 2 if at["kind"] == "MD" else math.nan


MAP = Map(
    order=10,
    title="Both methods: a disk thrown at a wall",
    question="How fast must a disk be to pass through a wall?",
    criterion="A disk flies at a fixed box without gravity, from four distances; springs have no dashpots and md_dt_factor 0.2. Unstable: "
              "the disk ends beyond the box. Inaccurate: on its way it overlaps the box by more than half its radius.",
    remedy="A rigid disk is stopped at any speed, unless its flight begins within half a step of the wall (CD from near): then it may end up "
           "to a radius deep in it. Springs stop a disk if v sqrt(m/k_n) is below R; for an overlap below R/10, k_n must exceed 100 m "
           "v^2/R^2.",
    x=Axis("speed", r"$v\sqrt{m/k_n}/R$ (MD), $v\,dt/R$ (CD)"), y=Axis("thickness", "thickness of the wall / R"), panels="kind",
    measures={"through": "share of the four that got through", "penetration": "largest overlap over the radius"},
    grid=lambda full: product(kind=KINDS, thickness=THICKNESSES[full], speed=logarithmic(0.01, 100, 13 if full else 5)),
    searches=lambda full: lines("speed", 0.01, 1000.0, 1.02 if full else 1.1, (STABLE, INACCURATE), kind=KINDS,
                                thickness=THICKNESSES[full]),
    theory=turning, theory_label="springs: the centre\npasses the mid-plane", theory_along="speed")


def probe(case):
    from yade import O
    from yade_scripts.measuring import rigid
    throw, half, flights = springs if case["kind"] == "MD" else rigidly, case["thickness"] * rigid.RADIUS / 2, []
    for distance in NEAR if case["kind"] == KINDS[-1] else DISTANCES:
        O.reset()
        ground = rigid.ground(0.0)
        ground.box((0, 0), (1000 * rigid.RADIUS, half))
        flights.append(throw(ground, case, half + rigid.RADIUS, distance))
    beyond, depths, said = zip(*flights)
    measures = {"through": sum(beyond) / len(flights), "penetration": max(depths) / rigid.RADIUS}
    return judged(measures, next(filter(None, said), ""), (UNSTABLE, "tunnelled", measures["through"]),
                  (INACCURATE, "penetration", measures["penetration"] > DEPTH))


def springs(ground, case, contact, distance):
    """Return (whether it got through, largest overlap [m], '') by the default springs and their default step, without dashpots."""
    from yade import O
    from yade_scripts.measuring import rigid
    from yade_scripts.running import hooks, md
    full = parameters.complete({})
    md.set_damping(0.0)
    dt = full["md_dt_factor"] * math.sqrt(rigid.MASS / parameters.stiffness(full))
    velocity = case["speed"] * rigid.RADIUS * math.sqrt(parameters.stiffness(full) / rigid.MASS)
    state, heights = ground.disk((0, contact + distance * velocity * dt), velocity=(0, -velocity)).state, []
    O.engines = md.contact_engines(full) + [md.integrator(full), hooks.runner(lambda: heights.append(state.pos[1]), iterPeriod=1)]
    O.dt = dt
    hooks.simulate(MD_STEPS)
    return state.pos[1] < 0, max(0.0, contact - min(heights)), ""


def rigidly(ground, case, contact, distance):
    """Return (whether it got through, largest overlap [m], what the engine said) of rigid contacts."""
    from yade import O
    from yade_scripts.measuring import rigid
    velocity = case["speed"] * rigid.RADIUS / CD_DT
    disk = ground.disk((0, contact + distance * velocity * CD_DT), velocity=(0, -velocity))
    engine = rigid.engine(CD_DT, (0, 0, 0), tolerance=1e-10, restitution=0.5 if case["kind"] == "CD e=0.5" else 0.0)
    O.run(CD_STEPS, True)
    return disk.state.pos[1] < 0, engine.deepestPenetration, rigid.told(engine)
