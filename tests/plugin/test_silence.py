"""Settings and objects that the engine cannot handle are refused, or warned of once, with the remedy."""
import pytest
import yade
from yade import utils, wrapper

import cd_engine
from cd_engine import engine_methods
from yade_scripts.running import hooks

from . import plane, programs


@pytest.mark.parametrize("reduce", [True, False])
def test_two_disks_with_the_same_centre(O, capfd, reduce):
    """No direction leads from one to the other: the step is refused, or these two do not push each other, which is told."""
    plane.disk_on_a_floor(handover=False, reduce=reduce)
    plane.disk((0, 0.01), 0.01, mat=O.bodies[1].mat)
    plane.disk((0.05, 0.01), 0.01, mat=O.bodies[1].mat)
    try:
        O.run(1, True)
        assert "bodies #1 and #2 overlap by 0.02 m" in (said := capfd.readouterr().err) and "Move them apart" in said
    except RuntimeError as error:
        assert "disks with the same centre" in str(error)
    assert tuple(O.bodies[3].state.pos) == (0.05, 0.01, 0)


def said_by(O, capfd, steps=3):
    O.run(steps, True)
    return [line for line in capfd.readouterr().err.splitlines() if line.startswith("ContactDynamics: ")]


def test_settings_that_make_energy_together(O, capfd):
    plane.disk_on_a_floor(restitution=0.1, gapCorrection=0.1, gapVelocity=True)
    line, = said_by(O, capfd)
    assert "restitution and gapCorrection with gapVelocity create energy" in line and "Set gapVelocity=False" in line
    O.engines[-1].gapVelocity = False
    assert said_by(O, capfd) == []


@pytest.mark.parametrize("make", [wrapper.CohFrictMat, wrapper.ViscElMat], ids=["cohesion", "damping"])
def test_materials_of_which_only_friction_is_used(O, capfd, make):
    plane.disk_on_a_floor()
    for body in O.bodies:
        body.mat = make(frictionAngle=0.3)
    line, = said_by(O, capfd)
    assert make.__name__ in line and "only the frictionAngle" in line and "is used" in line and "Body #0" in line


def test_a_fixed_disk_moved_by_its_position(O, capfd):
    plane.disk_on_a_floor()
    pusher = plane.disk((0.05, 0.01), 0.01, blocked="xyzXYZ")
    lines = []
    for _ in range(40):
        O.bodies[pusher].state.pos -= yade.Vector3(1e-3, 0, 0)
        lines += said_by(O, capfd, 1)
    line, = lines
    assert f"body #{pusher} is moved by its position" in line and f"O.bodies[{pusher}].state.vel" in line


def test_nothing_is_said_of_a_fixed_disk_that_harms_nobody(O, capfd):
    """One that touches nothing follows another; a further one is put elsewhere between long runs."""
    plane.disk_on_a_floor()
    marker, obstacle = plane.disk((0, 0.01), 0.01, blocked="xyzXYZ"), plane.disk((0.1, 0.01), 0.01, blocked="xyzXYZ")
    O.bodies[marker].bounded = False
    for _ in range(6):
        O.bodies[obstacle].state.pos += yade.Vector3(0.01, 0, 0)
        for _ in range(12):
            O.bodies[marker].state.pos += yade.Vector3(1e-4, 0, 0)
            assert said_by(O, capfd, 10) == []


def test_a_boundary_moved_by_its_position(O, capfd):
    """Reported once, though it then overlaps bodies. One or two moves may be a restart, and a boundary with a velocity moves by itself."""
    reset, collider, cd = plane.disk_on_a_floor()
    wall = plane.box((0.03, 0.02), (0.005, 0.02), mat=0)
    places = [0.03, 0.03, 0.029, 0.029, 0.028, 0.027, 0.026, 0.02, 0.015, 0.01]

    def place():
        O.bodies[wall].state.pos = (places[min(O.iter, len(places) - 1)], 0.02, 0)

    O.engines = [reset, hooks.runner(place, iterPeriod=1, initRun=True), collider, cd]
    O.dt = 1e-3
    assert said_by(O, capfd, 5) == []
    line, = said_by(O, capfd, 10)
    assert f"body #{wall} is moved by its position" in line and f"O.bodies[{wall}].state.vel" in line


