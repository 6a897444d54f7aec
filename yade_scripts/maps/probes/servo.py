"""One triangle of load by the servo, recorded like any run, with a gain and a largest speed that are not the servo's own."""
import functools
import pathlib
import statistics
import tempfile

from yade import O

from yade_scripts import bodies, hooks, load_check, loading, parameters, prepare, record, results, scenes, stage, walls
from yade_scripts.maps import INACCURATE, STABLE, UNSTABLE, Outcome

DISKS, SAMPLES, BETA = 100, 20, 0.3
STRESS_ERROR, STRAIN_ERROR, FLIPPING = 0.05, 0.1, 0.5
FOLDER = results.FOLDER  # of prepared packings


class Watch:
    """What the recorder does not see: each wall by itself, and the way of wall y+ step by step."""

    def __init__(self, scene, full):
        self.scene, self.p0 = scene, parameters.pressure(full)
        self.errors, self.means, self.gammas = [], [], []
        self.sides, self.place, self.direction, self.reversals, self.steps = walls.sides(), None, 0, 0, 0

    def sample(self):
        """Stress errors over P0 and gamma, beside the recorder's sample."""
        stresses, goal = walls.stresses(), self.scene.load.goal
        self.errors.append(max(abs(s - g) for pair, g in zip(stresses, goal) for s in pair) / self.p0)
        self.means.append(max(abs(sum(pair) / 2 - g) for pair, g in zip(stresses, goal)) / self.p0)
        strain = [now / first - 1 for now, first in zip(walls.sides(), self.sides)]
        self.gammas.append(abs(strain[1] - strain[0]))

    def step(self):
        """Count the changes of direction."""
        place = O.bodies[walls.Y_HIGH].state.pos[1]
        if self.place is not None and place != self.place:
            direction = 1 if place > self.place else -1
            self.reversals += direction == -self.direction
            self.direction = direction
        self.place, self.steps = place, self.steps + 1


def probe(case):
    """See the map of this name."""
    error, watch = run(case)
    half = len(watch.errors) // 2
    reference = reference_gamma(case["period"])
    measures = {"stress_error": statistics.median(watch.errors[half:]), "mean_stress_error": statistics.median(watch.means[half:]), "reversals": watch.reversals / watch.steps,
                "largest_gamma": max(watch.gammas), "strain_error": abs(max(watch.gammas) / reference - 1), "samples": len(watch.errors),
                "theory": watch.limit}
    if measures["mean_stress_error"] > STRESS_ERROR:
        locked = measures["reversals"] > FLIPPING
        return Outcome(UNSTABLE if locked else INACCURATE, "locked walls" if locked else "load missed", error, measures)
    if measures["strain_error"] > STRAIN_ERROR:
        return Outcome(INACCURATE, "wrong motion", error, measures)
    return Outcome(STABLE, told=error, measures=measures)


@functools.cache
def reference_gamma(period):
    """The largest |gamma| under a gain of 1 and walls as fast as they need be."""
    O.reset()
    _, watch = run({"period": period, "gain": 1.0, "max_velocity": 1.0})
    return max(watch.gammas)


def gain_limit(own_gain):
    """Of stability: the largest gain G = a own_gain, a = 1 - stressDamping, own_gain = 2 beta sqrt(m/k_n)/dt.

    The controller moves a wall by d(n+1) = 0.8 d(n) - a e(n); e(n), the error of the force over the wall's stiffness, is
    f (x(n) + own_gain d(n)) with d(n) = x(n) - x(n-1), since the dashpots see the velocity of the last step. The way out of the unit circle
    is x(n) = (-1)^n, so 2 = a f (1 + 2 own_gain) - 1.6. Disks that the walls push to and fro answer in the opposite sense, by their inertia:
    f = 4/(4 - Q), Q = s^2 + 4 beta s, s = dt sqrt(k_n/m), all mean disks and held by nothing else.
    """
    s = 2 * BETA / own_gain
    answer = 4 / (4 - s**2 - 4 * BETA * s)
    return 1.8 / (answer * (1 + 0.5 / own_gain))


def run(case):
    """(the error that ended the run or '', Watch)."""
    path, _ = prepare.ensure(parameters.complete({"disks": DISKS}), FOLDER)
    O.load(str(path))
    full = parameters.complete({"disks": DISKS, "period": case["period"], "records_per_cycle": SAMPLES, "beta_n": BETA})
    for material in O.materials:
        material.betan = BETA
    for contact in O.interactions:
        if contact.isReal:
            contact.phys.cn = BETA * contact.phys.cn_crit
    scene = scenes.Scene(every=stage.set_step(full, stage.largest_step(full)), samples=SAMPLES)
    stage.load_walls(full, scene, loading.goals(full, parameters.pressure(full)))
    controller = scene.load.controller
    own_gain = 2 * BETA * (bodies.mean_mass() / parameters.stiffness(full))**0.5 / O.dt
    controller.stressDamping, controller.max_vel = 1 - case["gain"] / own_gain, case["max_velocity"]
    watch = Watch(scene, full)
    watch.limit = gain_limit(own_gain)
    with tempfile.TemporaryDirectory() as folder:
        recorder, failure = record.Recorder(pathlib.Path(folder) / "servo.h5", full, scene), None

        def observe():
            watch.sample()
            recorder.sample()

        scene.observer = observe
        O.engines = O.engines + [hooks.runner(watch.step, iterPeriod=1)]
        try:
            scenes.method(full).run(scene)
        except load_check.Collapse:
            pass  # a result, and so no way of saying that the walls have locked
        except load_check.StressError as ended:
            failure = ended
        recorder.close(failure=failure)
    return "" if failure is None else str(failure), watch
