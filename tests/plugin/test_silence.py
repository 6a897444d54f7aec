"""Settings and objects that the engine cannot handle are refused, or warned of once, with the remedy."""
import subprocess
import sys

import pytest
import yade
from yade import utils, wrapper

import cd_engine
from cd_engine import engine_methods
from yade_scripts.running import hooks

from . import plane


def one_disk(**settings):
    mat = plane.material()
    plane.floor(mat)
    plane.disk((0, 0.01), 0.01, mat=mat)
    return cd_engine.engines(gravity=(0, -9.81, 0), **settings)


@pytest.mark.parametrize("engine, said", [
    (lambda: wrapper.ForceEngine(ids=[1], force=(1, 0, 0)), r"ForceEngine stands after it.*Put it between"),
    (lambda: wrapper.HarmonicForceEngine(ids=[1], A=(1, 0, 0), f=(1, 0, 0)), r"HarmonicForceEngine stands after it"),
    (lambda: wrapper.RadialForceEngine(ids=[1]), r"RadialForceEngine stands after it"),
    (lambda: wrapper.GravityEngine(gravity=(0, -9.81, 0)), r"GravityEngine stands after it"),
    (lambda: wrapper.GlobalStiffnessTimeStepper(), r"GlobalStiffnessTimeStepper sets O\.dt by the stiffness.*dead=True"),
    (lambda: wrapper.TriaxialStressController(), r"TriaxialStressController moves walls.*O\.forces\.setPermF"),
    (lambda: wrapper.ServoPIDController(ids=[1]), r"ServoPIDController moves walls.*O\.forces\.setPermF"),
], ids=["force", "harmonic force", "radial force", "gravity", "time step", "triaxial", "servo"])
def test_engines_that_do_not_go_with_it(O, engine, said):
    O.engines = one_disk() + [engine()]
    O.dt = 1e-3
    with pytest.raises(RuntimeError, match=said):
        O.run(1, True)
    O.engines[-1].dead = True
    O.run(1, True)


@pytest.mark.parametrize("engine", [wrapper.GlobalStiffnessTimeStepper, wrapper.TriaxialStressController, lambda: wrapper.ServoPIDController(ids=[1]),
                                    wrapper.NewtonIntegrator, wrapper.InteractionLoop], ids=["time step", "triaxial", "servo", "integrator", "loop"])
@pytest.mark.parametrize("go", [lambda O: O.run(1, True), lambda O: O.run(1), lambda O: O.step()], ids=["run", "background", "step"])
def test_they_are_refused_before_they_run(O, engine, go):
    """Also where they stand before ContactDynamics: what YADE says of some of them there would not help."""
    reset, collider, cd = one_disk()
    O.engines, O.dt = [engine(), reset, collider, cd], 1e-3
    with pytest.raises(RuntimeError, match="^ContactDynamics: .*Remove it"):
        go(O)
    assert O.iter == 0


def test_gravity_of_two_engines(O):
    """GravityEngine alone is fine."""
    reset, collider, cd = one_disk()
    O.engines = [reset, collider, wrapper.GravityEngine(gravity=(1, 0, 0)), cd]
    O.dt = 1e-3
    with pytest.raises(RuntimeError, match=r"GravityEngine adds to the attribute `gravity`.*gravity=\(0, 0, 0\)"):
        O.run(1, True)
    cd.gravity = (0, 0, 0)
    O.run(10, True)
    assert O.bodies[1].state.vel[0] == pytest.approx(1 * 10 * 1e-3)
    cd.gravity = (0, -9.81, 0)
    with pytest.raises(RuntimeError, match="would weigh twice"):
        O.run(1, True)


def test_the_same_engine_twice(O):
    reset, collider, cd = one_disk()
    O.engines, O.dt = [reset, collider, cd, cd], 1e-3
    with pytest.raises(RuntimeError, match="it stands twice in O.engines"):
        O.run(1, True)


