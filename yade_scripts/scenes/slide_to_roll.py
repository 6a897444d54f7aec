"""A disk thrown flat on a floor slides, then rolls at 2/3 of its speed, since its angular momentum about the contact point is conserved."""
from yade_scripts.errors import ParameterError
from yade_scripts.scenes import Chart, Known

TITLE = "Disk that slides, then rolls"
KIND = "sliding and rolling"
HORIZON = "From speed/(3 mu g) on, when it rolls, for any time: nothing slows it then."
LEFT_OUT = "rolling friction, which rigid round contacts do not have"
DEFAULTS = dict(method="CD", friction=0.3, gravity=9.81, records_per_cycle=10, tolerance=1e-13)
POSITIVE = "gravity", "friction"
CHART = Chart()


def check(full):
    """Check that the disk rolls before the end."""
    rolls, end = full["speed"] / (3 * full["friction"] * full["gravity"]), full["period"] * full["cycles"]
    if rolls >= end:
        raise ParameterError(f"period = {full['period']}: the run takes {end:g} s, but the disk rolls only after speed/(3 mu g) = {rolls:.3g} s")


def build(full, folder):
    """Build a disk of radius_mean at `speed` along +x; it rolls after speed/(3 mu g)."""
    from yade_scripts.running import stage
    ground = stage.Ground(full)
    radius = ground.radius
    ground.floor(2 * full["speed"] * ground.time + 10 * radius)
    state = ground.disk((0, radius - ground.sag(ground.mass * full["gravity"])), velocity=(full["speed"], 0)).state
    return stage.small(full, [
        Known("final_speed", "m/s", 2 / 3 * full["speed"], lambda: state.vel[0], scale=full["speed"],
              source="angular momentum about the contact point, I = m R^2/2"),
        Known("slip", "m/s", 0.0, lambda: state.vel[0] + radius * state.angVel[2], scale=full["speed"], source="rolling: v = -omega R")])
