"""Computes how the springs of the packing in O respond to a small load: linear elasticity by a stiffness matrix, without dynamics.

Energy of a contact: k_n (n.D)^2/2 + k_t (t.D)^2/2, where D is the relative displacement at the contact point, rotations included; the second
term counts only with friction. Left out are slip, contacts that close or open, and changes of geometry under the forces present, which are
of the order of overlaps over radii.
"""
import numpy as np
from scipy import sparse
from scipy.sparse import linalg
from yade import O

from yade_scripts.preparing import bodies
from yade_scripts.running import walls

SOFT = 1e-15  # over the stiffest
FREE_WALLS = ((walls.X_HIGH, 0), (walls.Y_HIGH, 1))


def stiffness_matrix():
    """Return K [N/m, N, N m]: rows and columns are x, y, rotation of each disk, then the two free walls."""
    index = {disk.id: 3 * k for k, disk in enumerate(bodies.disks())}
    size = 3 * len(index) + len(FREE_WALLS)
    wall_rows = {wall: (3 * len(index) + k, axis) for k, (wall, axis) in enumerate(FREE_WALLS)}
    contacts = bodies.contacts()
    stretch, stiffness = sparse.lil_matrix((2 * len(contacts), size)), []  # of each contact's two springs by the displacements
    for contact in contacts:
        normal, point = contact.geom.normal, contact.geom.contactPoint
        for direction, spring in (((normal[0], normal[1]), contact.phys.kn),
                                  ((-normal[1], normal[0]), contact.phys.ks if contact.phys.tangensOfFrictionAngle > 0 else 0)):
            row = len(stiffness)
            stiffness.append(spring)
            for body, sign in ((contact.id1, -1), (contact.id2, 1)):
                if body in index:
                    arm, k = point - O.bodies[body].state.pos, index[body]
                    stretch[row, k:k + 3] = sign * direction[0], sign * direction[1], sign * (arm[0] * direction[1] - arm[1] * direction[0])
                elif body in wall_rows:
                    k, axis = wall_rows[body]
                    stretch[row, k] = sign * direction[axis]
    return stretch.T @ sparse.diags(stiffness) @ stretch


def strain(stress):
    """Return gamma of the sample when sigma2 rises by `stress` [Pa] at constant sigma1."""
    matrix = stiffness_matrix()
    load = np.zeros(matrix.shape[0])
    load[-1] = -stress * walls.areas()[1]
    # Disks without contacts are held by springs that are too soft to matter: they change the strain of 60 to 960 disks by less than 1e-9 of it.
    displacement = linalg.spsolve((matrix + SOFT * matrix.max() * sparse.identity(len(load))).tocsc(), load)
    x, y = walls.sides()
    return displacement[-1] / y - displacement[-2] / x
