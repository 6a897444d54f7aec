"""A sphere hits a floor obliquely and slides on it during the impact: it loses speed along the floor and gains spin.

Rigid contact that slides throughout: e_t = 1 - mu (1 + e)/tan a and spin 5 mu (1 + e) V cos a/(2 R), a from the normal (Chung and Ooi 2011, test 4).
It slides to the end if tan a > 7/2 mu (1 + e). Springs stick for a part of the impact also beyond this angle.
"""
import math

from yade_scripts import parameters
from yade_scripts.errors import ParameterError
from yade_scripts.parameter import Parameter
from yade_scripts.scenes import Chart, Known

TITLE = "Oblique impact of a sphere on a floor"
KIND = "spheres in space"
HORIZON = "Any time after the impact: nothing acts on the sphere any more."
LEFT_OUT = "gravity, and the elasticity of the sphere, which lets real ones stick at first"
DEFAULTS = dict(method="CD", restitution=0.98, friction=0.092, beta_n=0.00643, speed=3.9, radius_mean=2.5e-3, period=0.01, cd_dt=1e-5,
                records_per_cycle=10, tolerance=1e-13)
POSITIVE = ("friction",)
IN_SPACE = True
PARAMETERS = (Parameter("impact_angle", 50.0, "degree", "angle between the velocity and the normal of the floor", above=0, high=89),)
CHART = Chart(physics=("beta_n",))


def check(full):
    """Check that the sphere slides to the end of the impact, and that the impact is over at the end."""
    least = math.degrees(math.atan(3.5 * full["friction"] * (1 + parameters.restitution(full))))
    if full["impact_angle"] <= least:
        raise ParameterError(f"impact_angle = {full['impact_angle']}: must exceed {least:.3g} degrees, below which the sphere sticks")
    lasts = 2 * math.pi * math.sqrt(parameters.sphere_mass(full) / parameters.stiffness(full))
    left = full["period"] * full["cycles"] / 2
    if parameters.has_springs(full) and lasts > left:
        raise ParameterError(f"kn = {full['kn']}: the impact may last {lasts:.2g} s, longer than the run; take stiffer springs, or a period of "
                             f"{2 * lasts / full['cycles']:.2g} s")


def build(full, folder):
    """Build the sphere a quarter of the run above the floor; CD: it touches just after the middle of a step, so that friction acts at the
    radius, whatever round-off does."""
    from yade import O
    from yade_scripts.running import stage
    ground = stage.Ground(full)
    ground.wall(0, 1)
    e, mu, radius, a = parameters.restitution(full), full["friction"], ground.radius, math.radians(full["impact_angle"])
    along, down = full["speed"] * math.sin(a), full["speed"] * math.cos(a)
    state = ground.sphere((0, radius, 0), (along, -down, 0)).state
    scene = stage.small(full, [
        Known("restitution", "1", e, lambda: state.vel[1] / down, scale=1.0,
              source="CD: Newton's law; MD: exp(-pi beta/sqrt(1 - beta^2)), eq. 5 over half a period"),
        Known("tangential_restitution", "1", 1 - mu * (1 + e) / math.tan(a), lambda: state.vel[0] / along, scale=1.0,
              source="Coulomb's law, |T| = mu R throughout"),
        Known("spin", "rad/s", -2.5 * mu * (1 + e) * down / radius, lambda: state.angVel[2], source="its impulse at the radius, I = 2/5 m R^2")])
    steps = round(full["period"] * full["cycles"] / 4 / O.dt)
    state.pos = (0, radius + (steps + 0.5 + 1e-6) * O.dt * down, 0)
    return scene
