"""Reads what a picture shows from the scene of a running YADE, as plain arrays."""
import math
from dataclasses import dataclass, field

import numpy as np

from .. import engine_methods
from . import space

AXES = "xyz"
# The two axes of the picture, left to right and upwards, by the axis that points out of the plane.
PLANES = {2: (0, 1), 1: (0, 2), 0: (1, 2)}
FLAT = 1e-3  # distance from the common plane, in radii, up to which disks count as lying in it


@dataclass
class Scene:
    """A scene at one instant. Two coordinates: those of the axes named in `names`, in space to the right and upwards as one looks at it.

    position [m], radius [m], angle [rad], velocity [m/s], spin [rad/s], force [N]: of each disk; force is the sum of the sizes of the normal forces
    on it. ids: their bodies' ids. fixed: mask of the disks that no force moves (boundaries). links [m], link_force [N]: both ends of each loaded
    contact, which are the centre of a disk or the point of contact at a boundary, and the size of its normal force. boxes [m]: four corners each.
    walls: (axis of the picture, place [m]) each. time [s]. Of a scene in space: depth [m] of each sphere, towards the viewer, and turned: the
    direction of its own x axis as the picture's x, y and depth; boxes are then the faces of all boundaries, and velocities have three components.
    """
    names: tuple
    time: float
    ids: np.ndarray
    position: np.ndarray
    radius: np.ndarray
    angle: np.ndarray
    velocity: np.ndarray
    spin: np.ndarray
    fixed: np.ndarray
    force: np.ndarray = None
    links: np.ndarray = None
    link_force: np.ndarray = None
    boxes: list = field(default_factory=list)
    walls: list = field(default_factory=list)
    depth: np.ndarray = None
    turned: np.ndarray = None


class NoDisk(ValueError):
    """There is nothing to draw."""


def read(look=None):
    """Return the Scene that YADE holds, seen along `look` if that is given or if the spheres do not lie in a plane. Raise NoDisk if it has none,
    RuntimeError during a run."""
    from yade import O, Vector3
    if engine_methods.runs_besides():
        raise RuntimeError("picture: a run goes on and changes the scene meanwhile. Call O.pause() first, or put cd_engine.film(...) into O.engines")
    spheres = [body for body in O.bodies if type(body.shape).__name__ == "Sphere"]
    if not spheres:
        raise NoDisk("picture: there is no disk in the scene. Append the disks first")
    states = [body.state for body in spheres]
    place, velocity, spin = (np.array([[*getattr(state, name)] for state in states]) for name in ("pos", "vel", "angVel"))
    radius = np.array([body.shape.radius for body in spheres])
    blocked = [(state if body.clumpId < 0 else O.bodies[body.clumpId].state).blockedDOFs for body, state in zip(spheres, states)]
    fixed, ids = np.array([text == "xyzXYZ" for text in blocked]), np.array([body.id for body in spheres])
    normal = None if look else _normal(place, radius, blocked)
    if normal is None:
        axes = space.axes(look or space.LOOK, space.upwards(O))
        turned = np.array([[*(state.ori * Vector3.UnitX)] for state in states]) @ axes.T
        scene = Scene(("right", "up"), O.time, ids, (place @ axes.T)[:, :2], radius, None, velocity, spin @ axes[2], fixed,
                      boxes=[face @ axes.T[:, :2] for face in space.faces(O, place, radius)], depth=place @ axes[2], turned=turned)
        _read_contacts(O, scene, lambda points: points @ axes.T[:, :2])
        return scene
    plane = PLANES[normal]
    turns = -1 if normal == 1 else 1  # from x to z is a negative turn about y
    angle = 2 * np.array([math.atan2(state.ori[normal], state.ori[3]) for state in states])
    scene = Scene(tuple(AXES[axis] for axis in plane), O.time, ids, place[:, plane], radius, turns * angle, velocity[:, plane],
                  turns * spin[:, normal], fixed)
    level = np.median(place[:, normal])
    for body in O.bodies:
        kind = type(body.shape).__name__
        if kind == "Wall" and body.shape.axis in plane:
            scene.walls.append((plane.index(body.shape.axis), body.state.pos[body.shape.axis]))
        elif kind == "Box" and (corners := _section(body, normal, level)) is not None:
            scene.boxes.append(corners[:, plane])
    contacts, disks = _read_contacts(O, scene, lambda points: points[:, plane])
    if O.periodic:
        _fold(O, scene, contacts, disks, plane)
    return scene


