"""Killed runs resume from their last checkpoint and end with the numbers of uninterrupted runs."""
import json
import random
import re
import subprocess

import h5py
import numpy as np
import pytest

from yade_scripts import parameters, results

from . import killing
from .killing import EVERY, ROWS


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """name of a row -> (result file of the uninterrupted run with checkpoints, seconds it took); the packing is prepared once."""
    folder, done = tmp_path_factory.mktemp("whole"), {}

    def of(name, *options):
        if (name, options) not in done:
            place = folder / f"{name}{''.join(options)}".replace("=", "")
            killing.make(place, states=folder / "states")
            done[name, options] = killing.whole(place, ROWS[name], *options)
        return done[name, options]
    return of


@pytest.mark.parametrize("name", ROWS)
def test_killed_at_random_and_taken_up_is_as_if_never_killed(whole, tmp_path, name):
    """Bit by bit, servo included: a run passes through save and load at its checkpoints whether it is interrupted or not. `make soak` kills
    many times."""
    reference, seconds = whole(name, f"--checkpoints={EVERY}")
    killing.make(tmp_path, states=reference.parent / "states")
    draw = random.Random(name)
    for _ in range(2 if name == "CD" else 1):
        if not killing.kill_at(tmp_path, ROWS[name], draw.uniform(0.4, 1) * seconds, f"--checkpoints={EVERY}"):
            break
    path, _ = killing.whole(tmp_path, ROWS[name], f"--checkpoints={EVERY}")
    assert killing.differences(reference, path) == []
    assert sorted(p.name for p in tmp_path.iterdir()) == [".locks", path.name, "states"]


def test_what_a_killed_run_left_half_written_is_removed(whole, tmp_path):
    """Unfinished files beside checkpoint and result are removed; those of another run stay."""
    reference, _ = whole("drum", f"--checkpoints={EVERY}")
    killing.make(tmp_path, states=reference.parent / "states")
    for name in (f"{reference.stem}.checkpoint.zip.7758.new", f"{reference.stem}.h5.7758.new", "other.h5.7758.new"):
        (tmp_path / name).write_bytes(b"half")
    path, _ = killing.whole(tmp_path, ROWS["drum"], f"--checkpoints={EVERY}")
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted([".locks", path.name, "other.h5.7758.new", "states"])


def test_a_run_goes_on_from_its_checkpoint(whole, tmp_path):
    """Killed after its first checkpoint, the run resumes and says so; its file counts the interruptions."""
    reference, _ = whole("CD", f"--checkpoints={EVERY}")
    killing.make(tmp_path, states=reference.parent / "states")
    process = killing.start(tmp_path, ROWS["CD"], f"--checkpoints={EVERY}")
    while not (found := list(tmp_path.glob("*.checkpoint.zip"))):
        assert process.poll() is None
    process.kill()
    process.communicate()
    assert len(found) == 1
    again = killing.start(tmp_path, ROWS["CD"], f"--checkpoints={EVERY}")
    said, _ = again.communicate(timeout=1200)
    assert "continues from its checkpoint at sample" in said, said
    path = killing.only_result(tmp_path)
    with h5py.File(path) as file:
        assert file.attrs["resumed"] == 1 and file.attrs["checkpoint_samples"] == EVERY
        assert (np.diff(file["history/wall_clock"][:]) > 0).all()
    assert killing.differences(reference, path) == []


# What passing through save and load changes at all, over the largest |gamma|. Forces: the order of the sums, round-off of 1e-16 a step that grains in
# motion enlarge. The servo loses its wall stiffness and its last step, which it makes up for at once; this loading, 20 times faster than a slow
# one, shows it best.
@pytest.mark.parametrize("name, bound", [("MD_force", 1e-9), ("CD", 1e-9), ("MD_servo", 1e-2)])
def test_checkpoints_change_next_to_nothing(whole, name, bound):
    with h5py.File(whole(name, f"--checkpoints={EVERY}")[0]) as through, h5py.File(whole(name, "--checkpoints=0")[0]) as plain:
        gammas = [file["history/gamma"][:] for file in (through, plain)]
    assert abs(gammas[0] - gammas[1]).max() <= bound * abs(gammas[1]).max()


