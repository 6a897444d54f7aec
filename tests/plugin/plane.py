"""Bodies of a plane scene, as the tests build them: SI units, disks of depth 1 m."""
import array
import hashlib
import math
import random
import re

import numpy as np
import yade
from yade import utils, wrapper as w

import cd_engine


def material(mu=0.5):
    """Append a material with friction coefficient mu. Return its index in O.materials."""
    return yade.O.materials.append(w.FrictMat(young=1e6, poisson=0.3, density=1000, frictionAngle=math.atan(mu)))


def disk(position, radius, mass=1.0, blocked="zXY", velocity=(0, 0), spin=0.0, mat=None):
    """Append a disk at (x, y) of `mass` [kg] and moment of inertia m r^2/2. Return its id."""
    body = utils.sphere((*position, 0), radius, material=material() if mat is None else mat)
    body.state.mass = mass
    body.state.inertia = (mass * radius**2 / 2,) * 3
    body.state.blockedDOFs = blocked
    body.state.vel = (*velocity, 0)
    body.state.angVel = (0, 0, spin)
    return yade.O.bodies.append(body)


def viscous_springs(stiffness, ratio, damping, mu):
    """Give all bodies a material with dashpots and friction. Return the engines up to InteractionLoop; stiffness: k_n [N/m], ratio: k_t/k_n, damping:
    beta_n."""
    material = w.FrictViscoMat(betan=damping, density=1000, frictionAngle=math.atan(mu))
    for body in yade.O.bodies:
        body.material = material
    kn, kt_over_kn = (w.MatchMaker(algo="val", val=value) for value in (stiffness, ratio))
    return [w.ForceResetter(), w.InsertionSortCollider([w.Bo1_Sphere_Aabb(), w.Bo1_Box_Aabb(), w.Bo1_Wall_Aabb()], verletDist=1e-3),
            w.InteractionLoop([w.Ig2_Sphere_Sphere_ScGeom(), w.Ig2_Box_Sphere_ScGeom(), w.Ig2_Wall_Sphere_ScGeom()],
                              [w.Ip2_FrictViscoMat_FrictViscoMat_FrictViscoPhys(kn=kn, kRatio=kt_over_kn)],
                              [w.Law2_ScGeom_FrictViscoPhys_CundallStrackVisco()])]


def floor(mat=None):
    """Append a fixed Wall at y = 0. Return its id."""
    return yade.O.bodies.append(utils.wall(0, axis=1, material=material() if mat is None else mat))


def ground(mu=0.5):
    """Append a material with friction coefficient mu and a floor of it. Return the index of the material."""
    mat = material(mu)
    floor(mat)
    return mat


def box(position, half, angle=0.0, blocked="xyzXYZ", mass=1.0, inertia=1.0, mat=None):
    """Append a Box turned by `angle` [rad] about z. Return its id."""
    q = yade.Quaternion((0, 0, 1), angle)
    body = utils.box((*position, 0), (*half, 0.5), orientation=q, fixed=True, material=material() if mat is None else mat)
    body.state.mass = mass
    body.state.inertia = (inertia,) * 3
    body.state.blockedDOFs = blocked
    return yade.O.bodies.append(body)


def column(x=0, disks=3, y=0.01, mat=None, **each):
    """Append disks of 1 cm on each other, the lowest at (x, y). Return their ids."""
    return [disk((x, y + 0.02 * k), 0.01, mat=mat, **each) for k in range(disks)]


def columns(*places, disks=3, mu=0.5, **each):
    """Append a floor (#0) and a column of disks on it at each place. Return the ids of each column."""
    mat = ground(mu)
    return [column(x, disks, mat=mat, **each) for x in places]


def disk_on_a_floor(dt=1e-3, **settings):
    """Append a floor (#0) and a disk at rest on it (#1); set the engines, with gravity, and the time step. Return the engines."""
    columns(0, disks=1)
    engine(dt, **{"gravity": (0, -9.81, 0)} | settings)
    return yade.O.engines


def two_on_a_floor(ratio, steps, **settings):
    """Put a disk of `ratio` kg (#2) on a disk of 1 kg (#1) on a floor (#0), at rest and without forces; steps under gravity. Return the engine."""
    columns(0, disks=1)
    column(disks=1, y=0.03, mass=ratio)
    return run(steps, 1e-3, gravity=(0, -9.81, 0), **settings)


