"""Appends disks, finds them, and counts their contacts."""
import math

from yade import O, utils
from yade.wrapper import FrictViscoMat, Sphere

from yade_scripts.running import walls
from yade_scripts.running.sums import total


def append_material(label, mu, full):
    """Add a material with friction coefficient mu, for springs with dashpots and for rigid contacts."""
    O.materials.append(FrictViscoMat(frictionAngle=math.atan(mu), betan=full["beta_n"], density=full["density"], label=label))


def disk_mass(radius, full):
    """Return rho pi R^2 depth [kg]."""
    return full["density"] * math.pi * radius**2 * full["depth"]


def append_sphere(position, radius, material, velocity=(0, 0, 0)):
    """Append a sphere at (x, y, z) [m], of the density of its material, free in space. Return its id."""
    body = utils.sphere(position, radius, material=material, color=(0.7, 0.7, 0.6))
    body.state.vel = velocity
    return O.bodies.append(body)


def append_disk(position, radius, mass, material, velocity=(0, 0), blocked="zXY"):
    """Append a disk at (x, y) [m] of `mass` [kg] and inertia m R^2/2, free in the plane unless `blocked` is set. Return its id."""
    body = utils.sphere((*position, 0), radius, material=material, color=(0.7, 0.7, 0.6))  # YADE's default colour is random
    body.state.mass = mass
    body.state.inertia = (mass * radius**2 / 2,) * 3
    body.state.blockedDOFs = blocked
    body.state.vel = (*velocity, 0)
    return O.bodies.append(body)


def disks():
    """Return the bodies that are disks or spheres, in the order of their ids."""
    return [b for b in O.bodies if isinstance(b.shape, Sphere)]


def mean_mass():
    """Return the mean mass of the disks [kg]."""
    masses = [b.state.mass for b in disks()]
    return total(masses) / len(masses)


def centre_of_mass(ids):
    """Return the centre of mass (x, y) [m] of the bodies `ids`."""
    states = [O.bodies[k].state for k in ids]
    mass = total(state.mass for state in states)
    return tuple(total(state.mass * state.pos[axis] for state in states) / mass for axis in (0, 1))


def solid_fraction():
    """Return the area of the disks over the area of the box, or the volume of spheres over its volume."""
    size = (lambda radius: 4 / 3 * math.pi * radius**3) if walls.in_space() else (lambda radius: math.pi * radius**2)
    return total(size(b.shape.radius) for b in disks()) / math.prod(walls.sides())


def contacts_per_disk():
    """Return the mean number of loaded contacts of the disks that are not rattlers."""
    counts = [n for n in map(loaded_contacts, disks()) if n]
    return sum(counts) / len(counts)


def contacts():
    """Return the contacts that there are, in the order in which YADE has them."""
    return [i for i in O.interactions if i.isReal]


def contacts_by_id():
    """Return the contacts in the order of their bodies' ids."""
    return sorted(contacts(), key=lambda i: (i.id1, i.id2))


def tangential_force(contact):
    """Return the tangential force [N] on the second body, along the normal turned by +90 degrees: (n_x, n_y) -> (-n_y, n_x)."""
    n, shear = contact.geom.normal, contact.phys.shearForce
    return n[0] * shear[1] - n[1] * shear[0]


def normal_force(one, other):
    """Return the size of the normal force between two bodies [N], 0 without contact."""
    return O.interactions[one, other].phys.normalForce.norm() if O.interactions.has(one, other, onlyReal=True) else 0.0


def loaded_contacts(body):
    """Return the number of contacts of a body that carry a force."""
    return sum(1 for i in body.intrs() if i.isReal and i.phys.normalForce.squaredNorm() > 0)
