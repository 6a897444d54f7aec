"""Computes how the springs of the packing in O respond to a small load: linear elasticity by a stiffness matrix, without dynamics.

Energy of a contact: k_n (n.D)^2/2 + k_t (t.D)^2/2, where D is the relative displacement at the contact point, rotations included; the second
term counts only with friction. Left out are slip, contacts that close or open, and changes of geometry under the forces present, which are
of the order of overlaps over radii.
"""
import numpy as np
from scipy import sparse
from scipy.sparse import linalg

from cd_engine import springs
from yade_scripts.running import bodies, walls
from yade_scripts.theory.statics import FREE_WALLS

SOFT = 1e-15  # over the stiffest


def strain(stress):
    """Return gamma of the sample when sigma2 rises by `stress` [Pa] at constant sigma1."""
    found = springs.springs()
    free = np.zeros_like(found.bodies.free)
    free[np.ix_(found.bodies.row[[disk.id for disk in bodies.disks()]], (0, 1, 5))] = True
    for wall, axis in FREE_WALLS:
        free[found.bodies.row[wall], axis] = True
    (x_wall, _), (y_wall, _) = FREE_WALLS
    place = [int(np.flatnonzero(np.nonzero(free)[0] == found.bodies.row[wall])[0]) for wall in (x_wall, y_wall)]
    matrix, load = found.stiffness(free), np.zeros(int(free.sum()))
    load[place[1]] = -stress * walls.areas()[1]
    # Disks without contacts are held by springs that are too soft to matter: they change the strain of 60 to 960 disks by less than 1e-9 of it.
    displacement = linalg.spsolve((matrix + SOFT * matrix.max() * sparse.identity(len(load))).tocsc(), load)
    x, y = walls.sides()
    return displacement[place[1]] / y - displacement[place[0]] / x
