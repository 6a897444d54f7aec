"""What stands under every figure that is drawn of result files: how many runs have steps that the solver did not solve."""
from types import SimpleNamespace

import pytest

from analysis import style
from analysis.__main__ import main
from analysis.charts import origin

from .conftest import history, write


@pytest.mark.parametrize("counts, words", [((), ""), ((0, 0), ""), ((0, 3, 7), "2 of 3 CD runs have steps that missed the tolerance, at most 7")])
def test_missed_steps_are_counted(counts, words):
    runs = [SimpleNamespace(history={"unconverged_steps": [0, count]}) for count in counts] + [SimpleNamespace(history={"gamma": [0, 1]})]
    assert style.missed(runs) == words


def test_they_stand_on_a_figure(md, cd, tmp_path):
    path = tmp_path / "forces.png"
    assert main(["force-networks", str(md), str(cd), "-o", str(path)]) == 0
    assert f"1 of 1 CD runs have steps that missed the tolerance, at most {history('CD')['unconverged_steps'][-1]}".encode() in path.read_bytes()
    good = write(tmp_path / "b-CD.h5", "CD", columns=history("CD", scale=2e-6) | {"unconverged_steps": 0 * history("CD")["unconverged_steps"]})
    assert main(["force-networks", str(md), str(good), "-o", str(path)]) == 0
    assert b"missed the tolerance" not in path.read_bytes()


def test_they_stand_on_a_chart(tmp_path):
    record = {"status": "finished", "seconds": [0.1], "git_commit": "c" * 40, "processor": "made up"}
    for missed, words in ((0, b"0 of them failed, 2 runs"), (3, b"1 with steps that missed the tolerance")):
        origin.finish(style.plt.figure(), tmp_path / "a.png", "note", [record, record | {"unconverged_steps": missed}])
        assert words in (tmp_path / "a.png").read_bytes()
