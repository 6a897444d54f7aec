"""Map of CD in space: time step against the size of the triangles over which a sphere rolls."""
import math

from yade_scripts.measuring.maps import Axis, INACCURATE, Map, UNSTABLE, judged, lines, logarithmic, product

RADIUS, SPEED, FRICTION = 0.05, 1.0, 0.5  # [m], [m/s]
WIDE, STARTS = 5, 4  # of the tube: distance of its faces from the axis over the radius, first places
LIMITS = {"flat": (1e-6, 1e-2), "tube": (1e-2, 0.1)}  # errors of the motion beyond which a case is inaccurate and unstable
SIZES = {True: logarithmic(0.7, 10, 8), False: logarithmic(0.9, 10, 4)}


def angle(size):
    """Return the angle [rad] between the faces of the tube, whose number is that nearest to this size over the radius."""
    return 2 * math.pi / max(4, round(math.pi / math.atan(size / (2 * WIDE))))


MAP = Map(
    order=22,
    title="Spheres in space: rolling over triangles",
    question="How far may a sphere move in a step that rolls over a mesh, and how small may the triangles be?",
    criterion="Flat: a sphere rolls over random triangles, slivers among them, as over a plane (scene mesh_floor); inaccurate if speed or "
              "height is off by more than 1e-6, unstable by more than 1e-2. Tube: it rolls half around the inside of a regular polygon, 5 R "
              "from the axis, without gravity; each next face leaves (2 + 5 cos t)/7 of its speed, where t is the angle between faces "
              "(scene valley). Inaccurate: the speed is off by more than 1 % from one of four first places. "
              "Unstable: by more than 10 %, or the sphere is outside. "
              "Both: inaccurate if it overlaps a triangle by more than 1 % of R, unstable by more than 10 %.",
    remedy="On flat meshes nothing fails. In round ones a sphere that moves by more than a third of the triangles' size in a step may sink "
           "in, with a warning; at large angles it meets the next face late and its speed is off, without one.",
    x=Axis("share", r"$v\,dt/R$"), y=Axis("size", "size of the triangles / R"), panels="surface",
    measures={"error": "largest error of speed, way aside and height, relative", "penetration": "largest overlap over the radius"},
    grid=lambda full: product(surface=list(LIMITS), size=SIZES[full], share=logarithmic(0.01, 1, 10 if full else 4)),
    searches=lambda full: lines("share", 0.005, 2.0, 1.05 if full else 1.3, surface=list(LIMITS), size=SIZES[full]))


def probe(case):
    errors, outside, depths, said = zip(*(flat(case) if case["surface"] == "flat" else tube(case, start / STARTS) for start in
                                          range(1 if case["surface"] == "flat" else STARTS)))
    measures = {"error": max(errors), "penetration": max(depths) / RADIUS}
    (fine, coarse), depth = LIMITS[case["surface"]], measures["penetration"]
    return judged(measures, next(filter(None, said), ""), (UNSTABLE, "tunnelled", any(outside)), (UNSTABLE, "penetration", depth > 0.1),
                  (UNSTABLE, "wrong motion", measures["error"] > coarse), (INACCURATE, "penetration", depth > 0.01),
                  (INACCURATE, "wrong motion", measures["error"] > fine))


def flat(case):
    """Return (error, whether it fell through, largest overlap [m], what the engine said) of a sphere on a floor of triangles."""
    from yade_scripts.measuring import space_cases
    dt = case["share"] * RADIUS / SPEED
    steps = min(50, max(1, int(2.5 / (10 * SPEED * dt)))) * 10  # at most 2.5 m, and at most 500 steps
    run = space_cases.Case("mesh_floor", steps, dt, radius_mean=RADIUS, speed=SPEED, restitution=0.5, friction=FRICTION,
                           corners=max(4, round(2 / (case["size"] * RADIUS)**2)))  # two triangles a corner on 4 m^2
    run.run()
    return (max(map(run.error, ("speed", "aside", "height"))), run.sphere.state.pos[1] < 0, run.engine.deepestPenetration, run.told)


def tube(case, start):
    """Return the same of a sphere in a polygonal tube about z. start: of a step, by which its first place is shifted."""
    from yade import O
    from yade_scripts.measuring import rigid, space_cases
    from yade_scripts.running import hooks
    O.reset()
    t, dt = angle(case["size"]), case["share"] * RADIUS / SPEED
    ground, faces = space_cases.ground(RADIUS, FRICTION), round(2 * math.pi / t)
    passed = faces // 2
    far = WIDE * RADIUS / math.cos(t / 2)
    at = lambda k, z: (far * math.sin((k - 0.5) * t), -far * math.cos((k - 0.5) * t), z)
    for k in range(faces):
        one, two, three, four = at(k, -RADIUS), at(k + 1, -RADIUS), at(k + 1, RADIUS), at(k, RADIUS)
        ground.facets([(one, two, three), (one, three, four)])
    sphere = ground.sphere((start * SPEED * dt, -(WIDE - 1) * RADIUS, 0), (SPEED, 0, 0), (0, 0, -SPEED / RADIUS)).state
    kept, length = (2 + 5 * math.cos(t)) / 7, 2 * (WIDE - 1) * RADIUS * math.tan(t / 2)
    time = sum((0.5 if k in (0, passed) else 1) * length / (SPEED * kept**k) for k in range(passed + 1))  # to the middle of the last face
    engine = rigid.engine(dt, (0, 0, 0), tolerance=1e-13)
    hooks.simulate(max(1, round(time / dt)))
    outside = math.hypot(sphere.pos[0], sphere.pos[1]) > far or not abs(sphere.pos[2]) < RADIUS
    return abs(sphere.vel.norm() / (SPEED * kept**passed) - 1), outside, engine.deepestPenetration, rigid.told(engine, RADIUS)