@pytest.mark.parametrize("reduce", [True, False])
def test_two_disks_with_the_same_centre(O, capfd, reduce):
    """No direction leads from one to the other: the step is refused, or these two do not push each other, which is told."""
    O.engines, O.dt = one_disk(handover=False, reduce=reduce), 1e-3
    plane.disk((0, 0.01), 0.01, mat=O.bodies[1].mat)
    plane.disk((0.05, 0.01), 0.01, mat=O.bodies[1].mat)
    try:
        O.run(1, True)
        assert "bodies #1 and #2 overlap by 0.02 m" in (said := capfd.readouterr().err) and "Move them apart" in said
    except RuntimeError as error:
        assert "disks with the same centre" in str(error)
    assert tuple(O.bodies[3].state.pos) == (0.05, 0.01, 0)


def test_a_result_cannot_be_set():
    engine = cd_engine.ContactDynamics()
    with pytest.raises(AttributeError, match="steps is a result and cannot be set"):
        engine.steps = 3


def test_forces_that_are_cleared_at_once(O):
    O.engines = [wrapper.ForceEngine(ids=[1], force=(1, 0, 0))] + one_disk()
    O.dt = 1e-3
    with pytest.raises(RuntimeError, match="ForceEngine stands before ForceResetter.*Put it between"):
        O.run(1, True)


@pytest.mark.parametrize("go", [lambda O: O.run(1, True), lambda O: O.step()], ids=["run", "step"])
def test_lists_at_which_yade_would_end(O, go):
    """YADE stops the whole process where an engine in a ParallelEngine throws, and its collider asks for an integrator that is not needed."""
    reset, collider, cd = one_disk()
    O.dt = 1e-3
    O.engines = [reset, collider, wrapper.ParallelEngine([cd])]
    with pytest.raises(RuntimeError, match="ParallelEngine.*into O.engines itself"):
        go(O)
    far_looking = wrapper.InsertionSortCollider([wrapper.Bo1_Sphere_Aabb(), wrapper.Bo1_Wall_Aabb()], verletDist=0.001)
    O.engines = [reset, far_looking, cd]
    with pytest.raises(RuntimeError, match="give it verletDist=0"):
        go(O)
    O.engines = [reset, far_looking, cd, wrapper.NewtonIntegrator(dead=True)]
    go(O)
    assert cd.steps == 1


def springs():
    return [wrapper.ForceResetter(), wrapper.InsertionSortCollider([wrapper.Bo1_Sphere_Aabb(), wrapper.Bo1_Wall_Aabb()]),
            wrapper.InteractionLoop([wrapper.Ig2_Wall_Sphere_ScGeom()], [wrapper.Ip2_FrictMat_FrictMat_FrictPhys()],
                                    [wrapper.Law2_ScGeom_FrictPhys_CundallStrack()]),
            wrapper.NewtonIntegrator(gravity=(0, -9.81, 0))]


@pytest.mark.parametrize("path", ["run", "step", "loaded"])
def test_springs_on_contacts_that_have_no_stiffness(O, tmp_path, path):
    """However ContactDynamics came to leave them: by O.run, by O.step, or in a file that is loaded when springs have run last."""
    O.engines = one_disk()
    O.dt = 1e-3
    O.run(10, True)
    O.save(str(tmp_path / "rigid.yade.gz"))
    if path == "step":
        O.step()
    elif path == "loaded":
        cd_engine.release()
        O.engines = springs()
        O.run(1, True)
        O.load(str(tmp_path / "rigid.yade.gz"))
    O.engines = springs()
    for go in (lambda: O.run(1, True), O.step):
        with pytest.raises(RuntimeError, match="no stiffness.*cd_engine.release()"):
            go()
    cd_engine.release()
    O.dt = 1e-5
    O.run(100, True)
    assert O.interactions[0, 1].phys.kn > 0


def test_springs_that_an_engine_of_a_run_sets(O):
    O.engines, O.dt = one_disk(), 1e-3
    reset, collider, cd = O.engines
    O.run(5, True)

    def change():
        O.engines = springs()

    O.engines = [reset, collider, cd, hooks.runner(change, iterPeriod=1)]
    with pytest.raises(RuntimeError, match="springs cannot take over from ContactDynamics within a run.*cd_engine.release"):
        hooks.simulate(5)
    assert type(O.engines[2]).__name__ == "ContactDynamics"


