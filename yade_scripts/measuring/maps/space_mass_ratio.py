"""Map of CD in space: tolerance against the ratio of masses, for a heavy or light sphere on light ones."""
import math

from yade_scripts.measuring.maps import Axis, INACCURATE, Map, NOT_SOLVED, TOLERANCES, UNSTABLE, judged, lines, logarithmic, product

STEPS, DT = 20, 1e-3
FRICTION, GAP = 0.5, 1e-3  # of the nest: gap between its lower spheres over the radius, so that they do not touch
IN_TUBE = 5
PILES = "nest", "tube"
TRIED = {True: logarithmic(1e-10, 1e-1, 10), False: logarithmic(1e-10, 1e-1, 4)}  # tolerances of the full and of the quick map

MAP = Map(
    order=23,
    title="Spheres in space: heavy on light",
    question="How much heavier or lighter may a sphere be than those that carry it?",
    criterion="Nest: a sphere on three equally large ones on a floor, mu = 0.5, held by friction alone. Tube: the uppermost of five spheres in "
              "a square tube without friction. 20 steps of 1 ms from rest without forces. Not solved: steps missed the tolerance. Unstable: "
              "bodies overlap by more than 1 % of the radius. Inaccurate: a force is off by more than 1 % of the exact normal force of its contact.",
    remedy="Under a heavy sphere steps miss small tolerances, and the program says so. On a light one forces are off without a warning: "
           "lower the tolerance by the ratio of the masses.",
    x=Axis("tolerance", "tolerance"), y=Axis("mass_ratio", "mass above / mass below"), panels="pile",
    measures={"force_error": "largest error of a contact force, relative to the exact normal force there",
              "penetration": "largest overlap over the radius", "unconverged": "share of the steps that missed the tolerance"},
    grid=lambda full: product(pile=PILES, tolerance=TRIED[full], mass_ratio=logarithmic(1e-6, 1e6, 9 if full else 5)),
    searches=lambda full: (lines("mass_ratio", 1.0, 1e8, 1.1 if full else 1.5, pile=PILES, tolerance=[one for one in TRIED[full] if one < 0.01]) +
                           lines("tolerance", 1e-10, 0.1, 1.1 if full else 1.5, pile=PILES,
                                 mass_ratio=logarithmic(1e-6, 1e-1, 6) if full else [1e-6, 1e-3])),
    marks=TOLERANCES)


def probe(case):
    from yade_scripts.measuring import rigid
    from yade_scripts.running import hooks
    forces = (nest if case["pile"] == "nest" else tube)(case["mass_ratio"])
    engine = rigid.engine(DT, tolerance=case["tolerance"])
    hooks.simulate(STEPS)
    measures = {"force_error": max(abs(measure() - exact) / load for measure, exact, load in forces),
                "penetration": engine.deepestPenetration / rigid.RADIUS, "unconverged": engine.unconvergedSteps / STEPS}
    return judged(measures, rigid.told(engine), (NOT_SOLVED, "non-convergence", engine.unconvergedSteps),
                  (UNSTABLE, "penetration", measures["penetration"] > rigid.DEEP), (INACCURATE, "wrong forces", measures["force_error"] > 0.01))


def nest(ratio):
    """Build the nest. Return [(function that measures a force, exact force, normal force of the contact)] [N]. A lower sphere is held at its two
    contacts, so their forces act along the line through both: the normal forces of the load W are W/3 each, the frictions W/3 tan(angle/2)."""
    from yade_scripts.measuring import rigid, space_cases
    ground, radius, apart = space_cases.ground(rigid.RADIUS, FRICTION), rigid.RADIUS, 2 / math.sqrt(3) * (1 + GAP)
    floor = ground.wall(0, 1)
    angles = [0.3 + 2 * math.pi / 3 * k for k in range(3)]  # no axis of the scene
    lower = [ground.sphere((apart * radius * math.cos(angle), radius, apart * radius * math.sin(angle))).id for angle in angles]
    upper = space_cases.heavier(ground.sphere((0, radius * (1 + math.sqrt(4 - apart**2)), 0)), ratio)
    own, load = rigid.GRAVITY * ground.mass, rigid.GRAVITY * ground.mass * ratio / 3
    friction = load * math.tan(math.asin(apart / 2) / 2)
    return [one for k in lower for pair, normal in (((k, upper), load), ((floor, k), load + own))
            for one in ((space_cases.normal(*pair), normal, normal), (space_cases.tangential(*pair), friction, normal))]


def tube(ratio):
    """Build the tube, as the scene of this name does. Return the same, of the floor and between the spheres."""
    from yade_scripts.measuring import rigid, space_cases
    run = space_cases.Case("tube", STEPS, DT, disks=IN_TUBE)
    space_cases.heavier(run.spheres[-1], ratio)
    ids, d = [body.id for body in run.spheres], run.full["tube_width"] / 2 - 1
    weights = [rigid.GRAVITY * run.spheres[0].state.mass * (ratio + IN_TUBE - 1 - k) for k in range(IN_TUBE)]
    loads = [weights[0], *(weight / math.sqrt(1 - 2 * d**2) for weight in weights[1:])]  # along lines of centres that rise by this
    return [(space_cases.normal(*pair), load, load) for pair, load in zip(zip([run.floor, *ids], ids), loads)]