def test_a_full_disk_loses_nothing(whole, tmp_path):
    """Files are limited to 100 kB, enough for checkpoints but not for the result: the run says so, and finishes once there is room again."""
    reference, _ = whole("CD", f"--checkpoints={EVERY}")
    killing.make(tmp_path, states=reference.parent / "states")
    arguments = [f"{name}={value}" for name, value in ROWS["CD"].items()]
    done = subprocess.run(["prlimit", "--fsize=100000", "yade", "-n", "-x", "-j", "1", str(killing.SCRIPTS / "run.py"), f"--results={tmp_path}",
                           f"--checkpoints={EVERY}", *arguments], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=1200)
    assert done.returncode == 1 and re.search(r"File too large: '.*\.h5'; correct this and start it again", done.stderr)
    killing.check_what_is_left(tmp_path)
    assert killing.only_result(tmp_path) is None
    path, _ = killing.whole(tmp_path, ROWS["CD"], f"--checkpoints={EVERY}")
    assert killing.differences(reference, path) == []


@pytest.fixture
def checkpoints(O, tmp_path):
    """Where a small scene's checkpoints would be."""
    from yade_scripts import scenes
    from yade_scripts.running import checkpoint
    full = parameters.complete({"scene": "bounce"})
    return checkpoint.Checkpoints(tmp_path / "run.h5", full, scenes.Scene(every=1, samples=1, kept={}), 4)


def write(checkpoints, **origin):
    """A checkpoint's file with empty parts."""
    import zipfile
    with zipfile.ZipFile(checkpoints.path, "w") as archive:
        archive.writestr("scene.yade", b"s" * 100)
        archive.writestr("record.h5", b"r" * 100)
        archive.writestr("memory.json", json.dumps({"origin": json.loads(json.dumps(checkpoints.origin | origin))}))


@pytest.mark.parametrize("origin", [{"git_commit": "other"}, {"yade_version": "2024"}, {"state_sha256": "f"}, {"samples_between": 5},
                                    {"parameters": {}}])
def test_a_checkpoint_of_something_else_is_turned_down(checkpoints, capsys, origin):
    write(checkpoints)
    assert checkpoints.found()["scene.yade"] == b"s" * 100
    write(checkpoints, **origin)
    assert checkpoints.found() is None
    said = capsys.readouterr().err
    assert next(iter(origin)) in said and "from the beginning" in said


def test_damaged_checkpoints_are_turned_down(checkpoints):
    """Cut at every length, or with one byte changed, a checkpoint gives the parts as written, or none."""
    write(checkpoints)
    sound, content = checkpoints.path.read_bytes(), checkpoints.found()
    draw = random.Random(1)
    for length in range(0, len(sound), 7):
        checkpoints.path.write_bytes(sound[:length])
        assert checkpoints.found() is None
    for _ in range(1000):
        bad = bytearray(sound)
        bad[draw.randrange(len(bad))] = draw.randrange(256)
        checkpoints.path.write_bytes(bad)
        assert checkpoints.found() in (None, content)


def test_published_runs_are_too_short_for_checkpoints():
    """No published number depends on a checkpoint, but for those of the flows named below, of 6400 disks and of many cycles: disks times steps
    of every row of every study, with MD's steps from its smallest possible disk."""
    import math

    from analysis import studies
    from yade_scripts.running import checkpoint
    for name in studies.names():
        if name in ("larger_flows", "many_disks"):
            continue  # means over chaotic motion, whose single bits have no meaning
        for full in studies.rows(name, False) + studies.rows(name, True):
            if name == "size" and full["disks"] == 6400 or name == "long_cycles":
                continue  # too large or too long for anything else; their checkpoints come at fixed samples, so that they can be run again
            mass = full["density"] * math.pi * (full["radius_mean"] * (1 - full["radius_spread"]))**2 * full["depth"]
            dt = full["cd_dt"] if full["method"] == "CD" else full["md_dt_factor"] * math.sqrt(mass / parameters.stiffness(full))
            steps = math.ceil(full["period"] / full["records_per_cycle"] / dt) * full["records_per_cycle"] * full["cycles"]
            assert full["disks"] * steps < checkpoint.INTERVAL[full["method"]], (name, results.path_of(full))


def test_a_long_run_has_checkpoints():
    from yade_scripts import scenes
    from yade_scripts.running import checkpoint
    full = parameters.complete({"disks": 10000})
    scene = scenes.Scene(every=100, samples=100000, kept={})
    assert checkpoint.samples_between(full, scene) == 2000
    assert checkpoint.samples_between(full, scenes.Scene(every=100, samples=1000, kept={})) == 0
    assert checkpoint.samples_between(full, scenes.Scene(every=100, samples=100000)) == 0
