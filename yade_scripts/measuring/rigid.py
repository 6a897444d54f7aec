"""What the probes of Contact Dynamics share inside YADE: columns of disks, the engine, and its report of a run."""
from yade import O

import cd_engine
from cd_engine.step_texts import DEEP
from yade_scripts import parameters
from yade_scripts.measuring.maps import INACCURATE, NOT_SOLVED, UNSTABLE, judged
from yade_scripts.running import bodies, stage

DEFAULTS = parameters.complete({})
RADIUS = DEFAULTS["radius_mean"]  # [m]
MASS = bodies.disk_mass(RADIUS, DEFAULTS)  # [kg]
GRAVITY = 9.81  # [m/s^2]
COLUMN_STEP = 1e-3  # [s]
FORCE_ERROR = 0.01  # largest error of a contact force, over the weight above the contact


def ground(mu):
    """Return where disks of RADIUS and boxes of this friction are placed."""
    return stage.Ground(DEFAULTS | {"friction": mu})


def engine(dt, gravity=(0, -GRAVITY, 0), **settings):
    """Set the engines and the step. Return the ContactDynamics engine."""
    O.engines = cd_engine.engines(gravity=gravity, **settings)
    O.dt = dt
    return O.engines[-1]


def told(contact_dynamics, smallest=RADIUS):
    """Return in words what the engine reports as wrong, '' if nothing; smallest: smallest radius [m]."""
    said = []
    if contact_dynamics.unconvergedSteps:
        said.append(f"{contact_dynamics.unconvergedSteps} unconverged steps ({contact_dynamics.status})")
    elif not contact_dynamics.converged:  # possible with fixedIterations
        said.append(f"converged is False (e = {contact_dynamics.residual:.0e})")
    if contact_dynamics.deepestPenetration > DEEP * smallest:
        said.append("warning of overlap")
    return ", ".join(said)


def column(masses, steps, **settings):
    """Return the Outcome of `steps` steps of equally large disks on the floor, one above the other; masses: from below, over MASS."""
    place = ground(0.5)
    ids = [place.floor(1000 * RADIUS)] + [place.disk((0, (2 * k + 1) * RADIUS), mass=mass * MASS).id for k, mass in enumerate(masses)]
    found = engine(COLUMN_STEP, **settings)
    O.run(steps, True)
    error = max(abs(bodies.normal_force(*pair) / (sum(masses[k:]) * (GRAVITY * MASS)) - 1) for k, pair in enumerate(zip(ids, ids[1:])))
    measures = {"force_error": error, "penetration": found.deepestPenetration / RADIUS, "unconverged": found.unconvergedSteps / steps,
                "residual": found.residual}
    return judged(measures, told(found), (NOT_SOLVED, "non-convergence", found.unconvergedSteps),
                  (UNSTABLE, "penetration", measures["penetration"] > DEEP), (INACCURATE, "wrong forces", error > FORCE_ERROR))
