"""The prepared packing: the same in every process, at rest, under its load, and the same start for both methods."""
import hashlib
import json

import pytest

from yade_scripts.results import schema


def test_same_inputs_give_the_same_file_in_another_process(yade60, yade_elsewhere):
    (one, _), (other, _) = yade60.prepare("disks=60"), yade_elsewhere.prepare("disks=60")
    assert one.name == other.name
    assert one.read_bytes() == other.read_bytes()


def test_packing_is_at_rest_under_its_load(yade60):
    """Wall stress at P0 and forces in balance, recomputed by one step of the engines from the loaded file."""
    _, record = yade60.prepare("disks=60")
    assert record["sigma"] == pytest.approx([1200, 1200], rel=1e-7)
    # A dense disordered packing of hard disks; 60 of them leave gaps at the walls.
    assert 0.75 < record["solid_fraction"] < 0.86 and 3 < record["contacts_per_disk"] < 4.5
    found = yade60.code("""
from yade import O, utils
from yade_scripts import run
from yade_scripts.running import walls
run.start(method="MD", disks=60)
speed = max(b.state.vel.norm() + b.state.angVel.norm() for b in O.bodies)
O.run(1, True)
print(json.dumps({"speed": speed, "stress": walls.stresses(), "unbalanced": utils.unbalancedForce()}))
""")
    assert found["speed"] == 0
    assert [s for pair in found["stress"] for s in pair] == pytest.approx([1200] * 4, rel=1e-6)
    assert found["unbalanced"] < 1e-7


def test_damaged_file_is_prepared_again(yade_elsewhere):
    state, _ = yade_elsewhere.prepare("disks=20")
    whole = state.read_bytes()
    state.write_bytes(whole[:-100])
    done = yade_elsewhere.script("preparing/prepare.py", "disks=20")
    assert done.returncode == 0 and "does not match its record" in done.stderr
    assert state.read_bytes() == whole


def test_a_packing_of_other_inputs_is_not_taken(tmp_path, capsys):
    """A file that somebody has renamed, with its record; or of another YADE, whose version is one of the inputs."""
    from yade_scripts.preparing import prepare
    path = tmp_path / "a.yade.gz"
    path.write_bytes(b"scene")
    path.with_name("a.json").write_text(json.dumps({"sha256": hashlib.sha256(b"scene").hexdigest(), "inputs": {"seed": 2}}))
    assert prepare._verified(path, {"seed": 2}) and prepare._verified(path, {"seed": 1}) is None
    assert "of another packing" in capsys.readouterr().err


def test_a_packing_with_gravity_is_refused(yade60):
    done = yade60.script("preparing/prepare.py", "scene=stack")
    assert done.returncode == 2 and "prepare: gravity = 9.81: packings are prepared without gravity: set gravity = 0" in done.stderr


def test_a_packing_that_finds_no_rest_says_so(yade_elsewhere):
    text = yade_elsewhere.code("""
from yade_scripts import parameters
from yade_scripts.preparing import prepare
prepare.MOST_STEPS = 600
try:
    prepare.ensure(parameters.complete({"disks": 20}), "results")
except prepare.PreparationError as error:
    print(json.dumps([str(error)]))
""")[0]
    assert "no rest after 600 steps" in text and "wall stress off by" in text
    assert not list((yade_elsewhere.folder / "results" / "states").glob("*.gz"))


def test_md_and_cd_start_from_the_same_bits(yade60):
    """Positions, radii, forces and walls of the first snapshots, and the state's SHA-256. Their files follow the schema."""
    md, cd = (yade60.run(method=method, period=0.02, records_per_cycle=2) for method in ("MD", "CD"))
    for file in (md, cd):
        assert schema.problems(file) == [] and file.attrs["status"] == "finished" and file.attrs["finished"]
        assert file["history/time"][:] == pytest.approx([0, 0.01, 0.02], abs=1e-12) and len(file["snapshots"]) == 3
    _, record = yade60.prepare("disks=60")
    assert md.attrs["state_sha256"] == cd.attrs["state_sha256"] == record["sha256"]
    for name in ("position", "angle", "radius", "body_ids", "box"):
        assert md[f"snapshots/0/{name}"][:].tobytes() == cd[f"snapshots/0/{name}"][:].tobytes(), name
    # MD's first sample follows its force loop, which computes the loaded forces anew from the same overlaps.
    assert (md["snapshots/0/contact_ids"][:] == cd["snapshots/0/contact_ids"][:]).all()
    assert md["snapshots/0/force_normal"][:] == pytest.approx(cd["snapshots/0/force_normal"][:], rel=1e-6)
