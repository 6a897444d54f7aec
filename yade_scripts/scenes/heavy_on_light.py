"""A heavy disk on a light one: the lower contact carries both weights, the upper one the heavy weight, and nothing sinks.

Each Gauss-Seidel sweep passes the share light/(light + heavy) of the load down, so the error falls by a factor exp(1) in about mass_ratio sweeps.
Springs hold the two as a slow oscillator, omega = sqrt(k_n/(2M)). Dashpots of the light mass damp it by only beta sqrt(m k_n)/(2 M), so
coming to rest takes M/(beta sqrt(m k_n)), also mass_ratio times as long as for the light disk alone.
"""
from yade_scripts.parameters import Parameter
from yade_scripts.scenes import Chart, Known

TITLE = "Heavy disk on a light one"
KIND = "piles at rest"
METHODS = ("MD", "CD")
HORIZON = "Once the contacts carry the weights, for any time: CD's first step, MD after a few 2M/(beta sqrt(m k_n)) from touching without force."
LEFT_OUT = "motion sideways and rotation, which are blocked: the column is unstable, and its fall is another question than its forces"
DEFAULTS = dict(method="CD", disks=2, radius_spread=0.0, friction=0.0, beta_n=0.5, gravity=9.81, period=0.5, cd_dt=1e-3, records_per_cycle=10,
                tolerance=1e-12, max_iterations=1000000)
PARAMETERS = (Parameter("mass_ratio", 100.0, "1", "mass of the upper disk over that of the lower", low=1e-8, high=1e8),)
CHART = Chart()


def build(full, folder):
    """Build both disks of radius_mean, touching."""
    from yade import O

    from yade_scripts.preparing import bodies
    from yade_scripts.running import stage
    radius, light = full["radius_mean"], bodies.disk_mass(full["radius_mean"], full)
    heavy = full["mass_ratio"] * light
    bodies.append_material("disk", full["friction"], full)
    floor = bodies.append_floor(full)
    lower, upper = (bodies.append_disk((0, height * radius), radius, mass, "disk", blocked="xzXYZ") for height, mass in ((1, light), (3, heavy)))
    state = O.bodies[upper].state
    weight, source = full["gravity"] * heavy, "balance: the weight above"
    return stage.small(full, [
        Known("lower_force", "N", weight + full["gravity"] * light, lambda: bodies.normal_force(floor, lower), source=source),
        Known("upper_force", "N", weight, lambda: bodies.normal_force(lower, upper), source=source),
        Known("sinking", "m", 0.0, lambda: 3 * radius - state.pos[1], scale=radius, source="rigid disks do not give way")])