def test_springs_set_at_the_console_of_a_run(O):
    O.engines, O.dt = one_disk(), 1e-3
    O.run()
    try:
        with pytest.raises(RuntimeError, match="springs cannot take over from ContactDynamics within a run"):
            O.engines = springs()
    finally:
        O.pause()
    cd_engine.release()
    O.engines = springs()
    assert len(O.engines) == 4


def test_springs_of_a_soft_material_are_its_own(O):
    """Young's modulus 0 gives contacts without stiffness as well, and they are meant so."""
    O.engines = one_disk()
    O.bodies[1].material = wrapper.FrictMat(young=0, poisson=0.3)
    cd_engine.release()
    O.engines = springs()
    O.dt = 1e-5
    O.run(2, True)
    O.engines = springs()
    O.run(2, True)
    assert O.interactions[0, 1].phys.kn == 0


def test_forces_before_it_act(O):
    reset, collider, cd = one_disk()
    O.engines = [reset, collider, wrapper.ForceEngine(ids=[1], force=(3, 0, 0)), cd]
    O.materials[0].frictionAngle = 0
    O.dt = 1e-3
    O.run(10, True)
    assert O.bodies[1].state.vel[0] == pytest.approx(3 * 10 * 1e-3)


def said_by(O, capfd, steps=3):
    O.run(steps, True)
    return [line for line in capfd.readouterr().err.splitlines() if line.startswith("ContactDynamics: ")]


def test_settings_that_make_energy_together(O, capfd):
    O.engines = one_disk(restitution=0.1, gapCorrection=0.1)
    O.dt = 1e-3
    line, = said_by(O, capfd)
    assert "restitution and gapCorrection together create energy" in line and "Set one of them to 0" in line
    O.engines[-1].gapCorrection = 0
    assert said_by(O, capfd) == []


@pytest.mark.parametrize("make", [wrapper.CohFrictMat, wrapper.ViscElMat], ids=["cohesion", "damping"])
def test_materials_of_which_only_friction_is_used(O, capfd, make):
    O.engines = one_disk()
    O.dt = 1e-3
    for body in O.bodies:
        body.mat = make(frictionAngle=0.3)
    line, = said_by(O, capfd)
    assert make.__name__ in line and "only the frictionAngle is used" in line and "Body #0" in line


def test_a_fixed_disk_moved_by_its_position(O, capfd):
    O.engines, O.dt = one_disk(), 1e-3
    pusher = plane.disk((0.05, 0.01), 0.01, blocked="xyzXYZ")
    lines = []
    for _ in range(40):
        O.bodies[pusher].state.pos -= yade.Vector3(1e-3, 0, 0)
        lines += said_by(O, capfd, 1)
    line, = lines
    assert f"body #{pusher} is moved by its position" in line and f"O.bodies[{pusher}].state.vel" in line


def test_a_boundary_moved_by_its_position(O, capfd):
    """Reported once, though it then overlaps bodies. One or two moves may be a restart, and a boundary with a velocity moves by itself."""
    reset, collider, cd = one_disk()
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
    mat = plane.material()
    plane.floor(mat)
    plane.disk((0, 0.01), 0.01, mat=mat)
    plane.disk((0, 0.0292), 0.01, mat=mat)
    O.engines = cd_engine.engines(gravity=(0, -9.81, 0))
    O.dt = 1e-3
    line, = said_by(O, capfd)
    assert "bodies #1 and #2 overlap by 0.08" in line and "handover=False" in line
    assert O.bodies[2].state.pos[1] == pytest.approx(0.0292, abs=1e-9)
    assert "were there at the start" in engine_methods.text(O.engines[-1])


