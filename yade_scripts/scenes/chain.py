"""A row of equal disks touches a wall. From time 0 a constant force pushes the last disk; with few sweeps a step the row oscillates.

Period and decay agree to a few per cent with a damped elastic rod (effective_medium.py), a theory of long waves. The theory leaves out that the
row of N disks and N contacts oscillates as a rod of N + 1/2 diameters (+1 % of the period at 50); that the sweeps of a step have the effect
1 - exp(-x) instead of x = q N_I (k d)^2 (1.6 % of the stiffness at 50 disks and 40 sweeps); and, in the mode `overlap` only, that the forces
near the ends have not spread within a step (over a length of sqrt(q N_I) diameters, 6 of 50).
"""
import math

import numpy as np

from yade_scripts.theory import effective_medium
from yade_scripts.scenes import Known

TITLE = "Row of disks under few sweeps a step, an elastic rod"
KIND = "too few sweeps"
METHODS = ("CD",)
ONLY = "it is about the sweeps of CD, which springs do not make"
HORIZON = "From half a period to a few decay times of the oscillation; then the row is at rest."
LEFT_OUT = "motion across the row"
# 200 steps: more than five periods of the row of 50 disks at 40 sweeps.
DEFAULTS = dict(method="CD", disks=50, radius_spread=0.0, friction=0.0, fixed_iterations=40, solver_seed=1, period=0.2)

SOURCE = "damped elastic rod of effective_medium.py (Unger et al. 2002), a theory of long waves, good to a few per cent"
STRAIN = 1e-5  # of the row at rest under the force, small enough for the linear theory


def build(full, folder):
    """Build `disks` touching disks that can only move along x. /extra holds the displacement of the last one after every step."""
    from yade import O
    from yade_scripts.running import hooks, stage
    ground = stage.Ground(full)
    radius = ground.radius
    ground.box((-radius, 0), (radius, 10 * radius))
    for k in range(full["disks"]):
        last = ground.disk(((2 * k + 1) * radius, 0), blocked="yzXYZ")
    medium = effective_medium.stiffness(full)
    # If every step is solved, the chain has no stiffness to scale the force with: any force serves, since nothing may move.
    force = STRAIN * 2 * radius * (medium if math.isfinite(medium) else full["kn"])
    O.forces.setPermF(last.id, (-force, 0, 0))

    state, start, way = last.state, last.state.pos[0], [0.0]
    scene = stage.small(full, _known(full, way), extra={
        "end_displacement": ("m", "displacement of the last disk after every step, the first at time 0", lambda: np.array(way)),
        "end_at_rest": ("m", "its displacement at rest under the force, if the row is elastic", -STRAIN * 2 * radius * full["disks"])})
    O.engines = O.engines + [hooks.runner(lambda: way.append(state.pos[0] - start), iterPeriod=1, initRun=True)]
    return scene


def _known(full, way):
    """Return the known period and decay, in steps, if the medium is elastic and the run covers two periods; else an empty list."""
    elastic = full["fixed_iterations"] and full["warm_start"] == (full["gap_correction"] == 0) and full["gap_correction"] in (0, 1)
    if not elastic or full["period"] * full["cycles"] < 2 * effective_medium.chain_period(full):
        return []
    guess = [seconds(full) / effective_medium.step(full) for seconds in (effective_medium.chain_period, effective_medium.chain_decay)]
    return [Known("swing_period", "steps", guess[0], lambda: swing(way, *guess)[0], source=SOURCE),
            Known("swing_decay", "steps", guess[1], lambda: swing(way, *guess)[1], source=SOURCE)]


def swing(way, period, decay):
    """Return period and decay time, in steps, of the damped oscillation that best fits the displacement of the end; NaN if the fit fails.

    period, decay: a first guess. The fit leaves out the first half period, in which the overtones of the sudden push decay: the third harmonic
    decays nine times as fast.
    """
    from scipy.optimize import OptimizeWarning, curve_fit
    way = np.asarray(way)
    steps = np.arange(len(way))[math.ceil(period / 2):]
    part = way[steps]

    def damped(t, centre, amplitude, phase, period, decay):
        return centre + amplitude * np.exp(-t / decay) * np.cos(2 * np.pi * t / period + phase)

    try:
        found, _ = curve_fit(damped, steps, part, p0=(part.mean(), np.ptp(part), np.pi, period, decay), x_scale=(
            abs(part.mean()), np.ptp(part), 1, period, decay), method="trf")
    except (RuntimeError, ValueError, OptimizeWarning):
        return math.nan, math.nan
    return float(found[3]), float(found[4])
