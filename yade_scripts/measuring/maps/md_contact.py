"""Map of MD: time step against damping, for one contact."""
import math

from yade_scripts import parameters
from yade_scripts.measuring.maps import Axis, INACCURATE, Map, STABLE, UNSTABLE, judged, lines, logarithmic, product
from yade_scripts.theory import spring_limits

STEPS = 1000
OVERLAP = 1e-4  # at rest under the pressing force, over the radius: small against all lengths
PUSH = 1e-5     # over the overlap: so small that the contact stays closed while an instability grows
GROWN, GROWN_IN_ALL = 10, 1e6  # growth of the kinetic energy, as a factor, from the second quarter of a run to the last, and from its start
ERROR = 0.1

RATIOS = (0.25, 0.5, 1.0)
LAWS = parameters.REGISTRY["tangential_law"].choices  # the other ones in the searches only
DAMPING = {True: logarithmic(0.01, 0.9, 9), False: [0.01, 0.1, 0.5]}  # of the full and of the quick map


def searches(full):
    """Return the searches for instability, and for an error of a tenth in decay or frequency of the normal motion."""
    def instability(ratio, beta, laws):
        return lines("omega_dt", 0.2 if beta < 0.7 else 0.1, 3.5, 1.003 if full else 1.03, (STABLE, INACCURATE),
                     kt_over_kn=ratio, beta_n=beta, tangential_law=laws)

    found = [line for ratio in (RATIOS if full else RATIOS[1:]) for beta in DAMPING[full] for line in instability(ratio, beta, LAWS[:1])]
    errors = lines("omega_dt", 0.01, 1.5, 1.03, kt_over_kn=0.5, beta_n=DAMPING[full], tangential_law=LAWS[:1])
    return found + instability(0.5, 0.1, LAWS[1:]) + errors


MAP = Map(
    order=0,
    title="Springs: the step for one contact",
    question="How long a time step does a spring with a dashpot allow in YADE's scheme?",
    criterion="A disk pressed on a fixed one, free to move along the normal and to turn, is pushed by 1e-5 of its overlap. Unstable: its "
              "kinetic energy grows tenfold between the second and the last quarter of 1000 steps, or 1e6-fold in all. Inaccurate: decay or "
              "frequency of the normal motion is off by more than a tenth.",
    remedy="The default, md_dt_factor = 0.2, is far below the limit. The decay becomes inaccurate long before, since YADE evaluates dashpots "
           "half a step late.",
    x=Axis("omega_dt", r"$\omega_n\,dt$, $\omega_n=\sqrt{k_n/m}$"), y=Axis("beta_n", r"damping ratio $\beta_n$"), panels="kt_over_kn",
    measures={"growth": "largest kinetic energy of the last quarter over that of the second",
              "decay_error": "of the decay a step of the normal motion, relative",
              "frequency_error": "of its frequency, relative"},
    grid=lambda full: product(kt_over_kn=RATIOS if full else RATIOS[1:], beta_n=DAMPING[full],
                              omega_dt=logarithmic(0.05, 3, 15) if full else logarithmic(0.1, 3, 6), tangential_law=LAWS[:1]),
    searches=searches, theory=lambda at: spring_limits.contact_limit(at["beta_n"], at["kt_over_kn"]),
    theory_label=r"$\min(2\sqrt{1+\beta_n^2}-2\beta_n,\ 2/\sqrt{2k_t/k_n})$", theory_along="omega_dt")


def probe(case):
    from yade import O
    from yade_scripts.running import hooks, md, stage
    full = parameters.complete({"friction": 2.0, "beta_n": case["beta_n"], "kt_over_kn": case["kt_over_kn"]})
    ground, stiffness = stage.Ground(full), parameters.stiffness(full)
    radius, omega = ground.radius, math.sqrt(stiffness / ground.mass)
    O.dt = case["omega_dt"] / omega
    ground.disk((0, 0), blocked="xyzXYZ")
    rest = (2 - OVERLAP) * radius
    disk = ground.disk((0, rest), blocked="xzXY")
    O.forces.setPermF(disk.id, (0, -OVERLAP * radius * stiffness, 0))
    state = disk.state
    speed = PUSH * OVERLAP * radius * omega
    state.vel, state.angVel = (0, speed, 0), (0, 0, speed / radius)

    way, energy = [], []

    def look():
        way.append(state.pos[1] - rest)
        energy.append(state.vel[1]**2 + 0.5 * (radius * state.angVel[2])**2)

    O.engines = md.contact_engines(full, case["tangential_law"]) + [md.integrator(full), hooks.runner(look, iterPeriod=1)]
    hooks.simulate(STEPS)
    growth, grows = growing(energy, speed**2)
    decay, frequency = errors(way, case["omega_dt"], case["beta_n"])
    measures = {"growth": growth, "decay_error": decay, "frequency_error": frequency}
    return judged(measures, "", (UNSTABLE, "energy growth", grows), (INACCURATE, "wrong motion", max(decay, frequency) > ERROR))


def growing(energy, start):
    """Return (the largest of the last quarter of kinetic energies over that of the second, whether they grow) from the energy `start` on.

    Energies below 1e-12 of the first are round-off; an energy that is NaN counts as grown.
    """
    quarter = len(energy) // 4
    late = max(energy[-quarter:])
    growth = late / max(max(energy[quarter:2 * quarter]), 1e-300)
    return growth, any(map(math.isnan, energy)) or max(energy) > GROWN_IN_ALL * start or (growth > GROWN and late > 1e-12 * start)


def errors(way, step, damping):
    """Return the relative errors of decay and frequency per step against exp(-z s) and s sqrt(1 - z^2), s = `step` = omega_n dt, z = `damping`. Only
    the first oscillations count, which are far above round-off."""
    decay, frequency = spring_limits.free_response(way[:max(8, min(len(way), int(6 / (step * max(damping, 0.1)))))])
    return abs(decay / (damping * step) - 1), abs(frequency / (step * math.sqrt(1 - damping**2)) - 1)
