"""A sphere thrown flat on a floor slides, then rolls at 5/7 of its speed, since its angular momentum about the contact point is conserved."""
import math

from yade_scripts import parameters
from yade_scripts.errors import ParameterError
from yade_scripts.scenes import Chart, Known

TITLE = "Sphere that slides, then rolls"
KIND = "spheres in space"
HORIZON = "From 2 speed/(7 mu g) on, when it rolls, for any time: nothing slows it then."
LEFT_OUT = "rolling friction, which rigid round contacts do not have"
DEFAULTS = dict(method="CD", friction=0.3, gravity=9.81, records_per_cycle=10, tolerance=1e-13)
POSITIVE = "gravity", "friction"
IN_SPACE = True
CHART = Chart()
WAY = 0.8, 0.6  # along x and z: no axis of the scene


def check(full):
    """Check that the sphere rolls before the end, and that springs are stiff enough to hold it."""
    if (sag := parameters.sphere_sags(full)) > 0.1 * full["radius_mean"]:
        raise ParameterError(f"kn = {full['kn']}: the sphere would sink in by {sag:.2g} m, more than a tenth of its radius; take stiffer springs")
    rolls, end = 2 * full["speed"] / (7 * full["friction"] * full["gravity"]), full["period"] * full["cycles"]
    if rolls >= end:
        raise ParameterError(f"period = {full['period']}: the run takes {end:g} s, but the sphere rolls only after 2 speed/(7 mu g) = {rolls:.3g} s")


def build(full, folder):
    """Build a sphere of radius_mean at `speed` along WAY."""
    from yade_scripts.running import stage
    ground = stage.Ground(full)
    ground.wall(0, 1)
    speed, (x, z) = full["speed"], WAY
    state = ground.sphere((0, ground.radius - ground.sag(ground.mass * full["gravity"]), 0), (speed * x, 0, speed * z)).state
    return stage.small(full, [
        Known("final_speed", "m/s", 5 / 7 * speed, lambda: state.vel[0] * x + state.vel[2] * z, scale=speed,
              source="angular momentum about the contact point, I = 2/5 m R^2"),
        Known("slip", "m/s", 0.0, lambda: math.hypot(state.vel[0] + ground.radius * state.angVel[2], state.vel[2] - ground.radius * state.angVel[0]),
              scale=speed, source="rolling: v = omega x R"),
        Known("aside", "m/s", 0.0, lambda: state.vel[2] * x - state.vel[0] * z, scale=speed, source="friction acts against the slip")])