def test_overlaps_that_no_springs_have_left(O, capfd):
    """They are kept, with a warning; overlaps from springs are kept without one (test_handover)."""
    plane.columns(0, disks=1)
    plane.disk((0, 0.0292), 0.01)
    plane.engine(gravity=(0, -9.81, 0))
    line, = said_by(O, capfd)
    assert "bodies #1 and #2 overlap by 0.08" in line and "handover=False" in line
    assert O.bodies[2].state.pos[1] == pytest.approx(0.0292, abs=1e-9)
    assert "were there at the start" in engine_methods.text(O.engines[-1])


def test_the_deepest_of_the_overlaps_at_the_start_is_named(O, capfd):
    plane.floor()
    for x, overlap in ((0, 0.0005), (0.1, 0.0015), (0.2, 0.001)):
        plane.disk((x, 0.01), 0.01)
        plane.disk((x, 0.03 - overlap), 0.01)
    plane.engine(gravity=(0, -9.81, 0))
    line, = said_by(O, capfd)
    assert "bodies #3 and #4 overlap by 0.15" in line
    O.bodies[2].state.pos = (0, 0.025, 0)
    O.bodies[6].state.pos = (0.2, 0.024, 0)
    O.engines = cd_engine.engines(gravity=(0, -9.81, 0))
    with pytest.raises(RuntimeError, match="bodies #5 and #6 overlap by 0.6"):
        O.run(1, True)


def test_a_disk_appended_into_another_is_no_matter_of_the_step(O, capfd):
    plane.disk_on_a_floor()
    assert said_by(O, capfd) == []
    plane.disk((0.0, 0.0295), 0.01)
    line, = said_by(O, capfd)
    assert "overlap" in line and "bodies were put there" in line and "O.dt" not in line


def test_steps_in_which_a_disk_goes_many_radii(O, capfd):
    """Told of once, with the body and what proposes a step."""
    plane.columns(0, disks=1)
    plane.disk((0.02, 0.3), 0.01, velocity=(0, -5))
    plane.engine(0.02, gravity=(0, -9.81, 0))
    line, = [line for line in said_by(O, capfd, 3) if "times its radius" in line]
    assert "body #2 moves 10" in line and "cd_engine.timeStep()" in line


@pytest.mark.parametrize("ways, told", [((2.5, 2.5), True), ((1.9, 1.9), False), ((3, -9), False), ((9, -3), True), ((9, -9), False)])
def test_two_disks_that_pass_each_other(O, capfd, ways, told):
    """It counts how far they move relative to each other: they may fly side by side, or meet head on. All ways are in radii a step."""
    mat, dt = plane.material(), 1e-3
    for k, way in enumerate(ways):
        plane.disk((0.08 * k, 0), 0.01, velocity=((1 - 2 * k) * way * 0.01 / dt, 0), mat=mat)
    plane.engine(dt)
    assert any("and may jump over it" in line for line in said_by(O, capfd, 1)) == told


@pytest.mark.parametrize("name, said", [("tolerence", "Did you mean tolerance"), ("damping", "see restitution"), ("es", "`restitution`"),
                                        ("friction", "FrictMat"), ("dt", "O.dt"), ("xyzzy", "help")])
@pytest.mark.parametrize("make", [cd_engine.engines, cd_engine.ContactDynamics])
def test_misspelt_names(make, name, said):
    with pytest.raises(AttributeError, match=said):
        make(**{name: 1})


def test_the_default_step_of_yade(O, capfd):
    plane.disk_on_a_floor(1e-8)
    line, = said_by(O, capfd)
    assert "O.dt is 1e-8 s" in line and "1e-3" in line


