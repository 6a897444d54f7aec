"""Measures the DEM community's benchmark (Dosta et al. 2024, Comput. Phys. Commun. 296, 109066) by Contact Dynamics and by YADE's springs.

    yade -n -x yade_scripts/measuring/in_yade.py benchmark.community '{"case": "silo", "material": "M1", "larger": 3, "softer": 100, "seed": 1}'

Materials, friction and restitution by pair, contact law, time step and turning of the drum are those of YADE's scripts for this benchmark
(examples/DEM2020Benchmark in its package). Their files of positions cannot be had here, so the initial states are made by this script: spheres fall
into the vessel and come to rest, by Contact Dynamics; both methods then start from this one state. Sizes that the scripts do not tell are ours:

    silo          a cylinder of 200 mm with a funnel of 45 degrees (as in the package's variant with custom filling), 122 000 spheres of 4 mm, an
                  orifice of 40 mm (small) or 60 mm (large); the value is the share of the spheres that have left
    drum          inner diameter 100 mm, 50 mm long, a third full, 2 rad/s; half of the volume are spheres of 2 mm of material M1, on the left
                  at first, half of 4 mm of M2; the value is the share of M1 in the lower right quadrant
    penetration   a steel sphere of 20 mm hits 25 000 spheres of 2 mm in a box 60 mm wide at 5 m/s; the value is its depth in its diameters

`larger` multiplies the diameters of the grains (their number falls with its cube) and `softer` divides Young's moduli; the springs' step follows,
as r sqrt(rho/E). With `window` [steps of springs] only the cost of silo or drum is measured: Contact Dynamics runs for BEFORE seconds, then both
methods for a while from that state.
"""
import math
import os
import random
import tempfile
import time

from yade import FrictMat, O, Vector3, geom, utils
from yade.wrapper import (Bo1_Facet_Aabb, Bo1_Sphere_Aabb, ForceResetter, Ig2_Facet_Sphere_ScGeom, Ig2_Sphere_Sphere_ScGeom, InsertionSortCollider,
                          InteractionLoop, Ip2_FrictMat_FrictMat_MindlinPhys, Law2_ScGeom_MindlinPhys_Mindlin, MatchMaker, NewtonIntegrator,
                          RotationEngine, Sphere)

import cd_engine

GRAVITY = (0, 0, -9.81)
STEEL, M1, M2 = range(3)  # ids of the materials
MATERIALS = (("Steel", 210e9, 7200), ("M1", 1e9, 2500), ("M2", 0.5e9, 2000))  # Young's modulus [Pa], density [kg/m^3]
PAIRS = ((M1, M2, 0.2, 0.45), (M1, M1, 0.3, 0.5), (STEEL, M1, 0.2, 0.4), (M2, M2, 0.4, 0.4), (STEEL, M2, 0.2, 0.4), (STEEL, STEEL, 0.2, 0.4))
FRICTION = MatchMaker(matches=[(one, other, math.atan(mu)) for one, other, mu, _ in PAIRS])
RESTITUTION = MatchMaker(matches=[(one, other, e) for one, other, _, e in PAIRS])
SPRINGS_STEP = {("silo", "M1"): 1.5e-6, ("silo", "M2"): 2e-6, ("drum", ""): 8e-7, ("penetration", ""): 5e-7}  # [s], of the true grains
BOX, BALL, FAST = 0.03, 0.01, 5.0  # half the width of the box, radius of the steel sphere [m], its speed [m/s]
SHARE = 0.15  # of the smallest radius, by which a sphere moves in a step of Contact Dynamics at FASTEST [m/s], at an impact at the speed it then has
FASTEST, SLOW = {"silo": 1.0, "drum": 0.5, "penetration": FAST}, 0.3  # [m/s]; SLOW: at an impact at this speed at least
ENOUGH = dict(tolerance=1e-2, gapCorrection=0.1)  # silo: 1e-3 gives 1 % more discharge, for 2.5 times the cost
DURATION = {"silo": 5.0, "drum": 5.0, "penetration": 0.1}  # of the benchmark [s]
SAMPLE = {"silo": 0.05, "drum": 0.1, "penetration": 2e-3}  # time between two samples [s]
BEFORE = {"silo": 0.3, "drum": 0.3}
SETTLED, SETTLE = 1.2, {"silo": 5e-4, "drum": 1e-3, "penetration": 5e-4}  # duration and step of the filling [s]
WIDE, ORIFICES = 0.1, {"small": 0.02, "large": 0.03}  # radii of the silo [m]
DRUM, LONG, SPIN = 0.05, 0.05, 2.0  # radius and length [m], rad/s


class Case:
    """A vessel with spheres at rest. start(): begins what the case is about. turning(): engines that move the vessel. look(): the value."""

    def start(self):
        pass

    def turning(self):
        return []


