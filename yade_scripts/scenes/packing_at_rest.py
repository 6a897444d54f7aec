"""A prepared packing stays under the pressure P0 under which it was prepared: nothing may move."""
from yade_scripts import parameters
from yade_scripts.scenes import Chart, Known, biaxial

TITLE = "Packing at rest under its load"
KIND = "piles at rest"
HORIZON = "Any time: nothing moves."
LEFT_OUT = "all loading: any motion is an error of the method"
DEFAULTS = dict(method="CD", disks=60, period=0.1, records_per_cycle=10)
CHART = Chart(prepared=True, physics=("beta_n",))


def build(full, folder):
    """Build the packing and the walls of the biaxial test with sigma1 = sigma2 = P0."""
    from yade_scripts.running import loading, walls
    p0 = parameters.pressure(full)
    scene = biaxial.build(full, folder, loading.constant(p0))
    sides = walls.sides()
    scene.known = [
        Known("worst_stress_error", "1", 0.0, lambda: walls.stress_error(p0), source="balance: each wall carries P0 on its length"),
        Known("gamma", "1", 0.0, lambda: walls.gamma(sides), scale=p0 * full["depth"] / parameters.stiffness(full),
              source="the packing is in balance; scale: P0/k_n, the order of the strain of the springs under P0")]
    return scene
