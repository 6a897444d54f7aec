"""What the probes of Contact Dynamics share: disks of the default radius, boxes, and what the engine itself says of a run."""
from yade import O, utils

import cd_engine
from yade_scripts import bodies, parameters

DEFAULTS = parameters.complete({})
RADIUS = DEFAULTS["radius_mean"]  # [m]
MASS = bodies.disk_mass(RADIUS, DEFAULTS)  # [kg]
GRAVITY = 9.81  # [m/s^2]
DEEP = 0.01  # of the smallest radius: an overlap of which the engine warns


def material(mu):
    """The material of all bodies that follow."""
    bodies.append_material("disk", mu, DEFAULTS)


def disk(position, mass=MASS, velocity=(0, 0), blocked="zXY"):
    """Append a disk of RADIUS; its id."""
    return bodies.append_disk(position, RADIUS, mass, "disk", velocity, blocked)


def box(centre, half, **more):
    """Append a fixed box; its id."""
    return O.bodies.append(utils.box((*centre, 0), (*half, DEFAULTS["depth"] / 2), fixed=True, material="disk", **more))


def floor():
    """A floor whose upper side is y = 0."""
    return box((0, -RADIUS), (1000 * RADIUS, RADIUS))


def engine(dt, gravity=(0, -GRAVITY, 0), **settings):
    """Set the engines and the step; the ContactDynamics engine."""
    O.engines = cd_engine.engines(gravity=gravity, **settings)
    O.dt = dt
    return O.engines[-1]


def told(contact_dynamics, smallest=RADIUS):
    """How the engine said that something is wrong, '' if it did not; smallest: radius [m]."""
    said = []
    if contact_dynamics.unconvergedSteps:
        said.append(f"{contact_dynamics.unconvergedSteps} unconverged steps ({contact_dynamics.status})")
    elif not contact_dynamics.converged:  # fixedIterations
        said.append(f"converged is False (e = {contact_dynamics.residual:.0e})")
    if contact_dynamics.deepestPenetration > DEEP * smallest:
        said.append("warning of overlap")
    return ", ".join(said)


def normal_force(one, other):
    """[N] between two bodies, 0 without contact."""
    if not O.interactions.has(one, other):
        return 0.0
    contact = O.interactions[one, other]
    return contact.phys.normalForce.norm() if contact.isReal else 0.0
