"""A block (a disk that may not turn) on a slope: it slides at g (sin t - mu cos t), or rests where tan t <= mu."""
import math

from yade_scripts.scenes import Chart, Known

TITLE = "Block on a slope"
KIND = "sliding and rolling"
HORIZON = "Any time: the acceleration is constant. MD's block swings on its tangential spring, which it loads at the start and nothing damps."
LEFT_OUT = "rotation, which is blocked: a block's contacts carry its moment"
DEFAULTS = dict(method="CD", friction=0.3, gravity=9.81, records_per_cycle=10, tolerance=1e-13)
CHART = Chart()


def build(full, folder):
    """Build a block of radius_mean on a slope that falls towards +x."""
    from yade import O
    from yade_scripts.running import stage
    ground = stage.Ground(full)
    t, radius = math.radians(full["slope"]), ground.radius
    ground.box((0, 0), (20 * full["gravity"] * ground.time**2 + 10 * radius, radius), angle=-t)
    height = radius + radius - ground.sag(ground.mass * full["gravity"] * math.cos(t))
    block = ground.disk((height * math.sin(t), height * math.cos(t)), blocked="zXYZ")

    def acceleration():
        return (block.state.vel[0] * math.cos(t) - block.state.vel[1] * math.sin(t)) / O.time

    driving, holding = math.sin(t), full["friction"] * math.cos(t)
    exact = full["gravity"] * math.copysign(max(abs(driving) - holding, 0), driving)
    return stage.small(full, [Known("acceleration", "m/s^2", exact, acceleration, scale=full["gravity"] * abs(driving) or 1.0,
                                    source="Coulomb: g (sin t - mu cos t), 0 where tan t <= mu; scale: g sin t")])
