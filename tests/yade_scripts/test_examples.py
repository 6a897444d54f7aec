"""Small versions of the examples run by both methods, and their results are physically possible."""
import math
import re

import pytest
from PIL import Image

from .conftest import Yade


def said(folder, name, *settings):
    """The numbers in the last lines that an example prints, run headless as its docstring says."""
    done = Yade(folder).script(f"examples/{name}.py", *settings)
    lines = [line for line in done.stdout.splitlines() if "s of computing" in line or line.startswith("saved")]
    assert lines and "Traceback" not in done.stderr and "ContactDynamics: " not in done.stderr, (done.returncode, done.stdout + done.stderr)
    curve, = folder.glob(f"{name}-*.png")
    assert all(path.stat().st_size > 1000 for path in (folder / f"{name}.png", curve, folder / f"{name}.yade.gz"))
    assert len(list(folder.glob(f"{name}-spheres-*.vtk"))) >= 3
    return [float(number) for number in re.findall(r"(?<![\w.])-?\d+\.?\d*(?:e[+-]?\d+)?", " ".join(lines))]


@pytest.fixture(params=[0, 1], ids=["rigid", "springs"])
def springs(request):
    return f"springs={request.param}"


def test_hopper(tmp_path, springs):
    """Some disks leave it, not all in this time, and none is lost."""
    left, disks, _, mass, *_ = said(tmp_path, "hopper", "disks=150", "seconds=0.4", springs)
    assert 10 < left < disks == 150 and mass == pytest.approx(1, abs=1e-6)


def test_drum(tmp_path, springs):
    """The surface stands between the slopes of rolling and of sliding disks, and the drum holds them all."""
    slope, least, most, inside, disks, *_ = said(tmp_path, "drum", "disks=60", "seconds=1.5", "film=1", springs)
    assert 10 < slope < 45 and least < slope < most and inside == disks == 60
    with Image.open(tmp_path / "drum.gif") as film:
        assert 28 <= film.n_frames <= 31  # each 0.05 s, or at the step after it


def test_heap(tmp_path, springs):
    """It rests with a slope below the angle of friction, also after a save and a load."""
    slope, friction, energy, highest, _, _, _, after, moving = said(tmp_path, "heap", "disks=60", "seconds=1", springs)
    assert 3 < slope < friction == pytest.approx(math.degrees(math.atan(0.5)), abs=0.1)
    assert energy < 1e-3 * highest
    assert after == pytest.approx(slope, abs=0.3) and moving < 1e-2 * highest


def test_loaded_box(tmp_path, springs):
    """The floor carries what loads the lid."""
    carried, load, *_ = said(tmp_path, "loaded_box", "disks=60", "seconds=0.3", springs)
    assert load == 10 and carried == pytest.approx(load, rel=0.05)
    assert len(list(tmp_path.glob("loaded_box-intrs-*.vtk"))) == len(list(tmp_path.glob("loaded_box-spheres-*.vtk")))


@pytest.mark.parametrize("word, said", [("disks=abc", "disks=abc: write name=number"), ("disks", "disks: write name=number"),
                                        ("disks=0", "disks=0, springs="), ("springs=2", "disks="), ("disk=5", "disk=5: write name=number")])
@pytest.mark.parametrize("name", ["drum", "heap", "hopper", "loaded_box"])
def test_a_mistake_is_told_in_one_sentence(tmp_path, name, word, said):
    done = Yade(tmp_path).script(f"examples/{name}.py", word)
    assert done.stderr.splitlines()[-1].startswith(said) and "Traceback" not in done.stderr, done.stderr


def test_rows_of_a_table_set_them(tmp_path):
    """yade-batch sets the parameters from the rows of a table. A row is checked as arguments are."""
    table = tmp_path / "table.txt"
    table.write_text("disks seconds\n40 0.2\n40 0\n40.0 1\n'a' 1\n40 'b'\n")
    *refused, done = (Yade(tmp_path).script("examples/hopper.py", YADE_BATCH=f"{table}:{line}") for line in (3, 4, 5, 6, 2))
    assert all("disks must be a whole number" in row.stderr.splitlines()[-1] for row in refused)
    assert "of 40 disks left the hopper in 0.20 s" in done.stdout, done.stdout + done.stderr
    assert [path.name.startswith("hopper-disks=40,seconds=0.2.") for path in tmp_path.glob("*.png")] == [True] * 2  # another row would write others
