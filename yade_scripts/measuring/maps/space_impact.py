"""Map of CD in space: time step against the angle of an oblique impact with friction."""
import math

from yade_scripts.measuring.maps import Axis, INACCURATE, Map, UNSTABLE, judged, lines, logarithmic, product

SPEED, RADIUS = 3.9, 2.5e-3  # [m/s], [m]
STEPS, FLIGHT, INSTANTS = 20, 5, 8  # steps, steps before the impact, instants of a step at which the sphere may arrive
OFF, GAIN = 0.02, 1e-9
ANGLES = {True: [35.0, 42.0, 50.0, 58.0, 66.0, 74.0, 80.0, 85.0], False: [35.0, 50.0, 70.0, 85.0]}  # from the normal
RESTITUTIONS = {True: [0.0, 0.5, 0.98], False: [0.5, 0.98]}


def arm(at):
    """Return the step at which the arm of friction is too long by the share OFF: up to half the displacement along the normal in a step."""
    return 2 * OFF / math.cos(math.radians(at["impact_angle"])) if at["restitution"] else math.nan


MAP = Map(
    order=21,
    title="Spheres in space: the step of an oblique impact",
    question="How far may a sphere move in a step so that it leaves a wall with the right spin?",
    criterion="A sphere hits a floor at an angle from its normal and slides throughout (mu = 0.092, scene oblique_impact, no gravity), "
              "at 8 instants of a step. Unstable: its kinetic energy grows by more than 1e-9 of the first. Inaccurate: spin or "
              "tangential restitution is off by more than 2 % in one of the eight.",
    remedy="With restitution a sphere rebounds up to half its displacement in a step above the floor, where friction has a longer arm: its "
           "spin is too large by up to half this displacement over the radius, without a restitution by a quarter. Nothing warns. Energy "
           "never grew.",
    x=Axis("share", r"$v\,dt/R$"), y=Axis("impact_angle", "angle from the normal [degree]"), panels="restitution",
    measures={"spin_error": "largest error of the spin, relative to its exact value", "mean_spin_error": "the same, mean of the eight",
              "tangential_error": "largest error of the tangential restitution", "energy_gain": "largest kinetic energy over the first, less 1"},
    grid=lambda full: product(restitution=RESTITUTIONS[full], impact_angle=ANGLES[full], share=logarithmic(0.005, 1, 10 if full else 4)),
    searches=lambda full: lines("share", 0.002, 2.0, 1.02 if full else 1.1, restitution=RESTITUTIONS[full], impact_angle=ANGLES[full]),
    theory=arm, theory_label="arm too long by 2 %", theory_along="share")


def probe(case):
    from yade_scripts.measuring import space_cases
    spins, tangential, gains, said = [], [], [], []
    for instant in range(1, INSTANTS + 1):
        run = space_cases.Case("oblique_impact", STEPS, case["share"] * RADIUS / SPEED, radius_mean=RADIUS, speed=SPEED,
                               impact_angle=case["impact_angle"], restitution=case["restitution"])
        state, first = run.sphere.state, run.energy()
        state.pos = (0, RADIUS - (FLIGHT + instant / INSTANTS - 1e-6) * run.dt * state.vel[1], 0)  # just before, whatever round-off does
        run.run()
        spins.append(run.error("spin"))
        tangential.append(run.error("tangential_restitution"))
        gains.append(run.energy() / first - 1)
        said.append(run.told)
    measures = {"spin_error": max(spins), "mean_spin_error": sum(spins) / INSTANTS, "tangential_error": max(tangential), "energy_gain": max(gains)}
    return judged(measures, next(filter(None, said), ""), (UNSTABLE, "energy growth", max(gains) > GAIN),
                  (INACCURATE, "wrong motion", max(spins + tangential) > OFF))
