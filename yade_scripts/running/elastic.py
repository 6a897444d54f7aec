"""Computes how the springs of the packing in O respond to a small load: linear elasticity by a stiffness matrix, without dynamics.

Energy of a contact: k_n (n.D)^2/2 + k_t (t.D)^2/2, where D is the relative displacement at the contact point, rotations included; the second
term counts only with friction. Left out are slip, contacts that close or open, and changes of geometry under the forces present, which are
of the order of overlaps over radii.
"""
import numpy as np
from scipy import sparse
from scipy.sparse import linalg

from yade_scripts.running import bodies, md_step, walls
from yade_scripts.theory.statics import FREE_WALLS

SOFT = 1e-15  # over the stiffest


def strain(stress):
    """Return gamma of the sample when sigma2 rises by `stress` [Pa] at constant sigma1."""
    disks = [disk.id for disk in bodies.disks()]
    column = {body: 3 * k for k, body in enumerate(disks + [wall for wall, _ in FREE_WALLS])}
    free = [*range(3 * len(disks)), *(column[wall] + axis for wall, axis in FREE_WALLS)]  # x, y, rotation of each disk, then the two walls
    matrix, load = md_step.stiffness_matrix(bodies.contacts(), column)[free][:, free], np.zeros(len(free))
    load[-1] = -stress * walls.areas()[1]
    # Disks without contacts are held by springs that are too soft to matter: they change the strain of 60 to 960 disks by less than 1e-9 of it.
    displacement = linalg.spsolve((matrix + SOFT * matrix.max() * sparse.identity(len(load))).tocsc(), load)
    x, y = walls.sides()
    return displacement[-1] / y - displacement[-2] / x