class Silo(Case):
    def __init__(self, draw, larger, orifice="small", material="M1"):
        radius, self.low = 2e-3 * larger, ORIFICES[orifice] - WIDE
        self.count, kind = round(122000 / larger**3), (M1, M2)[material == "M2"]
        O.bodies.append(geom.facetCylinder((0, 0, 0.4), WIDE, 0.8, segmentsNumber=48, wallMask=4, material=STEEL))
        O.bodies.append(geom.facetCone((0, 0, self.low / 2), WIDE, ORIFICES[orifice], -self.low, segmentsNumber=48, wallMask=4, material=STEEL))
        w = 1.5 * ORIFICES[orifice]
        corners = [(x, y, self.low) for x, y in ((-w, -w), (w, -w), (w, w), (-w, w))]
        self.plug = [O.bodies.append(utils.facet([corners[k] for k in three], material=STEEL)) for three in ((0, 1, 2), (0, 2, 3))]
        _fill(draw, self.count, radius, kind, lambda x, y, z: math.hypot(x, y) < WIDE - 1.2 * radius and math.hypot(x, y) < z + WIDE - 2 * radius,
              WIDE, self.low + 2 * radius)

    def start(self):
        for facet in self.plug:
            O.bodies.erase(facet)

    def look(self):
        fallen = [b.id for b in O.bodies if isinstance(b.shape, Sphere) and b.state.pos[2] < self.low]
        for grain in fallen:
            if O.bodies[grain].state.pos[2] < self.low - 0.05:
                O.bodies.erase(grain)
        inside = sum(isinstance(b.shape, Sphere) and b.state.pos[2] >= self.low for b in O.bodies)
        return 1 - inside / self.count


class Drum(Case):
    def __init__(self, draw, larger):
        radii = {M1: 1e-3 * larger, M2: 2e-3 * larger}
        self.drum = O.bodies.append(geom.facetCylinder((0, 0, 0), DRUM, LONG, orientation=utils.Quaternion((1, 0, 0), math.pi / 2),
                                                       segmentsNumber=48, wallMask=7, material=STEEL))
        volume = math.pi * DRUM**2 / 3 * LONG * 0.6 / 2  # of each kind
        for kind, side in (M1, -1), (M2, 1):
            radius = radii[kind]
            _fill(draw, round(volume / (4 / 3 * math.pi * radius**3)), radius, kind,
                  lambda x, y, z: math.hypot(x, z) < DRUM - 1.1 * radius and abs(y) < LONG / 2 - 1.1 * radius and x * side > 1.05 * radius,
                  DRUM, -DRUM)

    def turning(self):
        return [RotationEngine(ids=self.drum, rotationAxis=(0, 1, 0), angularVelocity=SPIN, rotateAroundZero=True, zeroPoint=(0, 0, 0))]

    def look(self):
        fine = [b.state.pos for b in O.bodies if isinstance(b.shape, Sphere) and b.mat.label == "M1"]
        return sum(x > 0 > z for x, _, z in fine) / len(fine)


class Penetration(Case):
    def __init__(self, draw, larger):
        radius, high = 1e-3 * larger, 0.3
        O.bodies.append(geom.facetBox((0, 0, high / 2), (BOX, BOX, high / 2), wallMask=31, material=STEEL))
        _fill(draw, round(25000 / larger**3), radius, M1, lambda x, y, z: max(abs(x), abs(y)) < BOX - 1.1 * radius, BOX, 1.2 * radius)

    def start(self):
        top = max(b.state.pos[2] + b.shape.radius for b in O.bodies if isinstance(b.shape, Sphere))
        self.ball = O.bodies.append(utils.sphere((0, 0, top + 1.01 * BALL), BALL, material=STEEL))
        self.top = O.bodies[self.ball].state.pos[2]
        O.bodies[self.ball].state.vel = (0, 0, -FAST)

    def look(self):
        return (self.top - O.bodies[self.ball].state.pos[2]) / (2 * BALL)


CASES = {"silo": Silo, "drum": Drum, "penetration": Penetration}


def _fill(draw, count, radius, material, is_inside, reach, low):
    """Append `count` spheres in loose layers from the height `low` upwards where `is_inside(x, y, z)`; reach: largest |x| and |y|."""
    pitch, z, placed = 2.1 * radius, low, 0
    most = int(reach / pitch)
    while placed < count:
        if z > 1:
            raise RuntimeError(f"{count} spheres of {2e3 * radius:g} mm do not fit into the vessel")
        for i in range(-most, most + 1):
            for j in range(-most, most + 1):
                at = [value + draw(-0.05, 0.05) * radius for value in (pitch * i, pitch * j, z)]
                if placed < count and is_inside(*at):
                    O.bodies.append(utils.sphere(at, radius, material=material))
                    placed += 1
        z += pitch


