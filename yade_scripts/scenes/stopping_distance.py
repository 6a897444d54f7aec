"""A block thrown flat on a floor stops by friction after speed^2/(2 mu g), and stays where it stopped."""
from yade_scripts.errors import ParameterError
from yade_scripts.scenes import Chart, Known

TITLE = "Stopping distance of a block"
KIND = "sliding and rolling"
HORIZON = "From speed/(mu g) on, when it has stopped, for any time."
LEFT_OUT = "rotation, which is blocked: a block's contacts carry its moment"
DEFAULTS = dict(method="CD", friction=0.3, gravity=9.81, period=0.5, records_per_cycle=10, tolerance=1e-13)
CHART = Chart()


def check(full):
    """Check that the block stops before the end."""
    pull = full["friction"] * full["gravity"]
    if full["speed"] >= pull * full["period"] * full["cycles"]:
        raise ParameterError(f"speed = {full['speed']}: must be below friction times gravity times the time simulated, "
                             f"{pull * full['period'] * full['cycles']:g} m/s, so that the block stops")


def build(full, folder):
    """Build a block of radius_mean at `speed` along +x."""
    from yade_scripts.running import stage
    ground = stage.Ground(full)
    distance = full["speed"]**2 / (2 * full["friction"] * full["gravity"])
    ground.floor(2 * distance + 10 * ground.radius)
    height = ground.radius - ground.sag(ground.mass * full["gravity"])
    state = ground.disk((0, height), velocity=(full["speed"], 0), blocked="zXYZ").state
    return stage.small(full, [
        Known("distance", "m", distance, lambda: state.pos[0], source="work of friction: v^2/(2 mu g)"),
        Known("speed_at_rest", "m/s", 0.0, lambda: state.vel[0], scale=full["speed"], source="Coulomb: friction stops it and holds it")])
