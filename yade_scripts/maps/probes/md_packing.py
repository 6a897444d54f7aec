"""A packing of springs at rest under P0 between fixed walls, its contacts sticking, pushed a little."""
import functools
import math
import random

from yade import O, utils

from yade_scripts import bodies, hooks, md, md_step, parameters, prepare, results
from yade_scripts.maps import STABLE, UNSTABLE, Outcome
from yade_scripts.sums import total

DISKS, STEPS, EVERY = 100, 2000, 10
PUSH = 1e-5  # of the mean overlap
GROWN, GROWN_IN_ALL = 10, 1e6  # of the kinetic energy
FOLDER = results.FOLDER  # of prepared packings


def probe(case):
    """See the map of this name."""
    full = parameters.complete({"disks": DISKS, "beta_n": case["beta_n"], "kt_over_kn": case["kt_over_kn"]})
    load(full)
    lightest = min(b.state.mass for b in bodies.disks())
    unit = math.sqrt(lightest / parameters.stiffness(full))
    O.dt = case["md_dt_factor"] * unit
    limits = {name: limit / unit for name, limit in step_limits(case["kt_over_kn"], case["beta_n"]).items()}
    refusal = ""
    try:
        md_step.check(full | {"md_dt_factor": case["md_dt_factor"]})
    except parameters.ParameterError as error:
        refusal = str(error)
    overlaps = [i.phys.normalForce.norm() / i.phys.kn for i in O.interactions if i.isReal]
    speed = PUSH * total(overlaps) / len(overlaps) / unit
    draw = random.Random(1)
    for body in bodies.disks():
        body.state.vel = (draw.uniform(-speed, speed), draw.uniform(-speed, speed), 0)
        body.state.angVel = (0, 0, draw.uniform(-speed, speed) / body.shape.radius)
    energy, start = [], utils.kineticEnergy()
    O.engines = md.contact_engines(full, case["tangential_law"]) + [
        md.integrator(full), hooks.runner(lambda: energy.append(utils.kineticEnergy()), iterPeriod=EVERY)]
    hooks.simulate(STEPS)
    quarter = len(energy) // 4
    late = max(energy[-quarter:])
    growth = late / max(energy[quarter:2 * quarter])
    measures = {"growth": growth} | limits
    # Energies below 1e-12 of the first are round-off; beyond numbers is grown as well.
    if not (max(energy) < GROWN_IN_ALL * start) or (growth > GROWN and late > 1e-12 * start):
        return Outcome(UNSTABLE, "energy growth", refusal, measures)
    return Outcome(STABLE, told=refusal, measures=measures)


@functools.cache
def step_limits(kt_over_kn, beta_n):
    """Limits [s] of the packing in O, which is the same for all cases of this stiffness ratio and damping."""
    return {"theory": md_step.limit(), "bound": md_step.safe_bound()}


def load(full):
    """The one prepared packing of all cases; its contacts get the stiffness ratio and the damping of the case, and stick."""
    path, _ = prepare.ensure(parameters.complete({"disks": DISKS}), FOLDER)
    O.load(str(path))
    md.set_friction(2.0, 0.0)
    for material in O.materials:
        material.betan = full["beta_n"]
    for contact in O.interactions:
        if contact.isReal:
            contact.phys.ks = full["kt_over_kn"] * contact.phys.kn
            contact.phys.cn = full["beta_n"] * contact.phys.cn_crit