@pytest.mark.parametrize("dt, told", [(1e-6, True), (1e-4, False)])
def test_a_step_for_springs(O, capfd, dt, told):
    """Told of at the first step. Steps that are merely short, as for a comparison, are not."""
    plane.disk_on_a_floor(dt)
    lines = said_by(O, capfd)
    assert len(lines) == told and all(f"O.dt is {dt:g} s: a disk needs at least 3192" in line and "timeStep()" in line for line in lines), lines


@pytest.mark.parametrize("thickness", [0, 0.01])
def test_plates_that_cross_from_the_beginning_go_on_to(O, capfd, thickness):
    """Those of aabbWalls do, and gravity moves the upper one down between the others."""
    mat = plane.material(0)
    plates = O.bodies.append(utils.aabbWalls([(0, 0, -0.5), (0.3, 0.3, 0.5)], thickness=thickness, material=mat))
    plane.grid(25, 5, (0.03, 0.03), (0.06, 0.06), mat=mat)
    O.bodies[plates[3]].state.mass, O.bodies[plates[3]].state.blockedDOFs = 10, "xzXYZ"
    plane.engine(gravity=(0, -9.81, 0))
    assert said_by(O, capfd) == []


def test_a_boundary_that_gravity_moves(O, capfd):
    """A free Box over a Wall: neither touches the other, and it falls through."""
    plane.disk_on_a_floor()
    box = plane.box((1, 0.1), (0.1, 0.1), blocked="zXY")
    line, = said_by(O, capfd)
    assert f"body #{box} is a boundary that gravity moves" in line and "through body #0" in line


def test_a_box_that_reaches_into_the_floor_is_told_of(O, capfd):
    """It will fall on through it, as one that stands above it would."""
    plane.box((0, -0.05), (1, 0.05))
    plane.disk((0.5, 0.01), 0.01)
    box = plane.box((0, 0.06), (0.1, 0.1), blocked="xzXYZ")
    plane.engine(gravity=(0, -9.81, 0))
    line, = said_by(O, capfd)
    assert f"body #{box} is a boundary that gravity moves" in line and "through body #0" in line


@pytest.mark.parametrize("load", [50, 5000])
def test_a_lid_that_disks_carry_is_not_told_of(O, capfd, load):
    """Without the disks the larger load would move this lid by 50 mm in a step; the floor is 2 mm away."""
    plane.floor()
    for k in range(10):
        plane.disk((0.002 * k, 0.001), 0.001, mass=0.008)
    lid = plane.box((0.009, 0.004), (0.01, 0.002), blocked="xzXYZ", mass=0.1)
    plane.engine(gravity=(0, -9.81, 0))
    O.forces.setPermF(lid, (0, -load, 0))
    assert said_by(O, capfd) == []


def test_a_lid_that_a_force_moves_through_the_floor_in_a_step(O, capfd):
    """No disk is near it, so it is told of before the only search that comes in time."""
    plane.floor()
    plane.disk((1, 0.001), 0.001)
    lid = plane.box((0, 0.06), (0.03, 0.002), blocked="xzXYZ", mass=0.1)
    plane.engine()
    O.forces.setPermF(lid, (0, -5000, 0))
    line, = said_by(O, capfd)
    assert f"body #{lid} is a boundary that its velocity or a force moves" in line


def test_a_scene_that_falls_as_a_whole(O, capfd):
    """All bodies got the freedoms of disks."""
    plane.box((0, -0.01), (0.1, 0.01))
    plane.disk((0, 0.01), 0.01)
    plane.engine(gravity=(0, -9.81, 0))
    for body in O.bodies:
        body.state.blockedDOFs = "zXY"
        body.state.mass = 1
    line, = said_by(O, capfd)
    assert "gravity moves every boundary, such as body #0" in line and "blockedDOFs='xyzXYZ'" in line


def test_fixed_disks_hold_a_scene(O, capfd):
    """Nothing is said of a lid that lies on them."""
    for k in range(3):
        plane.disk((0.02 * k, 0.01), 0.01, blocked="xyzXYZ")
    plane.box((0.02, 0.03), (0.1, 0.01), blocked="xzXYZ")
    plane.engine(gravity=(0, -9.81, 0))
    assert said_by(O, capfd) == []


