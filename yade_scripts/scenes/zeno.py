"""A dropped disk bounces ever lower and comes to rest after infinitely many bounces in a finite time.

The fall from `drop` takes s = sqrt(2 drop/g), the flight after bounce k takes 2 s e^k; together s (1 + 2 e/(1 - e)).
"""
import math

from yade_scripts import parameters
from yade_scripts.errors import ParameterError
from yade_scripts.parameter import Parameter
from yade_scripts.scenes import Chart, Known

TITLE = "Bouncing to rest"
KIND = "impacts"
HORIZON = "Until the disk rests and from then on for any time."
LEFT_OUT = "rotation: the impacts are central. Bounces below 1e-6 of the first impact's speed count as rest, which changes the time by 1e-6"
# This beta_n gives springs the restitution 0.5.
DEFAULTS = dict(method="CD", restitution=0.5, beta_n=math.log(2) / math.hypot(math.pi, math.log(2)), gravity=9.81, period=0.4, cd_dt=1e-4,
                records_per_cycle=10, tolerance=1e-13)
PARAMETERS = (Parameter("drop", 0.05, "m", "initial distance from the floor to the lowest point of the disk", low=1e-4, high=100),)
CHART = Chart(physics=("beta_n",))

REST = 1e-6  # of the first impact's speed


def rest_time(full):
    """Return the time [s] from the start until the disk rests."""
    e = parameters.restitution(full)
    return math.sqrt(2 * full["drop"] / full["gravity"]) * (1 + 2 * e / (1 - e))


def check(full):
    """Check that the disk comes to rest before the end."""
    if not full["gravity"] or parameters.restitution(full) == 1 or rest_time(full) >= full["period"] * full["cycles"]:
        raise ParameterError("scene = zeno: needs gravity, a restitution below 1 (MD: beta_n above 0) and a period beyond the time of rest, which "
                             "is sqrt(2 drop/g) (1 + e)/(1 - e)")


def build(full, folder):
    """Build the floor and the disk `drop` above it."""
    from yade import O
    from yade_scripts.running import hooks, stage
    ground = stage.Ground(full)
    radius = ground.radius
    ground.floor()
    state = ground.disk((0, radius + full["drop"])).state
    slow, moved = REST * math.sqrt(2 * full["gravity"] * full["drop"]), [0.0]

    def watch():
        """Store the last time at which the disk moved; called after every step."""
        if abs(state.vel[1]) > slow:
            moved[0] = O.time + O.dt

    scene = stage.small(full, [
        Known("rest_time", "s", rest_time(full), lambda: moved[0], source="sum of the flights: sqrt(2 drop/g) (1 + 2e/(1 - e))"),
        Known("height_at_rest", "m", 0.0, lambda: state.pos[1] - radius, scale=full["drop"], source="it lies on the floor")])
    O.engines = O.engines + [hooks.runner(watch, iterPeriod=1, initRun=True, label=hooks.MEASURING)]
    return scene