def test_the_deepest_of_the_overlaps_at_the_start_is_named(O, capfd):
    mat = plane.material()
    plane.floor(mat)
    for x, overlap in ((0, 0.0005), (0.1, 0.0015), (0.2, 0.001)):
        plane.disk((x, 0.01), 0.01, mat=mat)
        plane.disk((x, 0.03 - overlap), 0.01, mat=mat)
    O.engines = cd_engine.engines(gravity=(0, -9.81, 0))
    O.dt = 1e-3
    line, = said_by(O, capfd)
    assert "bodies #3 and #4 overlap by 0.15" in line
    O.bodies[2].state.pos = (0, 0.025, 0)
    O.bodies[6].state.pos = (0.2, 0.024, 0)
    O.engines = cd_engine.engines(gravity=(0, -9.81, 0))
    with pytest.raises(RuntimeError, match="bodies #5 and #6 overlap by 0.6"):
        O.run(1, True)


def test_a_disk_appended_into_another_is_no_matter_of_the_step(O, capfd):
    O.engines = one_disk()
    O.dt = 1e-3
    assert said_by(O, capfd) == []
    plane.disk((0.0, 0.0295), 0.01)
    line, = said_by(O, capfd)
    assert "overlap" in line and "bodies were put there" in line and "O.dt" not in line


def test_steps_in_which_a_disk_goes_many_radii(O, capfd):
    """Told of once, with the body and what proposes a step."""
    mat = plane.material()
    plane.floor(mat)
    plane.disk((0, 0.01), 0.01, mat=mat)
    plane.disk((0.02, 0.3), 0.01, velocity=(0, -5), mat=mat)
    O.engines = cd_engine.engines(gravity=(0, -9.81, 0))
    O.dt = 0.02
    line, = [line for line in said_by(O, capfd, 3) if "times its radius" in line]
    assert "body #2 moves 10" in line and "cd_engine.timeStep()" in line


@pytest.mark.parametrize("name, said", [("tolerence", "Did you mean tolerance"), ("damping", "see restitution"), ("en", "`restitution`"),
                                        ("friction", "FrictMat"), ("dt", "O.dt"), ("xyzzy", "help")])
@pytest.mark.parametrize("make", [cd_engine.engines, cd_engine.ContactDynamics])
def test_misspelt_names(make, name, said):
    with pytest.raises(AttributeError, match=said):
        make(**{name: 1})


def test_a_misspelt_name_of_the_engines_for_springs():
    with pytest.raises(AttributeError, match="DashpotWork has no attribute 'wrok'. Did you mean work"):
        cd_engine.DashpotWork(wrok=1)


def test_the_default_step_of_yade(O, capfd):
    O.engines = one_disk()
    O.dt = 1e-8
    line, = said_by(O, capfd)
    assert "O.dt is 1e-8 s" in line and "1e-3" in line


@pytest.mark.parametrize("dt, told", [(1e-6, True), (1e-4, False)])
def test_a_step_for_springs(O, capfd, dt, told):
    """Told of at the first step. Steps that are merely short, as for a comparison, are not."""
    O.engines, O.dt = one_disk(), dt
    lines = said_by(O, capfd)
    assert len(lines) == told and all(f"O.dt is {dt:g} s: a disk needs at least 3192" in line and "timeStep()" in line for line in lines), lines


def test_a_boundary_that_gravity_moves(O, capfd):
    """A free Box over a Wall: neither touches the other, and it falls through."""
    O.engines = one_disk()
    O.dt = 1e-3
    box = plane.box((1, 0.1), (0.1, 0.1), blocked="zXY")
    line, = said_by(O, capfd)
    assert f"body #{box} is a boundary that gravity moves" in line and "through body #0" in line


def test_a_scene_that_falls_as_a_whole(O, capfd):
    """All bodies got the freedoms of disks."""
    mat = plane.material()
    plane.box((0, -0.01), (0.1, 0.01), mat=mat)
    plane.disk((0, 0.01), 0.01, mat=mat)
    O.engines, O.dt = cd_engine.engines(gravity=(0, -9.81, 0)), 1e-3
    for body in O.bodies:
        body.state.blockedDOFs = "zXY"
        body.state.mass = 1
    line, = said_by(O, capfd)
    assert "gravity moves every boundary, such as body #0" in line and "blockedDOFs='xyzXYZ'" in line


