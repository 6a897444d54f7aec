"""The state of a scene at one instant: the numbers of a history sample and the arrays of a snapshot."""
import math

import numpy as np

from yade_scripts.running import bodies, walls


def loaded_contacts():
    """Return four arrays of the contacts that carry a force: normal and tangential forces [N], friction coefficient, overlap [m]."""
    rows = [(i.phys.normalForce.norm(), i.phys.shearForce.norm(), i.phys.tangensOfFrictionAngle, i.geom.penetrationDepth)
            for i in bodies.contacts() if i.phys.normalForce.dot(i.geom.normal) > 0]
    return np.array(rows).reshape(-1, 4).T


def stored_energy(loaded=False):
    """Return the elastic energy [J] of the springs of eqs. 5 and 6; loaded: of a scene at rest that has just been loaded, where overlaps are not
    known.

    It is computed from the overlap, since the normal force includes the dashpot. An opening contact still has spring energy when its dashpot pulls
    harder than its spring pushes.
    """
    springs = np.array([(i.phys.kn, depth, i.phys.ks, i.phys.shearForce.norm()) for i in bodies.contacts()
                        if (depth := i.phys.normalForce.norm() / i.phys.kn if loaded else i.geom.penetrationDepth) > 0]).reshape(-1, 4)
    return float(np.sum(springs[:, 0] * springs[:, 1]**2 + springs[:, 3]**2 / springs[:, 2]) / 2)


def _rows(vectors, axes):
    """Return the first `axes` numbers of vectors, as rows."""
    return np.array([tuple(v)[:axes] for v in vectors]).reshape(-1, axes)


def _rotation(state):
    """Return a rotation as a vector: axis times angle."""
    axis, angle = state.ori.toAxisAngle()
    return axis * angle


def snapshot(boxed):
    """Return all arrays of schema.SNAPSHOT, by name; boxed: whether the six walls of the biaxial or triaxial box are there."""
    disks, contacts = bodies.disks(), bodies.contacts_by_id()
    space = walls.in_space()
    axes = 3 if space else 2
    return {
        "position": _rows((b.state.pos for b in disks), axes),
        "angle": (_rows((_rotation(b.state) for b in disks), 3) if space
                  else np.array([2 * math.atan2(b.state.ori[2], b.state.ori[3]) for b in disks])),
        "radius": np.array([b.shape.radius for b in disks]),
        "body_ids": np.array([b.id for b in disks]),
        "contact_ids": np.array([(i.id1, i.id2) for i in contacts], int).reshape(-1, 2),
        "contact_point": _rows((i.geom.contactPoint for i in contacts), axes),
        "contact_normal": _rows((i.geom.normal for i in contacts), axes),
        "contact_friction": np.array([i.phys.tangensOfFrictionAngle for i in contacts]),
        "force_normal": np.array([i.phys.normalForce.dot(i.geom.normal) for i in contacts]),
        "force_tangential": _rows((i.phys.shearForce for i in contacts), 3) if space else np.array([bodies.tangential_force(i) for i in contacts]),
        "box": np.array(walls.faces() if boxed else [math.nan] * 4),
    }
