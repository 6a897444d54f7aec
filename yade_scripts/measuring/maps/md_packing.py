"""Map of MD: time step against damping, for a packing."""
import functools
import math
import random

from yade_scripts import parameters
from yade_scripts.measuring.maps import Axis, Map, Outcome, STABLE, UNSTABLE, lines, logarithmic, product
from yade_scripts.measuring.maps.md_contact import LAWS, RATIOS, growing
from yade_scripts.running.sums import total

DISKS, STEPS, EVERY = 100, 2000, 10
PUSH = 1e-5  # over the mean overlap
# Of the full and of the quick map.
RATIO, DAMPING = {True: RATIOS, False: RATIOS[1:2]}, {True: logarithmic(0.01, 0.9, 7), False: [0.01, 0.1, 0.5]}


def searches(full):
    def instability(ratio, beta, laws):
        return lines("md_dt_factor", 0.1, 2.0, 1.005 if full else 1.03, kt_over_kn=ratio, beta_n=beta, tangential_law=laws)

    return instability(RATIO[full], DAMPING[full], LAWS[:1]) + instability(0.5, 0.1, LAWS[1:])


MAP = Map(
    order=1,
    title="Springs: the step for a packing",
    question="How long a time step does a packing under pressure allow, and does the largest eigenvalue of its stiffness predict it?",
    criterion="100 disks at rest under P0 between fixed walls, with sticking contacts, are pushed by 1e-5 of an overlap. Unstable: their "
              "kinetic energy grows tenfold between the second and the last quarter of 2000 steps, or 1e6-fold in all.",
    remedy="A run whose step is above the limit ends as unstable; md_dt_factor up to 0.25 is safe for every beta_n and k_t/k_n.",
    x=Axis("md_dt_factor", r"md_dt_factor $= dt/\sqrt{m_{\min}/k_n}$"), y=Axis("beta_n", r"damping ratio $\beta_n$"), panels="kt_over_kn",
    measures={"growth": "largest kinetic energy of the last quarter over that of the second",
              "theory": "md_dt_factor at which dt^2 K + 2 dt C = 4 M has a solution, of the packing's matrices",
              "bound": "md_dt_factor that is safe for every packing in which no disk is held more stiffly than here"},
    grid=lambda full: product(kt_over_kn=RATIO[full], beta_n=DAMPING[full], md_dt_factor=logarithmic(0.1, 1.6, 13 if full else 7),
                              tangential_law=LAWS[:1]),
    searches=searches, marks={"default": 0.2}, theory_label=r"largest eigenvalue of the packing", theory_along="md_dt_factor")


def probe(case):
    from yade import O, utils
    from cd_engine import watching
    from yade_scripts.running import bodies, hooks, md
    full = parameters.complete({"disks": DISKS, "beta_n": case["beta_n"], "kt_over_kn": case["kt_over_kn"]})
    load(full)
    lightest = min(b.state.mass for b in bodies.disks())
    unit = math.sqrt(lightest / parameters.stiffness(full))
    O.dt = case["md_dt_factor"] * unit
    limits = {name: limit / unit for name, limit in step_limits(case["kt_over_kn"], case["beta_n"]).items()}
    overlaps = [i.phys.normalForce.norm() / i.phys.kn for i in bodies.contacts()]
    speed = PUSH * total(overlaps) / len(overlaps) / unit
    draw = random.Random(1)
    for body in bodies.disks():
        body.state.vel = (draw.uniform(-speed, speed), draw.uniform(-speed, speed), 0)
        body.state.angVel = (0, 0, draw.uniform(-speed, speed) / body.shape.radius)
    energy, start = [], utils.kineticEnergy()
    O.engines = md.contact_engines(full, case["tangential_law"]) + [
        md.integrator(full), hooks.runner(lambda: energy.append(utils.kineticEnergy()), iterPeriod=EVERY)]
    watch, told = watching.Watch(), ""
    try:
        hooks.simulate(STEPS)
        watch.check()
    except watching.Unstable as error:
        told = str(error)
    growth, grows = growing(energy, start)
    measures = {"growth": growth} | limits
    return Outcome(UNSTABLE, "energy growth", told, measures) if grows else Outcome(STABLE, told=told, measures=measures)


@functools.cache
def step_limits(kt_over_kn, beta_n):
    """Return the limits [s] of the packing in O, which is the same for all cases of this stiffness ratio and damping."""
    from cd_engine import springs
    return {"theory": springs.limit(), "bound": springs.safe_bound()}


def load(full):
    """Load the prepared packing, the same for all cases. Give its contacts the stiffness ratio and damping of the case, and let them stick."""
    from yade_scripts.preparing import prepare
    from yade_scripts.running import bodies, md
    prepare.load(parameters.complete({"disks": DISKS}))
    md.set_friction(2.0, 0.0)
    md.set_damping(full["beta_n"])
    for contact in bodies.contacts():
        contact.phys.ks = full["kt_over_kn"] * contact.phys.kn