@pytest.mark.parametrize("push", [lambda box: yade.O.forces.setPermF(box, (0, -10, 0)),
                                  lambda box: setattr(yade.O.bodies[box].state, "vel", (0, -1, 0))],
                         ids=["force", "velocity"])
def test_a_boundary_that_something_else_moves(O, capfd, push):
    """It is told of before they meet."""
    plane.disk_on_a_floor(gravity=(0, 0, 0))
    box = plane.box((1, 0.13), (0.1, 0.1), blocked="xzXYZ")
    push(box)
    lines = said_by(O, capfd, 300)
    assert any(f"body #{box} is a boundary that its velocity or a force moves" in line and "through body #0" in line for line in lines)


def test_two_boundaries_that_pass_through_each_other_are_told_of_once(O, capfd):
    """Not again when the one that was above is below."""
    plane.disk_on_a_floor()
    lid = plane.box((0, 0.03), (0.1, 0.01), blocked="xzXYZ")
    above = plane.box((0, 0.06), (0.05, 0.005), blocked="xzXYZ")
    line, = [line for line in said_by(O, capfd, 300) if "is a boundary" in line]
    assert f"body #{above} " in line and f"through body #{lid}" in line
    assert yade.O.bodies[above].state.pos[1] < yade.O.bodies[lid].state.pos[1]


def test_nothing_is_said_of_a_piston_with_clearance(O, capfd):
    """It enters between two side walls and touches neither."""
    plane.disk_on_a_floor(gravity=(0, 0, 0))
    for x in (1, 1.4):
        plane.box((x, 0.3), (0.1, 0.2))
    piston = plane.box((1.2, 0.61), (0.099, 0.1), blocked="xzXYZ")
    O.bodies[piston].state.vel = (0, -1, 0)
    assert not said_by(O, capfd, 150)


def test_nothing_is_said_of_a_lid_that_disks_hold(O, capfd):
    """The lid also touches side walls."""
    plane.disk_on_a_floor()
    for k in range(3):
        plane.disk((1.1 + 0.2 * k, 0.1), 0.1)
    plane.box((1.3, 0.25), (0.3, 0.05), blocked="xzXYZ")
    for x in (0.9, 1.7):
        plane.box((x, 0.5), (0.1, 0.5))
    assert said_by(O, capfd) == []


def test_nothing_is_said_of_a_wall_as_a_lid_between_walls(O, capfd):
    """Each Wall is endless along itself, and these cross at right angles."""
    plane.disk_on_a_floor()
    for x in (-0.1, 0.1):
        O.bodies.append(utils.wall(x, axis=0, material=0))
    lid = O.bodies.append(utils.wall(0.02, axis=1, material=0))
    O.bodies[lid].state.mass, O.bodies[lid].state.blockedDOFs = 1, "xzXYZ"
    assert said_by(O, capfd, 50) == []
    assert O.bodies[lid].state.pos[1] == pytest.approx(0.02, abs=1e-5)


def test_nothing_is_said_of_a_scene_that_is_well(O, capfd):
    plane.disk_on_a_floor()
    O.bodies.append(utils.wall(-1, axis=0, material=0))
    assert said_by(O, capfd) == []


def test_importing_it_makes_its_classes_known(tmp_path):
    """A scene with the engine is loaded after the import alone."""
    path = tmp_path / "scene.yade.gz"
    for task in (f"O.engines = cd_engine.engines(tolerance=1e-5); O.save({str(path)!r})", f"O.load({str(path)!r}); print(O.engines[-1].tolerance)"):
        done = programs.in_python("import yade, cd_engine; from yade import O; " + task)
        assert done.returncode == 0, done.stderr
    assert "1e-05" in done.stdout


def test_summary_says_how_it_went(O, capsys):
    cd = plane.disk_on_a_floor()[-1]
    cd.summary()
    assert "No step yet" in capsys.readouterr().out
    O.run(5, True)
    cd.summary()
    out = capsys.readouterr().out
    assert len(out.splitlines()) == 4 and "All 5 steps: 0 missed" in out and "1 contacts, 1 loaded" in out