def grid(disks, wide, corner, pitch, mat=None, **each):
    """Append disks of 1 cm in rows of `wide`, the first at `corner`, each `pitch` (x, y) from the next. Return their ids."""
    return [disk((corner[0] + pitch[0] * (k % wide), corner[1] + pitch[1] * (k // wide)), 0.01, mat=mat, **each) for k in range(disks)]


def hollows(rows, wide, mat=None):
    """Append rows of disks of 1 cm, each in the hollows of the one below: `wide` disks and one fewer in turn, above y = 0 and from x = 0 on."""
    for j in range(rows):
        for i in range(wide - j % 2):
            disk((0.01 * (2 * i + 1 + j % 2), 0.01 * (1 + math.sqrt(3) * j)), 0.01, mat=mat)


def heap(mu):
    """Append a floor (#0), two walls and thirty disks of unequal size above it, which fall to a heap."""
    mat = ground(mu)
    for x in (-0.3, 0.3):
        box((x, 0.3), (0.02, 0.5), mat=mat)
    r = random.Random(3)
    for i in range(30):
        disk((-0.22 + 0.088 * (i % 6) + r.uniform(-.01, .01), 0.1 + 0.1 * (i // 6)), r.uniform(0.02, 0.034), mass=r.uniform(0.5, 2), mat=mat)


def cloud(count, seed, mu=0.4, speed=1.0):
    """Append disks of mixed sizes and masses thrown at their common centre, without boundaries."""
    r = random.Random(seed)
    mat = material(mu)
    wide = math.ceil(math.sqrt(count))
    for i in range(count):
        x, y = (0.05 * (k - (wide - 1) / 2) + r.uniform(-.004, .004) for k in divmod(i, wide))
        a, size = math.atan2(y, x), r.uniform(0.01, 0.02)
        v = (-speed * math.cos(a) + r.uniform(-.2, .2), -speed * math.sin(a) + r.uniform(-.2, .2))
        disk((x, y), size, mass=r.uniform(0.1, 2), velocity=v, spin=r.uniform(-30, 30), mat=mat)


def engine(dt=1e-3, **settings):
    """Set the engines and the time step. Return the ContactDynamics engine."""
    yade.O.engines, yade.O.dt = cd_engine.engines(**settings), dt
    return yade.O.engines[-1]


def run(steps, dt, **settings):
    """The same, and make the steps."""
    cd = engine(dt, **settings)
    yade.O.run(steps, True)
    return cd


def springs(gravity=(0, -9.81, 0), damping=0.2, **collider):
    """Return YADE's engines for springs between disks, boxes and walls; collider: settings of the collider."""
    return [w.ForceResetter(), w.InsertionSortCollider([w.Bo1_Sphere_Aabb(), w.Bo1_Box_Aabb(), w.Bo1_Wall_Aabb()], **collider),
            w.InteractionLoop([w.Ig2_Sphere_Sphere_ScGeom(), w.Ig2_Box_Sphere_ScGeom(), w.Ig2_Wall_Sphere_ScGeom()],
                              [w.Ip2_FrictMat_FrictMat_FrictPhys()], [w.Law2_ScGeom_FrictPhys_CundallStrack()]),
            w.NewtonIntegrator(gravity=gravity, damping=damping)]


def kinetic_energy():
    """Kinetic energy [J] of all free bodies in plane motion."""
    total = 0.0
    for b in yade.O.bodies:
        if b.state.blockedDOFs == "xyzXYZ":
            continue
        v, w = b.state.vel, b.state.angVel[2]
        total += 0.5 * b.state.mass * (v[0]**2 + v[1]**2) + 0.5 * b.state.inertia[2] * w * w
    return total


def momenta():
    """Linear momentum x, y and angular momentum about the origin, of all bodies."""
    total = np.zeros(3)
    for b in yade.O.bodies:
        m, x, v = b.state.mass, b.state.pos, b.state.vel
        total += (m * v[0], m * v[1], m * (x[0] * v[1] - x[1] * v[0]) + b.state.inertia[2] * b.state.angVel[2])
    return total


def digest(born=True):
    """SHA-256 of all that a step leaves in the scene: motion, forces on bodies, loaded contacts; born: and the steps in which these became loaded."""
    numbers = array.array("d")
    for b in yade.O.bodies:
        for vector in (b.state.pos, b.state.ori, b.state.vel, b.state.angVel, yade.O.forces.f(b.id), yade.O.forces.t(b.id)):
            numbers.extend(vector)
    for i in sorted((i for i in yade.O.interactions if i.isReal), key=lambda i: (i.id1, i.id2)):
        geom, phys = i.geom, i.phys
        numbers.extend((i.id1, i.id2, i.iterMadeReal if born else 0, *phys.normalForce, *phys.shearForce, phys.tangensOfFrictionAngle, *geom.normal,
                        *geom.contactPoint, geom.penetrationDepth, geom.refR1, geom.refR2))
    return hashlib.sha256(numbers).hexdigest()


def goes_on(path, steps, seen=digest):
    """Assert that steps after a save and after a load of the scene end the same, by what seen() returns."""
    yade.O.save(str(path))
    yade.O.run(steps, True)
    whole = seen()
    yade.O.load(str(path))
    yade.O.run(steps, True)
    assert seen() == whole


def everything_in(engine):
    """Settings, results and memory of an engine: .dict(), and attributes that are saved but not shown."""
    return engine.dict() | {name: getattr(engine, name) for name in dir(engine) if re.match("_[a-z]", name)}
