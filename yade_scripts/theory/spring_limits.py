"""Computes the longest stable time step of YADE's scheme for springs with dashpots. Needs no YADE.

YADE steps by v' = v + dt f(x, v)/m, x' = x + dt v' (leapfrog); its dashpots use the velocity v of half a step before. For a linear system with
the matrices M, C and K,

    x(n+1) - 2 x(n) + x(n-1) = -dt M^-1 C (x(n) - x(n-1)) - dt^2 M^-1 K x(n).

In a step a mode of frequency w and damping ratio z changes by the roots r of r^2 - (2 - 2 z s - s^2) r + (1 - 2 z s) = 0,
s = w dt. Both lie within the unit circle while 4 - 4 z s - s^2 > 0 (Jury's criterion; the first to leave it does so at r = -1), so

    s < 2 (sqrt(1 + z^2) - z).

Without damping this is the limit 2 of central differences; damping lowers it. For all modes at once: dt^2 K + 2 dt C < 4 M.
"""
import math

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import eigsh


def oscillator_limit(damping):
    """Return the largest stable w dt of one mode of this damping ratio."""
    return 2 * (math.sqrt(1 + damping**2) - damping)


def contact_limit(damping, kt_over_kn):
    """Return the largest stable w_n dt, w_n = sqrt(k_n/m), of a disk that moves along the normal of one contact and turns.

    The spin has no dashpot and w^2 = k_t R^2/I = 2 (k_t/k_n) w_n^2 for I = m R^2/2.
    """
    return min(oscillator_limit(damping), 2 / math.sqrt(2 * kt_over_kn))


def largest_eigenvalue(mass, matrix):
    """Return the largest eigenvalue of `matrix` (symmetric, SciPy sparse) with respect to the diagonal `mass`."""
    scaled = _scaled(mass, matrix)
    if scaled.shape[0] < 20:
        return float(np.linalg.eigvalsh(scaled.toarray())[-1])
    # A fixed start vector, since a random one would give other last bits in every run.
    return float(eigsh(scaled, k=1, which="LA", v0=np.ones(len(mass)), tol=1e-8, return_eigenvectors=False)[0])


def most_moved(mass, matrix):
    """Return the coordinate that has most of the kinetic energy of the mode of the largest eigenvalue."""
    scaled = _scaled(mass, matrix)
    mode = np.linalg.eigh(scaled.toarray())[1] if scaled.shape[0] < 20 else eigsh(scaled, k=1, which="LA", v0=np.ones(len(mass)), tol=1e-8)[1]
    return int(np.argmax(np.abs(mode[:, -1])))


def _scaled(mass, matrix):
    scale = sparse.diags(1 / np.sqrt(mass))
    return (scale @ matrix @ scale).tocsr()


def matrix_limit(mass, damping, stiffness):
    """Return the smallest dt [s] at which dt^2 K + 2 dt C has the eigenvalue 4 with respect to M; `mass` is the diagonal of M."""
    low, high = 0.0, 2 / math.sqrt(largest_eigenvalue(mass, stiffness))
    while high - low > 1e-4 * high:
        dt = (low + high) / 2
        low, high = (dt, high) if largest_eigenvalue(mass, dt**2 * stiffness + 2 * dt * damping) < 4 else (low, dt)
    return (low + high) / 2


def free_response(values):
    """Return (decay, frequency) a step of the mode in a series x(n), from the roots of the recurrence x(n+1) = a x(n) + b x(n-1) fitted to it.

    The frequency is 0 if the roots are real: then there is no oscillation.
    """
    values = np.asarray(values)
    (a, b), *_ = np.linalg.lstsq(np.stack([values[1:-1], values[:-2]], axis=1), values[2:], rcond=None)
    root = max(np.roots([1, -a, -b]), key=abs)
    return -math.log(abs(root)), abs(np.angle(root)) if abs(root.imag) > 0 else 0.0
