"""Disks on top of each other: every contact carries the weight above it."""
from yade_scripts.scenes import Chart, Known

TITLE = "Stack of disks"
KIND = "piles at rest"
HORIZON = ("Any time: nothing moves. The stack is unstable, so a lateral error of any origin grows. In a stack of many disks, n, that roll on each "
           "other it grows about as exp(0.8 t sqrt(n g/R)): tenfold in 0.014 s for 50 disks of 1 cm.")
LEFT_OUT = "the building of the stack: MD starts with springs compressed by the weights, CD without forces"
DEFAULTS = dict(method="CD", disks=50, radius_spread=0.0, gravity=9.81, period=0.1, records_per_cycle=10, tolerance=1e-12, max_iterations=10**6)
POSITIVE = ("gravity",)
CHART = Chart(sizes=(4, 16, 64, 256))


def build(full, folder):
    """Build `disks` equal disks; the springs of MD are compressed by the weights from the start."""
    from yade_scripts.running import bodies, stage
    ground = stage.Ground(full)
    ground.floor()
    weights = [(full["disks"] - k) * ground.mass * full["gravity"] for k in range(full["disks"])]
    height = 0.0
    for weight in weights:
        height = ground.disk((0, height + ground.radius - ground.sag(weight))).state.pos[1] + ground.radius

    def worst():
        return max(abs(bodies.normal_force(k, k + 1) / weight - 1) for k, weight in enumerate(weights))

    return stage.small(full, [Known("worst_force_error", "1", 0.0, worst, source="balance: each contact carries the weight above it")])
