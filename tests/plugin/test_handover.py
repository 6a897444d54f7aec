"""From springs to rigid contacts: without a change of load nothing may move."""
import json

import pytest

import cd_engine

from . import plane, programs

SCRIPT = """
import json
from yade import O
import cd_engine
from yade_scripts import parameters
from yade_scripts.preparing import prepare
from yade_scripts.running import bodies, walls

full = parameters.complete({})
path, _ = prepare.ensure(full, ".")
P0 = parameters.pressure(full)

def start(**settings):
    O.load(str(path))
    walls.set_free(full["wall_mass_ratio"] * bodies.mean_mass())
    area_x, area_y = walls.areas()
    O.forces.setPermF(walls.X_HIGH, (-P0 * area_x, 0, 0))
    O.forces.setPermF(walls.Y_HIGH, (0, -P0 * area_y, 0))
    O.dt = 1e-3
    O.engines = cd_engine.engines(**settings)
    return O.engines[-1]

def forces():
    return {(i.id1, i.id2): i.phys.normalForce.norm() for i in O.interactions if i.isReal}

said = {}
cd = start(tolerance=1e-8)
# By hand: YADE does not save ScGeom.penetrationDepth.
disks = {b.id: b for b in bodies.disks()}
said["overlap"] = max(disks[i.id1].shape.radius + disks[i.id2].shape.radius - (disks[i.id1].state.pos - disks[i.id2].state.pos).norm()
                      for i in O.interactions if i.isReal and i.id1 in disks and i.id2 in disks)
md, before = forces(), walls.sides()
O.run(1, True)
said["first sweeps"], said["handover overlap"] = cd.iterations, cd.handoverOverlap
now = forces()
said["same contacts"] = set(now) == set(md)
said["force change"] = max(abs(now[k] - md[k]) for k in now) / max(md.values())
O.run(999, True)
after = walls.sides()
said["drift"] = after[1] / before[1] - after[0] / before[0]
said["penetration"], said["unconverged"], said["references"] = cd.maxPenetration, cd.unconvergedSteps, len(cd._referenceOverlaps)

cd = start(tolerance=1e-8, warmStart=False)
O.run(1, True)
said["cold sweeps"] = cd.iterations

cd = start(tolerance=1e-8, handover=False)
O.run(1, True)
said["penetration without handover"] = cd.maxPenetration

cd = start(tolerance=1e-8)
O.run(1, True)
O.forces.setPermF(walls.X_HIGH, (1, 0, 0))  # let go: the packing opens
O.forces.setPermF(walls.Y_HIGH, (0, 1, 0))
speed = max(b.state.vel.norm() for b in O.bodies)
O.run(200, True)
said["references when let go"], said["speed of grains when let go"] = len(cd._referenceOverlaps), max(b.state.vel.norm() for b in bodies.disks())
print("said", json.dumps(said))
"""


@pytest.fixture(scope="module")
def said(tmp_path_factory):
    """What a run of SCRIPT measured on the default packing of 400 disks."""
    folder = tmp_path_factory.mktemp("handover")
    done = programs.in_yade(folder, SCRIPT)
    lines = [line for line in done.stdout.splitlines() if line.startswith("said")]
    assert lines, done.stderr
    return json.loads(lines[0][5:])


def test_overlaps_become_the_reference(said):
    assert said["handover overlap"] == pytest.approx(said["overlap"], rel=0.2) and said["overlap"] > 1e-6  # contacts with walls overlap, too
    assert said["penetration"] < 1e-4 * said["overlap"]
    assert said["penetration without handover"] == pytest.approx(said["handover overlap"], rel=1e-3)


def test_springs_forces_are_the_first_guess(said):
    """The packing is in equilibrium to 1e-8, so the first step finds its solution in the scene; a cold start has to work for it."""
    assert said["same contacts"]
    assert said["first sweeps"] <= 8 < 100 < said["cold sweeps"]
    assert said["force change"] < 1e-6


def test_a_thousand_steps_at_constant_load_drift_less_than_1e_9(said):
    assert said["unconverged"] == 0
    assert abs(said["drift"]) < 1e-9, said


def test_overlaps_are_not_expelled_when_the_load_goes(said):
    """The elastic energy belongs to the springs: unloaded rigid grains do not fly apart, and separated pairs forget their overlap."""
    assert said["speed of grains when let go"] < 1e-3  # the spring energy would give sqrt(k/m) overlap = 0.05 m/s
    assert said["references when let go"] < said["references"]


def test_springs_take_over_after_release(O):
    """A stack under CD, then under YADE's springs: it sinks by the springs' own compression and no further."""
    ids, = plane.columns(0, disks=5)
    plane.run(50, 1e-4, gravity=(0, -9.81, 0), tolerance=1e-10)
    cd_engine.release()
    O.engines, O.dt = plane.springs(damping=0.3), 1e-4
    O.run(3000, True)
    lowest = O.interactions[ids[0], 5] if O.interactions.has(ids[0], 5) else O.interactions[0, ids[0]]
    assert lowest.phys.normalForce.norm() == pytest.approx(5 * 9.81, rel=0.05)
    assert 0.01 - O.bodies[ids[0]].state.pos[1] == pytest.approx(5 * 9.81 / lowest.phys.kn, rel=0.05)
