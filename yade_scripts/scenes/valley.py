"""A sphere rolls down one face of a valley and meets the other without a rebound: it loses speed, since only the angular momentum about the new
contact is kept: v'/v = (2 + 5 cos t)/7, where t is the angle between the faces' directions."""
import math

from yade_scripts.errors import ParameterError
from yade_scripts.scenes import Chart, Known

TITLE = "Sphere that rolls into a valley"
KIND = "spheres in space"
HORIZON = "Any time after it has met the second face: without gravity nothing slows it."
LEFT_OUT = "gravity, and the rebound of an elastic sphere"
DEFAULTS = dict(method="CD", friction=0.5, period=1.0, records_per_cycle=10, tolerance=1e-13)
METHODS = ("CD",)
ONLY = "springs without gravity do not hold a sphere to a face"
IN_SPACE = True
CHART = Chart()


def check(full):
    """Check that friction holds the sphere in the impact, that it does not rebound, and that steps are short beside the way."""
    if full["restitution"]:
        raise ParameterError(f"restitution = {full['restitution']}: the known answer is that without a rebound: set restitution = 0")
    if full["cd_dt"] > full["period"] * full["cycles"] / 20:
        raise ParameterError(f"period = {full['period']}: the run must take 20 steps cd_dt = {full['cd_dt']} s at least")
    if not 0 < full["slope"] < 80 or full["friction"] < 2 / 7 * math.tan(math.radians(full["slope"]) / 2):
        raise ParameterError(f"slope = {full['slope']}, friction = {full['friction']}: the known answer needs a slope in (0, 80) degrees and a "
                             "friction of 2/7 tan(slope/2) at least")


def build(full, folder):
    """Build two faces of two triangles each, the second turned up by `slope`, and a sphere that rolls towards the edge between them."""
    from yade import O
    from yade_scripts.running import stage
    ground = stage.Ground(full)
    t, radius, speed, wide = math.radians(full["slope"]), ground.radius, full["speed"], 1.0
    long = 1.5 * speed * ground.time
    up = long * math.cos(t), long * math.sin(t)
    for before, after in (((-long, 0), (0, 0)), ((0, 0), up)):
        corners = [(*before, -wide), (*after, -wide), (*after, wide), (*before, wide)]
        ground.facets([corners[:3], [corners[0], *corners[2:]]])
    state = ground.sphere((0, radius, 0.1), (speed, 0, 0), (0, 0, -speed / radius)).state
    kept = (2 + 5 * math.cos(t)) / 7
    scene = stage.small(full, [
        Known("speed", "m/s", kept * speed, lambda: state.vel[0] * math.cos(t) + state.vel[1] * math.sin(t), source="angular momentum about the new "
              "contact, I = 2/5 m R^2"),
        Known("spin", "rad/s", -kept * speed / radius, lambda: state.angVel[2], source="it rolls on"),
        Known("across", "m/s", 0.0, lambda: state.vel[1] * math.cos(t) - state.vel[0] * math.sin(t), scale=speed, source="no rebound")])
    # It meets the second face just after the middle of a step, so that the force acts at the radius, whatever round-off does.
    steps = round(ground.time / 3 / O.dt)
    state.pos = (-radius * math.tan(t / 2) - (steps + 0.5 + 1e-6) * O.dt * speed, radius, 0.1)
    return scene
