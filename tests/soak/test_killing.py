"""The test of tests/yade_scripts/test_checkpoint.py many times: runs are killed at random moments and resumed."""
import random
import signal

import pytest

from tests.yade_scripts import killing
from tests.yade_scripts.killing import EVERY, ROWS

KILLS = 40


@pytest.mark.timeout(3600)
@pytest.mark.parametrize("name", ROWS)
def test_killed_many_times(tmp_path, name):
    """Forty kills for each method, by SIGKILL, SIGTERM and SIGINT, at moments uniform over a run; if a run finishes first, a new one begins."""
    option, draw, kills, ended = f"--checkpoints={EVERY}", random.Random(name), 0, 0
    folder = tmp_path / "killed"
    for place in (tmp_path / "whole", folder):
        killing.make(place, states=tmp_path / "states")
    reference, seconds = killing.whole(tmp_path / "whole", ROWS[name], option)
    while kills < KILLS or not ended:
        if killing.kill_at(folder, ROWS[name], draw.uniform(0, 1) * seconds, option, by=draw.choice((signal.SIGKILL, signal.SIGTERM, signal.SIGINT))):
            kills += 1
            continue
        path = killing.only_result(folder)
        assert killing.differences(reference, path) == []
        path.unlink()
        ended += 1
    print(f"{name}: {kills} kills, {ended} runs ended in between, all with the bits of the uninterrupted run")
