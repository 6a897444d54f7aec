"""A fast disk flies at a wall that is thinner than the distance it flies in a step: it must bounce and not pass through."""
import math

from yade_scripts import parameters
from yade_scripts.parameter import Parameter
from yade_scripts.scenes import Chart, Known

TITLE = "Fast disk against a thin wall"
KIND = "impacts"
HORIZON = "Any time after the impact: nothing acts on the disk any more."
LEFT_OUT = "gravity and rotation: the impact is central"
DEFAULTS = dict(method="CD", restitution=0.5, beta_n=math.log(2) / math.hypot(math.pi, math.log(2)), speed=10.0, period=0.03, cd_dt=1e-4,
                records_per_cycle=10, tolerance=1e-13)
PARAMETERS = (Parameter("wall_thickness", 0.1, "1", "thickness of the wall, over the mean radius", low=1e-6, high=100),)
CHART = Chart(physics=("beta_n",))


def build(full, folder):
    """Build the wall with its face at x = 0 and the disk, which moves along +x and reaches the wall after a third of the time."""
    from yade import O
    from yade_scripts.running import stage
    ground = stage.Ground(full)
    radius, speed, time, e = ground.radius, full["speed"], ground.time, parameters.restitution(full)
    half = full["wall_thickness"] * radius / 2
    ground.box((half, 0), (half, 10 * radius))
    state = ground.disk((-radius - speed * time / 3, 0), velocity=(speed, 0)).state
    return stage.small(full, [
        Known("speed", "m/s", -e * speed, lambda: state.vel[0], scale=speed, source="restitution of the law, see scene bounce"),
        # MD ends a step later, in free flight.
        Known("place", "m", -radius - 2 / 3 * e * speed * time, lambda: state.pos[0] - state.vel[0] * (O.time - time), scale=speed * time,
              source="free flight before and after an impact that takes no time")])
