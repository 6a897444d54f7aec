"""Stiffness, damping and motion of the elastic medium that rigid contacts form under too few Gauss-Seidel sweeps a step. Needs no YADE.

In N_I sweeps a force spreads by diffusion (D = q d^2 a sweep), over a length that is shorter than the sample. For motion that varies slowly over
this length they change the impulse of a contact in a step by only -q m N_I u_n (Unger, Brendel, Wolf and Kertesz, Phys. Rev. E 65, 061305 (2002);
Unger and Kertesz, cond-mat/0211696). With two kinds of settings this acts as a spring kappa = q m N_I/dt^2 with a dashpot q m N_I/dt:

  memory   warm start, gap_correction 0: impulses add up from step to step, as the force of a spring does from its rate
  overlap  cold start, gap_correction 1: the impulse of each step, -q m N_I (u_n + gap/dt), depends on the overlap itself

Cold start without the correction is a dashpot without spring: it creeps. Warm start with the correction also adds up gap/dt, a force from the time
integral of the overlap; by Routh's criterion it is unstable where (omega dt)^2 < g/(1 + g), g = gap_correction.
"""
import math

import numpy as np

from yade_scripts import parameters

# q for sweeps in random order, each contact once (Unger et al. 2002). It would be 1/2 if all contacts used the forces of the sweep before.
RELAXATION = (4 * math.sqrt(math.e) - 5) / 2


def step(full):
    """Return O.dt [s] of a CD row."""
    return parameters.steps(full, full["cd_dt"])[1]


def mean_mass(full):
    """Return the expected mass of a disk [kg], its radius uniform within radius_mean (1 +- radius_spread)."""
    return full["density"] * math.pi * full["radius_mean"]**2 * (1 + full["radius_spread"]**2 / 3) * full["depth"]


def stiffness(full):
    """Return kappa = q m N_I/dt^2 [N/m] of a CD row with fixed_iterations N_I; infinite if every step is solved to a tolerance."""
    if not full["fixed_iterations"]:
        return math.inf
    return RELAXATION * mean_mass(full) * full["fixed_iterations"] / step(full)**2


def dashpot(full):
    """Return q m N_I/dt [N s/m], the constant of the dashpot beside that spring."""
    return stiffness(full) * step(full)


def chain_period(full):
    """Return the period [s] of the slowest oscillation of a chain of `disks` from a wall to a free end: 4 L/c, c = sqrt(q N_I) d/dt, L = disks d."""
    return 4 * full["disks"] * math.sqrt(mean_mass(full) / stiffness(full))


def chain_decay(full):
    """Return the time [s] in which the amplitude of that oscillation falls to 1/e: 2/(D' k^2), D' = q N_I d^2/dt, k = pi/(2 L)."""
    return 2 * mean_mass(full) / dashpot(full) / (math.pi / (2 * full["disks"]))**2


def chain_response(full, time):
    """Return the displacement of the free end at `time` [s] over its final value, for a constant push from time 0 on a Kelvin-Voigt rod.

    1 - sum over odd n of 8/(pi n)^2 exp(-b t) [cos(w t) + b/w sin(w t)], b = n^2/chain_decay, w^2 = (2 pi n/chain_period)^2 - b^2, with as
    many terms as disks; those of high n decay without oscillation. The terms left out amount to 0.4 % at time 0 and soon to nothing.
    """
    n = np.arange(1, 2 * full["disks"], 2)[:, None]
    rate = n**2 / chain_decay(full)
    swing = np.sqrt((2 * np.pi * n / chain_period(full))**2 - rate**2 + 0j)
    t = np.asarray(time, float)[None, :]
    # exp(-bt) [cos + b/w sin] by its two exponentials, which do not overflow where w is imaginary.
    modes = ((swing - 1j * rate) * np.exp((1j * swing - rate) * t) + (swing + 1j * rate) * np.exp((-1j * swing - rate) * t)) / (2 * swing)
    return 1 - np.sum(8 / (np.pi * n)**2 * modes, axis=0).real
