"""Functions called from inside YADE's loop."""
import time

import pytest


def test_a_stopped_loop_has_ended_its_step(O):
    """O.pause() lets O.run return within its 40 ms of waiting, while the rest of the step, which is longer here, still runs."""
    from cd_engine import failing
    from yade_scripts.running import hooks
    ended = []

    def slow():
        time.sleep(0.3)
        ended.append(O.iter)
    O.engines = [hooks.runner(failing.stop, iterPeriod=1, initRun=True), hooks.runner(slow, iterPeriod=1, initRun=True)]
    hooks.simulate(10)
    assert ended == [0] and O.iter == 1


def test_a_failure_ends_the_loop_with_its_step_and_is_raised(O):
    from yade_scripts.running import hooks
    ended = []

    def fail():
        raise ArithmeticError("as meant")

    def slow():
        time.sleep(0.3)
        ended.append(O.iter)
    O.engines = [hooks.runner(fail, iterPeriod=1, initRun=True), hooks.runner(slow, iterPeriod=1, initRun=True)]
    with pytest.raises(ArithmeticError, match="as meant"):
        hooks.simulate(10)
    assert ended == [0]


def test_samples_and_measurements_cost_the_run_nothing(O):
    """A runner without a label is part of the simulation and counts. The time of one that fails is left out, too."""
    from yade_scripts.running import hooks

    def burn():
        end = time.process_time() + 0.1
        while time.process_time() < end:
            pass
        if O.iter == 2:
            raise ArithmeticError("as meant")

    def spent(label):
        O.engines = [hooks.runner(burn, iterPeriod=1, initRun=True, label=label)]
        before = hooks.processor_time()
        with pytest.raises(ArithmeticError):
            hooks.simulate(3)
        return hooks.processor_time() - before

    for label, least, most in ((hooks.SAMPLING, 0, 0.1), (hooks.MEASURING, 0, 0.1), ("", 0.3, 10)):
        O.reset()
        assert least <= spent(label) < most
