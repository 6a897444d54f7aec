"""Small versions of the examples run by both methods, and their results are physically possible."""
import math
import re

import numpy as np
import pytest
from PIL import Image

from .conftest import Yade


SPACE = "silo", "tumbler", "oedometer"


def said(folder, name, *settings, may_say="no message"):
    """The numbers in the last lines that an example prints, run headless as its docstring says."""
    done = Yade(folder).script(f"examples/{name}.py", *settings)
    lines = [line for line in done.stdout.splitlines() if "s of computing" in line or line.startswith("saved")]
    messages = [line for line in done.stderr.splitlines() if "ContactDynamics: " in line and may_say not in line]
    assert lines and "Traceback" not in done.stderr and not messages, (done.returncode, done.stdout + done.stderr)
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


def exported(folder, name):
    """Places and radii of the spheres in the last VTK file of an example."""
    words = sorted(folder.glob(f"{name}-spheres-*.vtk"))[-1].read_text().split()
    count, first = int(words[words.index("POINTS") + 1]), words.index("POINTS") + 3
    radii = words.index("radius") + words[words.index("radius"):].index("default") + 1
    return np.array(words[first:first + 3 * count], float).reshape(-1, 3), np.array(words[radii:radii + count], float)


def test_silo(tmp_path, springs):
    """Spheres leave it and none is lost, at a rate beside Beverloo's law, which holds to some tens of per cent. Those in the VTK file are in the
    cylinder or below it. Springs end in mid-flow, so the first long step of Contact Dynamics may overlap."""
    left, spheres, _, mass, rate, law, *_, cheap, dear = said(tmp_path, "silo", "spheres=150", "seconds=0.3", springs, may_say="overlap by")
    assert 10 < left <= spheres == 150 and mass == pytest.approx(1, abs=1e-6) and rate == pytest.approx(law, rel=0.4) and cheap > 0 < dear
    place, radius = exported(tmp_path, "silo")
    assert (np.hypot(*place[:, :2].T) < 0.061 - 0.9 * radius).all() and len(place) >= spheres - left
    facets = (tmp_path / "silo-facets-00000000.vtk").read_text()
    assert re.search(r"POLYGONS (\d+)", facets)[1] == "96"


def test_tumbler(tmp_path, springs):
    """The drum holds all spheres, whose kinds come nearer to each other."""
    before, after, turns, inside, spheres, *_, cheap, dear = said(tmp_path, "tumbler", "spheres=60", "seconds=0.8", "film=1", springs,
                                                                  may_say="overlap by")
    assert inside == spheres == 60 and turns == pytest.approx(0.4) and 0.3 < before and after < before and cheap > 0 < dear
    place, radius = exported(tmp_path, "tumbler")
    inner = 0.005 * (12 * 60)**(1 / 3)
    assert len(place) == 60 and (np.hypot(place[:, 0], place[:, 2]) < inner - 0.9 * radius).all()
    with Image.open(tmp_path / "tumbler.gif") as film:
        assert 15 <= film.n_frames <= 17


def test_oedometer(tmp_path, springs):
    """Under the load the plate has pressed the spheres together; unloaded it stands a little higher: what the springs give back. 60 spheres of a
    fifth of the box cannot be packed closer than 0.74."""
    load, pressed, lifted, spheres, *_, cheap, dear = said(tmp_path, "oedometer", "spheres=60", "load=50", springs)
    place, radius = exported(tmp_path, "oedometer")
    assert load == 50 and spheres == len(place) == 60 and cheap > 0 < dear
    assert (4 / 3 * math.pi * radius**3).sum() / 0.74 < pressed < lifted < pressed + 0.05
    assert ((place[:, 2] + radius) < lifted + 0.02 * radius.max()).all() and (place > 0).all() and (place[:, :2] < 1).all()
    assert len(list(tmp_path.glob("oedometer-intrs-*.vtk"))) == 3


@pytest.mark.parametrize("word, said", [("disks=abc", "disks=abc: write name=number"), ("disks", "disks: write name=number"),
                                        ("disks=0", "disks=0, springs="), ("springs=2", "disks="), ("disk=5", "disk=5: write name=number")])
@pytest.mark.parametrize("name", ["drum", "heap", "hopper", "loaded_box", *SPACE])
def test_a_mistake_is_told_in_one_sentence(tmp_path, name, word, said):
    if name in SPACE:
        word, said = (text.replace("disk", "sphere") for text in (word, said))
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
