"""One contact of springs: a disk pressed on a fixed one, free along the normal and in its spin, pushed a little."""
import math

from yade import O

from yade_scripts import bodies, hooks, md, parameters, spring_limits
from yade_scripts.maps import INACCURATE, STABLE, UNSTABLE, Outcome

STEPS = 1000
OVERLAP = 1e-4  # of the radius, under the pressing force: small against all lengths
PUSH = 1e-5     # of the overlap: no contact opens, and what grows has room
GROWN, GROWN_IN_ALL = 10, 1e6  # of the kinetic energy
ERROR = 0.1


def probe(case):
    """See the map of this name."""
    full = parameters.complete({"friction": 2.0, "beta_n": case["beta_n"], "kt_over_kn": case["kt_over_kn"]})
    radius, stiffness = full["radius_mean"], parameters.stiffness(full)
    mass = bodies.disk_mass(radius, full)
    omega = math.sqrt(stiffness / mass)
    O.dt = case["omega_dt"] / omega
    bodies.append_material("disk", full["friction"], full)
    bodies.append_disk((0, 0), radius, mass, "disk", blocked="xyzXYZ")
    rest = (2 - OVERLAP) * radius
    disk = bodies.append_disk((0, rest), radius, mass, "disk", blocked="xzXY")
    O.forces.setPermF(disk, (0, -OVERLAP * radius * stiffness, 0))
    state = O.bodies[disk].state
    speed = PUSH * OVERLAP * radius * omega
    state.vel, state.angVel = (0, speed, 0), (0, 0, speed / radius)

    way, energy = [], []

    def look():
        way.append(state.pos[1] - rest)
        energy.append(state.vel[1]**2 + 0.5 * (radius * state.angVel[2])**2)

    O.engines = md.contact_engines(full, case["tangential_law"]) + [md.integrator(full), hooks.runner(look, iterPeriod=1)]
    hooks.simulate(STEPS)
    quarter = STEPS // 4
    growth = max(energy[-quarter:]) / max(max(energy[quarter:2 * quarter]), 1e-300)
    grown = max(energy) / speed**2
    decay, frequency = errors(way, case["omega_dt"], case["beta_n"])
    measures = {"growth": growth, "decay_error": decay, "frequency_error": frequency}
    # Energies below 1e-12 of the first are round-off.
    if grown > GROWN_IN_ALL or (growth > GROWN and max(energy[-quarter:]) > 1e-12 * speed**2):
        return Outcome(UNSTABLE, "energy growth", measures=measures)
    if max(decay, frequency) > ERROR:
        return Outcome(INACCURATE, "wrong motion", measures=measures)
    return Outcome(STABLE, measures=measures)


def errors(way, step, damping):
    """Relative errors of decay and frequency a step: exp(-z s), s sqrt(1 - z^2). The first swings, far above round-off."""
    decay, frequency = spring_limits.free_response(way[:max(8, min(len(way), int(6 / (step * max(damping, 0.1)))))])
    return abs(decay / (damping * step) - 1), abs(frequency / (step * math.sqrt(1 - damping**2)) - 1)