def _normal(place, radius, blocked):
    """Return the axis that points out of the plane of the disks: one along which no disk can move if there is one, else one along which all lie
    level. None: there is none."""
    extent, flat = np.ptp(place, axis=0), FLAT * radius.min()
    free = [text for text in blocked if "xyz" not in text]
    held = [axis for axis in (2, 1, 0) if free and all(AXES[axis] in text for text in free)]
    axes = [axis for axis in held or (2, 1, 0) if extent[axis] <= flat]
    if not axes:
        return None
    # The rotation of a disk in its plane is about the normal; 'xzXY' leaves a motion along y and this rotation.
    turning = [axis for axis in axes if free and not any(AXES[axis].upper() in text for text in free)]
    return (turning or axes)[0]


def _section(body, normal, level):
    """Return the four corners of a box where it cuts the plane, each with three coordinates [m]; None if it lies beside the plane."""
    from yade import Vector3
    centre, half = np.array([*body.state.pos]), body.shape.extents
    sides = np.array([[*(body.state.ori * Vector3(*(half[k] * (k == axis) for k in range(3))))] for axis in range(3)])
    across = max(range(3), key=lambda k: abs(sides[k][normal]) / half[k] if half[k] else -1)
    if abs(centre[normal] - level) > abs(sides[:, normal]).sum() * (1 + FLAT):
        return None
    one, other = (sides[k] for k in range(3) if k != across)
    return np.array([centre + one + other, centre - one + other, centre - one - other, centre + one - other])


def _read_contacts(O, scene, project):
    """Add the loaded contacts to a scene, and to each disk its force. project: what makes places of the picture of those in space. Return the
    contacts and the indices of their disks, -1 for a boundary."""
    index = np.full(len(O.bodies), -1)  # of the disk, by body
    index[scene.ids] = np.arange(len(scene.ids))
    contacts = [contact for contact in O.interactions if contact.isReal and hasattr(contact.phys, "normalForce")]
    force = np.array([contact.phys.normalForce.norm() for contact in contacts])
    loaded = np.flatnonzero(force > 0)
    contacts, scene.link_force = [contacts[k] for k in loaded], force[loaded]
    disks = index[np.array([(contact.id1, contact.id2) for contact in contacts], int).reshape(-1, 2)]
    points = np.array([[*contact.geom.contactPoint] for contact in contacts]).reshape(-1, 3)
    scene.links = np.where((disks >= 0)[:, :, None], scene.position[disks], project(points)[:, None])
    scene.force = np.bincount(disks[disks >= 0], np.repeat(scene.link_force, 2).reshape(-1, 2)[disks >= 0], len(scene.ids))
    return contacts, disks


def _fold(O, scene, contacts, disks, plane):
    """Bring the disks of a periodic scene into its cell; a contact across the border starts at its first disk and leaves the cell."""
    cell = np.array([[O.cell.hSize[row, column] for column in range(3)] for row in range(3)])
    middle = cell.sum(axis=1) / 2  # stands for the coordinate out of the plane, which scene.position lacks
    place = np.tile(middle, (len(scene.ids), 1))
    place[:, plane] = scene.position
    shift = (-np.floor(np.linalg.solve(cell, place.T)).T @ cell.T)[:, plane]
    images = np.array([[*contact.cellDist] for contact in contacts]).reshape(-1, 3)
    scene.links[:, 1] += (images @ cell.T)[:, plane]
    scene.links += np.where((disks[:, :1] >= 0)[:, :, None], shift[disks[:, :1]], 0)
    scene.position = scene.position + shift