def _contact_dynamics(scene, step, **settings):
    cd_engine.release()
    reset, collider, engine = cd_engine.engines(gravity=GRAVITY, threads=1, frictAngle=FRICTION, **ENOUGH, **settings)
    O.engines = [reset, collider, *scene.turning(), engine]
    O.dt = step


def _springs(scene, step, radius):
    cd_engine.release()
    O.engines = [
        ForceResetter(), InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Facet_Aabb()], verletDist=0.1 * radius),
        InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Facet_Sphere_ScGeom(hertzian=True)],
                        [Ip2_FrictMat_FrictMat_MindlinPhys(frictAngle=FRICTION, en=RESTITUTION)],
                        [Law2_ScGeom_MindlinPhys_Mindlin(preventGranularRatcheting=False)]),
        *scene.turning(), NewtonIntegrator(damping=0, gravity=GRAVITY)]
    O.dt = step


def main(case, seed=1, larger=1.0, softer=1.0, window=0, seconds=None, orifice="", material=""):
    """Return a row for each sample of each method, or one for its cost. seconds: until which samples are taken, by default DURATION. step: the last
    one."""
    O.reset()
    for label, young, density in MATERIALS:
        O.materials.append(FrictMat(young=young / softer, poisson=0.2, density=density, label=label))
    given = {name: value for name, value in (("orifice", orifice), ("material", material)) if value}
    scene = CASES[case](random.Random(seed).uniform, larger, **given)
    radii = [b.shape.radius for b in O.bodies if isinstance(b.shape, Sphere)]
    _contact_dynamics(scene, SETTLE[case])  # without rebounds, so that no overlaps are left
    O.run(round(SETTLED / SETTLE[case]), True)
    for body in O.bodies:
        body.state.vel = body.state.angVel = Vector3.Zero
    scene.start()
    step, long = SPRINGS_STEP[case, material] * larger * math.sqrt(softer), SHARE * min(radii) / FASTEST[case]
    facts = {"status": "measured", "case": case, "orifice": orifice, "material": material, "seed": seed, "spheres": len(radii), "larger": larger,
             "softer": softer}
    set_engines = {"CD": lambda: _contact_dynamics(scene, long, en=RESTITUTION), "MD": lambda: _springs(scene, step, min(radii))}
    if window:
        set_engines["CD"]()
        O.run(round(BEFORE[case] / long), True)
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "state.yade.gz")
        O.save(path)
        for method, set_them in set_engines.items():
            O.load(path)
            O.resetTime()
            set_them()
            found = [_cost(case, window)] if window else _series(scene, case, seconds or DURATION[case])
            rows += [facts | {"method": method, "step": O.dt} | row for row in found]
    return rows


def _timed(steps):
    """Run steps. Return their processor time [s]."""
    begun = time.process_time()
    O.run(steps, True)
    return time.process_time() - begun


def _series(scene, case, until):
    spent, rows = 0.0, [{"t": 0.0, "value": scene.look(), "seconds": 0.0} | _state()]
    while O.time < until - 0.5 * SAMPLE[case]:
        if case == "penetration" and isinstance(O.engines[-1], cd_engine.ContactDynamics):  # as a user calls timeStep() again
            spheres = [b for b in O.bodies if isinstance(b.shape, Sphere)]
            fastest = max(SLOW, max(b.state.vel.norm() for b in spheres))
            O.dt = SHARE * min(b.shape.radius for b in spheres) / fastest
        spent += _timed(max(1, round(SAMPLE[case] / O.dt)))
        rows.append({"t": O.time, "value": scene.look(), "seconds": spent} | _state())
    return rows


def _cost(case, window):
    """Return the processor time of a step, of springs from `window` steps, of Contact Dynamics from a tenth as many, and that of the whole
    benchmark."""
    steps = max(20, window // 10) if isinstance(O.engines[-1], cd_engine.ContactDynamics) else window
    _timed(5)
    spent = _timed(steps) / steps
    return {"seconds_a_step": spent, "seconds": spent * DURATION[case] / O.dt} | _state()


def _state():
    """Return the number of contacts; of Contact Dynamics also that of the steps that missed their tolerance, the mean of their sweeps, and the
    largest overlap over the smallest radius."""
    engine = O.engines[-1]
    if isinstance(engine, cd_engine.ContactDynamics):
        smallest = min(b.shape.radius for b in O.bodies if isinstance(b.shape, Sphere))
        return {"contacts": engine.contacts, "missed": engine.unconvergedSteps, "sweeps": engine.totalIterations / max(1, engine.steps),
                "overlap": engine.deepestPenetration / smallest}
    return {"contacts": O.interactions.countReal()}
