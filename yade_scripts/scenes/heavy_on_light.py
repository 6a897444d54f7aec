"""A heavy disk on a light one: the lower contact carries both weights, the upper one the heavy weight, and nothing sinks.

Each Gauss-Seidel sweep passes the share light/(light + heavy) of the load down, so the error falls by a factor exp(1) in about mass_ratio sweeps.
Springs hold the two as a slow oscillator, omega = sqrt(k_n/(2M)). Dashpots of the light mass damp it by only beta sqrt(m k_n)/(2 M), so
coming to rest takes 2M/(beta sqrt(m k_n)), 2 mass_ratio times as long as for the light disk alone.
"""
from yade_scripts.parameter import Parameter
from yade_scripts.scenes import Chart, Known

TITLE = "Heavy disk on a light one"
KIND = "piles at rest"
HORIZON = "Once the contacts carry the weights, for any time: CD's first step, MD after a few 2M/(beta sqrt(m k_n)) from touching without force."
LEFT_OUT = "motion sideways and rotation, which are blocked, since the column is unstable"
DEFAULTS = dict(method="CD", disks=2, radius_spread=0.0, friction=0.0, beta_n=0.5, gravity=9.81, period=0.5, records_per_cycle=10, tolerance=1e-12,
                max_iterations=10**6)
PARAMETERS = (Parameter("mass_ratio", 100.0, "1", "mass of the upper disk over that of the lower", low=1e-8, high=1e8),)
CHART = Chart()


def build(full, folder):
    """Build both disks of radius_mean, touching."""
    from yade_scripts.running import bodies, stage
    ground = stage.Ground(full)
    radius, light = ground.radius, ground.mass
    heavy, floor = full["mass_ratio"] * light, ground.floor()
    lower, upper = (ground.disk((0, height * radius), mass=mass, blocked="xzXYZ") for height, mass in ((1, light), (3, heavy)))
    weight, source = full["gravity"] * heavy, "balance: the weight above"
    return stage.small(full, [
        Known("lower_force", "N", weight + full["gravity"] * light, lambda: bodies.normal_force(floor, lower.id), source=source),
        Known("upper_force", "N", weight, lambda: bodies.normal_force(lower.id, upper.id), source=source),
        Known("sinking", "m", 0.0, lambda: 3 * radius - upper.state.pos[1], scale=radius, source="rigid disks do not give way")])