@pytest.mark.parametrize("push", [lambda box: yade.O.forces.setPermF(box, (0, -10, 0)),
                                  lambda box: setattr(yade.O.bodies[box].state, "vel", (0, -1, 0))],
                         ids=["force", "velocity"])
def test_a_boundary_that_something_else_moves(O, capfd, push):
    """It is told of before they meet."""
    O.engines = one_disk()
    O.engines[-1].gravity = (0, 0, 0)
    O.dt = 1e-3
    box = plane.box((1, 0.13), (0.1, 0.1), blocked="xzXYZ")
    push(box)
    lines = said_by(O, capfd, 300)
    assert any(f"body #{box} is a boundary that its velocity or a force moves" in line and "through body #0" in line for line in lines)


def test_nothing_is_said_of_a_piston_with_clearance(O, capfd):
    """It enters between two side walls and touches neither."""
    O.engines = one_disk()
    O.engines[-1].gravity = (0, 0, 0)
    O.dt = 1e-3
    for x in (1, 1.4):
        plane.box((x, 0.3), (0.1, 0.2))
    piston = plane.box((1.2, 0.61), (0.099, 0.1), blocked="xzXYZ")
    O.bodies[piston].state.vel = (0, -1, 0)
    assert not said_by(O, capfd, 150)


def test_nothing_is_said_of_a_lid_that_disks_hold(O, capfd):
    """The lid also touches side walls."""
    O.engines = one_disk()
    O.dt = 1e-3
    for k in range(3):
        plane.disk((1.1 + 0.2 * k, 0.1), 0.1)
    plane.box((1.3, 0.25), (0.3, 0.05), blocked="xzXYZ")
    for x in (0.9, 1.7):
        plane.box((x, 0.5), (0.1, 0.5))
    assert said_by(O, capfd) == []


def test_nothing_is_said_of_a_wall_as_a_lid_between_walls(O, capfd):
    """Each Wall is endless along itself, and these cross at right angles."""
    O.engines = one_disk()
    O.dt = 1e-3
    for x in (-0.1, 0.1):
        O.bodies.append(utils.wall(x, axis=0, material=0))
    lid = O.bodies.append(utils.wall(0.02, axis=1, material=0))
    O.bodies[lid].state.mass, O.bodies[lid].state.blockedDOFs = 1, "xzXYZ"
    assert said_by(O, capfd, 50) == []
    assert O.bodies[lid].state.pos[1] == pytest.approx(0.02, abs=1e-5)


def test_nothing_is_said_of_a_scene_that_is_well(O, capfd):
    O.engines = one_disk()
    O.dt = 1e-3
    O.bodies.append(utils.wall(-1, axis=0, material=0))
    assert said_by(O, capfd) == []


def test_importing_it_makes_its_classes_known(root, tmp_path):
    """A scene with the engine is loaded after the import alone."""
    path = tmp_path / "scene.yade.gz"
    program = (f"import glob, sys; sys.path[:0] = [{str(root)!r}, *glob.glob('/usr/lib/*/yade-double/py')]; "
               "import yade, cd_engine; from yade import O; ")
    for task in (f"O.engines = cd_engine.engines(tolerance=1e-5); O.save({str(path)!r})", f"O.load({str(path)!r}); print(O.engines[-1].tolerance)"):
        done = subprocess.run([sys.executable, "-c", program + task], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
    assert "1e-05" in done.stdout


def test_summary_says_how_it_went(O, capsys):
    O.engines = one_disk()
    O.dt = 1e-3
    cd = O.engines[-1]
    cd.summary()
    assert "No step yet" in capsys.readouterr().out
    O.run(5, True)
    cd.summary()
    out = capsys.readouterr().out
    assert len(out.splitlines()) == 4 and "All 5 steps: 0 missed" in out and "1 contacts, 1 loaded" in out
