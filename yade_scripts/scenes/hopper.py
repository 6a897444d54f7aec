"""A silo with a flat floor runs empty through a slot into a bin below: how many disks leave it in a second?

The disks are deposited without dynamics (running/deposit.py) between two walls; from time 0 the slot in the floor is open. The rate is the
mean between the times at which 15 % and 50 % of the disks have passed, in disks per sqrt(D/g), where D is the width of the slot. In the plane
Beverloo's law gives it as C (D - k d)^(3/2) sqrt(g) over the area of a disk, where d is the mean diameter. C and k depend on friction and packing,
so the rate is compared with runs of rigid contacts and fine steps. Rigid contacts and springs of 2e7 N/m
agree to a few percent (study beverloo); soft springs flow faster.
"""
import math

import numpy as np

from yade_scripts import parameters
from yade_scripts.errors import ParameterError
from yade_scripts.parameter import Parameter
from yade_scripts.scenes import Chart
from yade_scripts.scenes._converged import converged

TITLE = "Discharge of a silo"
KIND = "flow"
HORIZON = "While 15 % to 50 % of the disks pass, and as a mean over seeds; one run is off by the spread."
LEFT_OUT = "the third dimension and air; arches that stop the flow, for which a slot of 10 diameters is too wide"
DEFAULTS = dict(method="CD", disks=500, friction=0.5, radius_spread=0.2, kn=2e7, beta_n=0.9, gravity=9.81, period=1.5, cd_dt=1e-3,
                records_per_cycle=30, tolerance=1e-3, max_iterations=2000)
POSITIVE = ("gravity",)
PARAMETERS = (Parameter("slot", 10.0, "1", "width of the slot over the mean diameter", low=4, high=100),
              Parameter("silo_aspect", 1.5, "1", "height of the filling over its width, about", low=0.5, high=10))
CHART = Chart(physics=("beta_n",), rolling=True)

FIRST, LAST = 0.15, 0.5   # shares of passed disks between which the rate is measured
EVERY = 0.005             # s between two counts of the disks that have passed
# Found with the parameters of SAME. _converged.py explains the form.
CONVERGED = {500: ({"rate": (76.2, 2.7)}, "CD, restitution 0, cd_dt 2.5e-4, tolerance 1e-3, seeds 1 to 8")}
SAME = dict(slot=10.0, silo_aspect=1.5, friction=0.5, radius_spread=0.2)


def check(full):
    """Check that the slot leaves a floor on both sides."""
    slot, widest = full["slot"] * 2 * full["radius_mean"], 0.8 * parameters.width(full, full["silo_aspect"])
    if slot > widest:
        raise ParameterError(f"slot = {full['slot']:g}: the slot of {slot:.3g} m is wider than 0.8 of the silo, {widest:.3g} m; take more "
                             "disks or a smaller slot")


def build(full, folder):
    """Build the filled silo between x = 0 and its width, with its floor at y = 0, above a bin of equal width that holds all disks."""
    from yade import O
    from yade_scripts.running import hooks, stage
    ground = stage.Ground(full)
    radius, span = ground.radius, parameters.width(full, full["silo_aspect"])
    slot, height = full["slot"] * 2 * radius, 2.5 * full["silo_aspect"] * span
    floor = (span - slot) / 4
    for x in (floor, span - floor):
        ground.box((x, -radius), (floor, radius))
    for x in (-radius, span + radius):
        ground.box((x, 0), (radius, height))
    ground.box((span / 2, -height - radius), (span / 2 + 2 * radius, radius))
    ids, times, passed = ground.deposit(span), [], []
    above = list(ids)  # disks that have not passed yet

    def look():
        above[:] = [disk for disk in above if O.bodies[disk].state.pos[1] >= 0]
        times.append(O.time)
        passed.append(1 - len(above) / len(ids))

    def rate():
        if not passed or passed[-1] < LAST:
            return math.nan
        first, last = (np.interp(share, passed, times) for share in (FIRST, LAST))
        return (LAST - FIRST) * len(ids) / (last - first) * math.sqrt(slot / full["gravity"])

    extra = {"rate": ("disks/sqrt(D/g)", "rate at which disks leave, between 15 % and 50 % of them", rate)}
    scene = stage.small(full, converged(full, CONVERGED, SAME, extra), kept={"times": times, "passed": passed, "above": above}, extra=extra)
    O.engines = O.engines + [hooks.runner(look, virtPeriod=EVERY, initRun=True, label=hooks.MEASURING)]
    return scene
