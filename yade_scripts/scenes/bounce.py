"""A disk hits a floor without gravity and leaves it with a known share of its speed."""
from yade_scripts import parameters
from yade_scripts.scenes import Chart, Known

TITLE = "Bounce of a disk off a floor"
KIND = "impacts"
HORIZON = "Any time after the bounce: nothing acts on the disk any more."
LEFT_OUT = "gravity and rotation: the impact is central, neither has a part in the speed after it"
DEFAULTS = dict(method="CD", restitution=0.5, period=0.1, records_per_cycle=10, tolerance=1e-13)
CHART = Chart(physics=("beta_n",))


def build(full, folder):
    """Build disk and floor. CD: Newton's restitution. MD: the damped oscillator of eq. 5 over the half period of a contact."""
    from yade_scripts.running import stage
    ground = stage.Ground(full)
    ground.floor()
    height = ground.radius + full["speed"] * full["period"] * full["cycles"] / 4
    state = ground.disk((0, height), velocity=(0, -full["speed"])).state
    return stage.small(full, [Known("restitution", "1", parameters.restitution(full), lambda: state.vel[1] / full["speed"], scale=1.0,
                                    source="CD: Newton's law; MD: exp(-pi beta/sqrt(1 - beta^2)), eq. 5 over half a period")])
