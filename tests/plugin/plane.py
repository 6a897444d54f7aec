"""Bodies of a plane scene, as the tests build them: SI units, disks of depth 1 m."""
import array
import hashlib
import math
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


def disk_on_a_floor(**settings):
    """Append a floor (#0) and a disk at rest on it (#1). Return the engines, with gravity."""
    disk((0, 0.01), 0.01, mat=ground())
    return cd_engine.engines(gravity=(0, -9.81, 0), **settings)


def run(steps, dt, **settings):
    """Set the engines and make the steps. Return the ContactDynamics engine."""
    yade.O.engines = cd_engine.engines(**settings)
    yade.O.dt = dt
    yade.O.run(steps, True)
    return yade.O.engines[-1]


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


def everything_in(engine):
    """Settings, results and memory of an engine: .dict(), and attributes that are saved but not shown."""
    return engine.dict() | {name: getattr(engine, name) for name in dir(engine) if re.match("_[a-z]", name)}
