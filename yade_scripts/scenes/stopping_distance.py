"""A block thrown flat on a floor stops by friction after speed^2/(2 mu g), and stays where it stopped."""
from yade_scripts.parameters import ParameterError
from yade_scripts.scenes import Chart, Known

TITLE = "Stopping distance of a block"
KIND = "sliding and rolling"
METHODS = ("MD", "CD")
HORIZON = "From speed/(mu g) on, when it has stopped, for any time."
LEFT_OUT = "rotation, which is blocked: a block's contacts carry its moment"
DEFAULTS = dict(method="CD", friction=0.3, gravity=9.81, period=0.5, cd_dt=1e-3, records_per_cycle=10, tolerance=1e-13)
CHART = Chart()


def check(full):
    """Check that the block stops before the end."""
    pull = full["friction"] * full["gravity"]
    if full["speed"] >= pull * full["period"] * full["cycles"]:
        raise ParameterError(f"speed = {full['speed']}: must be below friction times gravity times the time simulated, "
                             f"{pull * full['period'] * full['cycles']:g} m/s, so that the block stops")


def build(full, folder):
    """Build a block of radius_mean at `speed` along +x."""
    from yade import O

    from yade_scripts.preparing import bodies
    from yade_scripts.running import stage
    radius, mass = full["radius_mean"], bodies.disk_mass(full["radius_mean"], full)
    bodies.append_material("disk", full["friction"], full)
    distance = full["speed"]**2 / (2 * full["friction"] * full["gravity"])
    bodies.append_floor(full, length=2 * distance + 10 * radius)
    block = bodies.append_disk((0, radius - bodies.sag(mass * full["gravity"], full)), radius, mass, "disk", (full["speed"], 0), "zXYZ")
    state = O.bodies[block].state
    return stage.small(full, [
        Known("distance", "m", distance, lambda: state.pos[0], source="work of friction: v^2/(2 mu g)"),
        Known("speed_at_rest", "m/s", 0.0, lambda: state.vel[0], scale=full["speed"], source="Coulomb: friction stops it and holds it"),
    ])
