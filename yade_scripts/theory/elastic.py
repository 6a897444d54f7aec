"""Computes how the springs of the packing in O respond to a small load: linear elasticity by a stiffness matrix, without dynamics.

Energy of a contact: k_n (n.D)^2/2 + k_t (t.D)^2/2, where D is the relative displacement at the contact point, rotations included; the second
term counts only with friction. Left out are slip, contacts that close or open, and changes of geometry under the forces present, which are
of the order of overlaps over radii.
"""
import numpy as np
from yade import O

from yade_scripts.preparing import bodies
from yade_scripts.running import walls

FREE_WALLS = ((walls.X_HIGH, 0), (walls.Y_HIGH, 1))


def stiffness_matrix():
    """Return (K [N/m, N, N m], index): rows and columns are x, y, rotation of each disk, then the two free walls; index: body -> first row."""
    index = {disk.id: 3 * k for k, disk in enumerate(bodies.disks())}
    size = 3 * len(index) + len(FREE_WALLS)
    wall_rows = {wall: (3 * len(index) + k, axis) for k, (wall, axis) in enumerate(FREE_WALLS)}
    matrix = np.zeros((size, size))
    for contact in bodies.contacts():
        normal, point = contact.geom.normal, contact.geom.contactPoint
        for direction, stiffness in (((normal[0], normal[1]), contact.phys.kn),
                                     ((-normal[1], normal[0]), contact.phys.ks if contact.phys.tangensOfFrictionAngle > 0 else 0)):
            row = np.zeros(size)
            for body, sign in ((contact.id1, -1), (contact.id2, 1)):
                if body in index:
                    arm, k = point - O.bodies[body].state.pos, index[body]
                    row[k:k + 3] = sign * direction[0], sign * direction[1], sign * (arm[0] * direction[1] - arm[1] * direction[0])
                elif body in wall_rows:
                    k, axis = wall_rows[body]
                    row[k] = sign * direction[axis]
            matrix += stiffness * np.outer(row, row)
    return matrix, index


def strain(stress):
    """Return gamma of the sample when sigma2 rises by `stress` [Pa] at constant sigma1. Disks without contacts do not matter."""
    matrix, _ = stiffness_matrix()
    load = np.zeros(len(matrix))
    load[-1] = -stress * walls.areas()[1]
    displacement, *_ = np.linalg.lstsq(matrix, load, rcond=1e-10)
    x, y = walls.sides()
    return displacement[-1] / y - displacement[-2] / x
