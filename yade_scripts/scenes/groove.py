"""A disk in a symmetric V-groove, its walls at t to the horizontal, under a torque just below and just above the critical one.

The forces on the disk are N (n + mu t') at each sliding contact, n = (+-sin t, cos t), t' = n turned by +90 degrees against the spin.
  mu <= tan t  both contacts slide. Balance: N1 (sin t - mu cos t) = N2 (sin t + mu cos t), sum of the vertical parts = m g, hence
               N1 + N2 = m g/((1 + mu^2) cos t), critical torque mu R (N1 + N2) (McNamara, Garcia-Rojo and Herrmann, PRE 72, 021304).
               Above it the disk spins in its place: angular acceleration (torque - critical)/(m R^2/2).
  mu > tan t   and mu tan t < 1: one contact does not slide, the disk rolls over it up the wall; the other opens. Critical torque
               m g R sin t; above it the angular acceleration is (torque - critical)/(3/2 m R^2), for as long as the wall is.
  mu tan t >= 1  the line between the contacts lies within both cones: the disk can wedge itself and hold any torque, and rigid contacts at rest
               stay at rest. The sliding state is a solution, too. Runs of springs that begin with the weight's forces reach it;
               whether springs wedge depends on their history, so nothing is known of them here.
Springs: while both contacts slide, a displacement u of the centre changes N by -k_n n.u and with it mu N t', an unsymmetric stiffness whose
modes are complex. At 45 degrees the disk flutters if beta_n < mu/(2 sqrt(1 + mu^2)). Then it loses contact again and again and spins too slowly,
with mu = 0.3 and beta_n = 0.1 by about 15 % once the flutter has grown; in 0.2 s by 2 % with k_n = 2e6 N/m and by 15 % with 2e8.
"""
import math

from yade_scripts.errors import ParameterError
from yade_scripts.parameter import Parameter
from yade_scripts.scenes import Chart, Known

TITLE = "Disk in a groove under a torque"
KIND = "sliding and rolling"
HORIZON = "Any time: the acceleration is constant. A jammed disk rests because one of the solutions is rest; a disk that already spins need not stop."
LEFT_OUT = "a gradual start of the torque: it acts fully from time 0. The springs then oscillate, the tangential ones without damping"
DEFAULTS = dict(method="CD", friction=0.3, gravity=9.81, slope=45.0, beta_n=0.5, period=0.2, records_per_cycle=10, tolerance=1e-12)
POSITIVE = "gravity", "friction"
PARAMETERS = (Parameter("torque_margin", 0.05, "1", "by how much one disk's torque is below the critical one and the other's above it",
                        low=1e-6, high=0.5),)
CHART = Chart()


def regime(full):
    """Return 'slide', 'roll' or 'jam'."""
    slope = math.tan(math.radians(full["slope"]))
    if full["friction"] * slope >= 1:
        return "jam"
    return "slide" if full["friction"] <= slope else "roll"


def critical(full):
    """Return the critical torque over m g R; for a groove that jams, the torque at which both contacts may slide."""
    t, mu = math.radians(full["slope"]), full["friction"]
    return math.sin(t) if regime(full) == "roll" else mu / ((1 + mu**2) * math.cos(t))


def check(full):
    """Check that the slopes make a groove with a known answer, and that the disk that rolls out does not slip: T/N = tan t (1 + 2/3 margin) <= mu."""
    if not 0 < full["slope"] < 89:
        raise ParameterError(f"slope = {full['slope']}: must be in (0, 89) degrees for a groove")
    if regime(full) == "jam" and full["method"] == "MD":
        raise ParameterError(f"friction = {full['friction']}: must be below 1/tan(slope) for springs, whose history decides whether they jam")
    if regime(full) == "roll" and math.tan(math.radians(full["slope"])) * (1 + full["torque_margin"] * 2 / 3) > full["friction"]:
        raise ParameterError(f"torque_margin = {full['torque_margin']}: too large, the disk would slip as it rolls out")


def build(full, folder):
    """Build the groove of the smaller torque at x = 0 and that of the larger far from it; springs are compressed by the weight from the start."""
    from yade import O
    from yade_scripts.running import stage
    ground = stage.Ground(full)
    t, radius, mass = math.radians(full["slope"]), ground.radius, ground.mass
    torque = critical(full) * mass * full["gravity"] * radius
    inertia = mass * radius**2 * (1.5 if regime(full) == "roll" else 0.5)
    spinning = full["torque_margin"] * torque / inertia
    length = 5 * radius + radius * spinning * ground.time**2

    def turning(x, share):
        """Append a groove at x and its disk under `share` of the critical torque. Return a function for its mean angular acceleration."""
        for side in (-1, 1):
            ground.box((x + side * 2 * radius * math.sin(t), -2 * radius * math.cos(t)), (length, radius), angle=side * t)
        sag = ground.sag(mass * full["gravity"] / (2 * math.cos(t))) / math.cos(t)
        disk = ground.disk((x, -sag))
        O.forces.setPermT(disk.id, (0, 0, share * torque))
        return lambda: disk.state.angVel[2] / O.time

    below, above = turning(0, 1 - full["torque_margin"]), turning(6 * length, 1 + full["torque_margin"])
    return stage.small(full, [
        Known("below", "1/s^2", 0.0, below, scale=spinning, source="balance; scale: the other disk's angular acceleration"),
        Known("above", "1/s^2", 0.0 if regime(full) == "jam" else spinning, above, scale=spinning,
              source="balance with Coulomb's law at sliding contacts, see the file of the scene")])
