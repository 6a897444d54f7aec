"""Two blocks (disks that may not turn) on two slopes, one just below and one just above the friction angle: one rests, one slides.

tan t = mu (1 - margin) and mu (1 + margin). Along the slope the weight drives a block by m g sin t; friction holds up to mu m g cos t. The
second block slides at g (sin t - mu cos t) = margin mu g cos t, a small difference of large forces, and the first one has to rest.
MD begins with unloaded tangential springs. Until they hold the block, after a quarter of their oscillation, it gains the speed g sin t/omega,
omega = sqrt(k_t/m), which nothing removes. The distance that it slides is then too long by the fraction (2 (1 + margin)/margin - pi)/(omega time).
Only stiffer springs make that smaller.
"""
import math

from yade_scripts.parameter import Parameter
from yade_scripts.scenes import Chart, Known

TITLE = "Blocks just below and just above the friction angle"
KIND = "sliding and rolling"
HORIZON = "Any time: one block rests, the other's acceleration is constant."
LEFT_OUT = "rotation, which is blocked: a block's contacts carry its moment"
DEFAULTS = dict(method="CD", friction=0.3, gravity=9.81, records_per_cycle=10, tolerance=1e-13)
POSITIVE = "gravity", "friction"
PARAMETERS = (Parameter("margin", 0.01, "1", "by how much one body is below the limit of friction and the other above it", low=1e-6, high=0.5),)
CHART = Chart()


def build(full, folder):
    """Build the resting block at x = 0 and the sliding one far from it."""
    from yade import O
    from yade_scripts.running import stage
    ground = stage.Ground(full)
    radius, g = ground.radius, full["gravity"]
    steep = math.atan(full["friction"] * (1 + full["margin"]))
    sliding = g * (math.sin(steep) - full["friction"] * math.cos(steep))
    length = sliding * ground.time**2 + 10 * radius

    def block(x, t):
        """Append a block on a slope of t [rad] down towards +x through (x, 0). Return a function for its mean acceleration [m/s^2] since time 0."""
        ground.box((x, 0), (length, radius), angle=-t)
        height = 2 * radius - ground.sag(ground.mass * g * math.cos(t))
        state = ground.disk((x + height * math.sin(t), height * math.cos(t)), blocked="zXYZ").state
        start = state.pos
        return lambda: 2 * ((state.pos - start)[0] * math.cos(t) - (state.pos - start)[1] * math.sin(t)) / O.time**2

    below, above = block(0, math.atan(full["friction"] * (1 - full["margin"]))), block(4 * length, steep)
    return stage.small(full, [
        Known("below", "m/s^2", 0.0, below, scale=sliding, source="Coulomb: rest while tan t <= mu; scale: the other block's acceleration"),
        Known("above", "m/s^2", sliding, above, source="Coulomb: g (sin t - mu cos t)")])
