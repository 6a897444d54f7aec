"""Map of MD: the servo of the walls, its gain against the largest speed of the walls."""
import functools
import pathlib
import tempfile

import numpy as np
import pandas

from yade_scripts import parameters
from yade_scripts.measuring.maps import Axis, INACCURATE, Map, Outcome, STABLE, UNSTABLE, lines, logarithmic, product

DISKS, SAMPLES, BETA = 100, 20, 0.3
STRESS_ERROR, STRAIN_ERROR, FLIPPING = 0.05, 0.1, 0.5
PERIODS = {True: [0.2, 0.02], False: [0.2]}  # of the full and of the quick map

MAP = Map(
    order=2,
    title="The walls' servo",
    question="When do servo-driven walls carry their load, and does the program notice when they do not?",
    criterion="100 disks under one triangle of 0.2 P0, damping ratio 0.3, recorded 20 times. In most samples of the second half the stress "
              "(mean of opposite walls) is off its goal by more than 5 % of P0: unstable (locked) if walls change direction at more than "
              "half of the steps, else inaccurate (load missed). Inaccurate too if the largest gamma is off by a tenth of its value at gain "
              "1.",
    remedy="walls.servo keeps the gain at 1 or below, and a run whose walls are more than 5 % of P0 off ends with an error. Below that "
           "nothing warns, although gamma was wrong by up to {{ cells.strain_error[cells.told.isna()].max() | percent }} % under a load of "
           "0.2 P0: 'stress error/P0' in `python3 -m analysis summary results/*.h5` should be a few 1e-3 at most.",
    x=Axis("gain", r"gain $(1-\mathtt{stressDamping})\,2\beta_n\,\sqrt{m/k_n}/dt$"), y=Axis("max_velocity", "max_vel [m/s]"), panels="period",
    measures={"stress_error": "error of the worst wall's stress over P0, median of the second half",
              "mean_stress_error": "the same of the means of opposite walls, which is what a history shows",
              "reversals": "share of the steps at which wall y+ changes direction", "largest_gamma": "largest |gamma|",
              "strain_error": "of the largest |gamma|, relative to that under gain 1", "samples": "taken before the run ended",
              "theory": "gain at which walls begin to flip by a theory of equal disks"},
    grid=lambda full: product(period=PERIODS[full], max_velocity=logarithmic(1e-4, 1e2, 13) if full else logarithmic(1e-3, 1e2, 6),
                              gain=logarithmic(0.25, 8, 11) if full else logarithmic(0.5, 4, 4)),
    searches=lambda full: (lines("gain", 0.5, 8.0, 1.02 if full else 1.1, period=[0.2], max_velocity=[0.1, 1.0, 10.0] if full else [1.0])
                           + lines("max_velocity", 1.0, 1e-6, 1.05 if full else 1.5, period=PERIODS[full], gain=[1.0])),
    marks={"largest that walls.servo sets": 1.0}, theory_label="flipping walls, equal disks", theory_along="gain")


def probe(case):
    error, measures = run(case)
    measures["strain_error"] = abs(measures["largest_gamma"] / reference_gamma(case["period"]) - 1)
    if measures["mean_stress_error"] > STRESS_ERROR:
        locked = measures["reversals"] > FLIPPING
        return Outcome(UNSTABLE if locked else INACCURATE, "locked walls" if locked else "load missed", error, measures)
    if measures["strain_error"] > STRAIN_ERROR:
        return Outcome(INACCURATE, "wrong motion", error, measures)
    return Outcome(STABLE, told=error, measures=measures)


@functools.cache
def reference_gamma(period):
    """Return the largest |gamma| for a gain of 1 and walls that may move as fast as they need."""
    from yade import O
    O.reset()
    return run({"period": period, "gain": 1.0, "max_velocity": 1.0})[1]["largest_gamma"]


def gain_limit(own_gain):
    """Return the limit of stability: the largest gain G = a own_gain, a = 1 - stressDamping, own_gain = 2 beta sqrt(m/k_n)/dt.

    The controller moves a wall by d(n+1) = 0.8 d(n) - a e(n). The error of the force over the wall's stiffness is
    e(n) = f (x(n) + own_gain d(n)) with d(n) = x(n) - x(n-1), since the dashpots see the velocity of the last step. At the limit
    x(n) = (-1)^n, so 2 = a f (1 + 2 own_gain) - 1.6. The inertia of the disks that the walls push to and fro gives a response of opposite sign:
    f = 4/(4 - Q), Q = s^2 + 4 beta s, s = dt sqrt(k_n/m). All disks are taken as mean disks that nothing else holds.
    """
    s = 2 * BETA / own_gain
    answer = 4 / (4 - s**2 - 4 * BETA * s)
    return 1.8 / (answer * (1 + 0.5 / own_gain))


def run(case):
    """Run a case. Return (the message of the error that ended it or '', what the map measures but for the strain_error)."""
    from yade import O
    from yade_scripts.preparing import prepare
    from yade_scripts.running import bodies, hooks, loading, md, recorder, stage, wall_check, walls
    prepare.load(parameters.complete({"disks": DISKS}))
    full = parameters.complete({"disks": DISKS, "period": case["period"], "records_per_cycle": SAMPLES, "beta_n": BETA})
    md.set_damping(BETA)
    scene = stage.scene(full)
    stage.load_walls(full, scene, loading.of_row(full, parameters.pressure(full)))
    controller = scene.load.controller
    own_gain = 2 * BETA * (bodies.mean_mass() / parameters.stiffness(full))**0.5 / O.dt
    controller.stressDamping, controller.max_vel = 1 - case["gain"] / own_gain, case["max_velocity"]
    p0, top, errors, places = parameters.pressure(full), O.bodies[walls.Y_HIGH].state, [], []
    with tempfile.TemporaryDirectory() as folder:
        sampler, failure = recorder.Recorder(pathlib.Path(folder) / "servo.h5", full, scene), ""

        def observe():
            # Of each wall, where a history has the means of opposite ones.
            errors.append(max(abs(stress - goal) for pair, goal in zip(walls.stresses(), scene.load.goal) for stress in pair) / p0)
            sampler.sample()

        scene.observer = observe
        O.engines = O.engines + [hooks.runner(lambda: places.append(top.pos[1]), iterPeriod=1)]
        try:
            md.run(scene)
        except wall_check.Collapse:
            pass  # a collapse is a result; it does not report locked walls
        except wall_check.StressError as ended:
            failure = str(ended)
    history = pandas.DataFrame(sampler.rows, columns=sampler.names)
    half, moves = len(errors) // 2, np.sign(np.diff(places))
    moves = moves[moves != 0]
    means = np.maximum(*(abs(history[f"sigma{k}"] - history[f"sigma{k}_goal"]) for k in (1, 2))) / p0
    return failure, {
        "stress_error": np.median(errors[half:]), "mean_stress_error": np.median(means[half:]),
        "reversals": np.count_nonzero(np.diff(moves)) / len(places), "largest_gamma": abs(history["gamma"]).max(), "samples": len(errors),
        "theory": gain_limit(own_gain)}
