"""The longest stable time step of one contact in YADE's scheme, and its free response. Needs no YADE.

In a step a mode of frequency w and damping ratio z changes by the roots r of r^2 - (2 - 2 z s - s^2) r + (1 - 2 z s) = 0, s = w dt, which lie within
the unit circle while 4 - 4 z s - s^2 > 0. cd_engine/springs.py derives it, for many contacts at once.
"""
import math

import numpy as np


def oscillator_limit(damping):
    """Return the largest stable w dt of one mode of this damping ratio."""
    return 2 * (math.sqrt(1 + damping**2) - damping)


def contact_limit(damping, kt_over_kn):
    """Return the largest stable w_n dt, w_n = sqrt(k_n/m), of a disk that moves along the normal of one contact and turns.

    The spin has no dashpot and w^2 = k_t R^2/I = 2 (k_t/k_n) w_n^2 for I = m R^2/2.
    """
    return min(oscillator_limit(damping), 2 / math.sqrt(2 * kt_over_kn))


def free_response(values):
    """Return (decay, frequency) a step of the mode in a series x(n), from the roots of the recurrence x(n+1) = a x(n) + b x(n-1) fitted to it.

    The frequency is 0 if the roots are real: then there is no oscillation.
    """
    values = np.asarray(values)
    (a, b), *_ = np.linalg.lstsq(np.stack([values[1:-1], values[:-2]], axis=1), values[2:], rcond=None)
    root = max(np.roots([1, -a, -b]), key=abs)
    return -math.log(abs(root)), abs(np.angle(root)) if abs(root.imag) > 0 else 0.0
