"""Three equal disks make an arch on a rough floor: one arch is just steep enough to stand, one just too flat.

The key, the upper disk, rests on two side disks that stand on the floor and do not touch each other. The line from a side disk to the key
rises at phi. Forces on the right side disk: N and T from the key, F and the reaction to the weights from the floor. Zero torque requires F = T,
zero horizontal force N cos phi - T sin phi = F. So T/N = cos phi/(1 + sin phi) = tan(45 degrees - phi/2), and the arch stands if
    mu >= mu_c = tan(45 degrees - phi/2),   phi(mu_c) = 90 degrees - 2 atan mu_c.
All forces are determined (N sin phi + T cos phi = m g/2). The contact with the floor needs less friction, T over 3/2 m g.
If mu < mu_c the key slides down between the side disks, which roll apart, T = mu N. With the side disk at x = 2R cos phi and the key
2R sin phi above it,
    3/2 m x'' = N [cos phi - mu (1 + sin phi)],   m y'' = -m g + 2 N (sin phi + mu cos phi),   x^2 + y^2 = 4 R^2,
is one equation for phi, integrated here to 1e-11.
"""
import math

from yade_scripts.errors import ParameterError
from yade_scripts.parameter import Parameter
from yade_scripts.scenes import Chart, Known

TITLE = "Arch of three disks"
KIND = "piles at rest"
HORIZON = "About ten times sqrt(R/g), 0.3 s: one arch rests, the other falls as computed, until a lateral error has grown or its key meets the floor."
LEFT_OUT = "a gradual start of the load: the disks touch without force at time 0. The springs then oscillate, the tangential ones without damping"
DEFAULTS = dict(method="CD", disks=3, radius_spread=0.0, friction=0.3, beta_n=0.5, gravity=9.81, period=0.1, records_per_cycle=10, tolerance=1e-12,
                max_iterations=10**6)
POSITIVE = ("gravity",)
PARAMETERS = (Parameter("arch_margin", 0.05, "1", "one arch needs the friction mu (1 - arch_margin), the other one mu (1 + arch_margin)", low=1e-6,
                        high=0.5),)
CHART = Chart(rolling=True)


def rise(mu):
    """Return the angle phi [rad] at which an arch needs just the friction coefficient mu."""
    return math.pi / 2 - 2 * math.atan(mu)


def check(full):
    """Check that there are three disks and that 0 < phi < 60 degrees for both arches, so that the key is above the side disks and these are apart."""
    if full["disks"] != 3:
        raise ParameterError(f"disks = {full['disks']}: an arch has 3")
    least, most = (full["friction"] * (1 + sign * full["arch_margin"]) for sign in (-1, 1))
    if not math.tan(math.radians(15)) < least < most < 1:
        raise ParameterError(f"friction = {full['friction']}: must be between 0.268/(1 - arch_margin) and 1/(1 + arch_margin) for an arch whose "
                             "side disks are apart")


def fall(full, phi):
    """Return how far [m] the key of the falling arch has come down by the end."""
    from scipy.integrate import solve_ivp
    mu, g, span = full["friction"], full["gravity"], 2 * full["radius_mean"]

    def motion(_, state):
        """Return phi' and phi'': x = span cos phi and y = span sin phi give x'' and y'' by phi''; N/m is eliminated."""
        phi, rate = state
        c, s = math.cos(phi), math.sin(phi)
        out, up = (c - mu * (1 + s)) / 1.5, 2 * (s + mu * c)  # x'' and y'' + g over N/m
        # -span (s phi'' + c rate^2) = out N/m and span (c phi'' - s rate^2) = -g + up N/m.
        return rate, (-g * out - span * rate**2 * (up * c - out * s)) / (span * (out * c + up * s))

    end = full["period"] * full["cycles"]
    found = solve_ivp(motion, (0, end), (phi, 0.0), "DOP853", rtol=1e-11, atol=1e-13)
    return span * (math.sin(phi) - math.sin(found.y[0, -1]))


def build(full, folder):
    """Build the standing arch at x = 0 and the falling one far from it."""
    from yade import O
    from yade_scripts.running import stage
    ground = stage.Ground(full)
    radius, mu, time = ground.radius, full["friction"], ground.time
    apart = 20 * radius + full["gravity"] * time**2
    ground.floor(2 * apart)

    def arch(x, phi):
        """Append an arch about x. Return a function for how far [m] its key has come down at the end time, without MD's additional step."""
        for place, height in ((-math.cos(phi), 0), (math.cos(phi), 0), (0, math.sin(phi))):
            state = ground.disk((x + 2 * radius * place, (1 + 2 * height) * radius)).state
        start = state.pos[1]
        return lambda: start - state.pos[1] + state.vel[1] * (O.time - time)

    flat = rise(mu * (1 + full["arch_margin"]))
    exact = fall(full, flat)
    standing, falling = arch(0, rise(mu * (1 - full["arch_margin"]))), arch(apart, flat)
    return stage.small(full, [
        Known("standing", "m", 0.0, standing, scale=exact, source="statics, see the file of the scene; scale: the other arch's fall"),
        Known("falling", "m", exact, falling, source="dynamics of the key sliding between rolling disks, see the file of the scene")])
