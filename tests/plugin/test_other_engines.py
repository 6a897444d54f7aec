"""Lists of engines that the engine cannot work with are refused, with the remedy."""
import pytest
import yade
import yade.system
from yade import wrapper

import cd_engine
from yade_scripts.running import hooks

from . import plane


@pytest.mark.parametrize("engine, said", [
    (lambda: wrapper.ForceEngine(ids=[1], force=(1, 0, 0)), r"ForceEngine stands after ContactDynamics.*Put it between"),
    (lambda: wrapper.HarmonicForceEngine(ids=[1], A=(1, 0, 0), f=(1, 0, 0)), r"HarmonicForceEngine stands after ContactDynamics"),
    (lambda: wrapper.RadialForceEngine(ids=[1]), r"RadialForceEngine stands after ContactDynamics"),
    (lambda: wrapper.GravityEngine(gravity=(0, -9.81, 0)), r"GravityEngine stands after ContactDynamics.*Remove it"),
    (lambda: wrapper.GlobalStiffnessTimeStepper(), r"GlobalStiffnessTimeStepper sets O\.dt by the stiffness.*dead=True"),
    (lambda: wrapper.TriaxialStressController(), r"TriaxialStressController moves walls.*cd_engine\.PlateLoads"),
    (lambda: wrapper.ServoPIDController(ids=[1]), r"ServoPIDController moves walls.*cd_engine\.PlateLoads"),
    (wrapper.NewtonIntegrator, "second time"), (wrapper.InteractionLoop, "spring forces"), (wrapper.ParallelEngine, "hides the engines in it"),
    (lambda: cd_engine.ContactDynamics(), "second time"), (wrapper.ElasticContactLaw, "ElasticContactLaw may write to contacts.*dead=True"),
    (wrapper.CohesiveFrictionalContactLaw, "may write to contacts"), (lambda: wrapper.LawDispatcher([]), "may write to contacts"),
    (lambda: wrapper.IGeomDispatcher([]), "may write to contacts"),
], ids=["force", "harmonic force", "radial force", "gravity", "time step", "triaxial", "servo", "integrator", "loop", "parallel", "another", "law",
        "cohesive law", "laws", "geometries"])
def test_engines_that_do_not_go_with_it(O, engine, said):
    O.engines = plane.disk_on_a_floor() + [engine()]
    with pytest.raises(RuntimeError, match=said):
        O.run(1, True)
    O.engines[-1].dead = True
    O.run(1, True)


@pytest.mark.parametrize("engine", [wrapper.GlobalStiffnessTimeStepper, wrapper.TriaxialStressController, lambda: wrapper.ServoPIDController(ids=[1]),
                                    wrapper.NewtonIntegrator, wrapper.InteractionLoop], ids=["time step", "triaxial", "servo", "integrator", "loop"])
@pytest.mark.parametrize("go", [lambda O: O.run(1, True), lambda O: O.run(1), lambda O: O.step()], ids=["run", "background", "step"])
def test_they_are_refused_before_they_run(O, engine, go):
    """Also where they stand before ContactDynamics: what YADE says of some of them there would not help."""
    reset, collider, cd = plane.disk_on_a_floor()
    O.engines = [engine(), reset, collider, cd]
    with pytest.raises(RuntimeError, match="^ContactDynamics: .*Remove it"):
        go(O)
    assert O.iter == 0


@pytest.mark.parametrize("fault", ["refused", "failed"])
def test_a_new_list_after_an_error_in_a_step(O, fault):
    """YADE keeps a list that is set in the middle of a step for the next one, and an error leaves the step in its middle."""
    plane.disk_on_a_floor()
    if fault == "refused":
        O.bodies[1].state.mass = -1
    else:
        O.engines = O.engines + [wrapper.PyRunner(command="1/0", iterPeriod=1)]
    with pytest.raises(RuntimeError):
        O.run(3, True)
    O.bodies[1].state.mass = 1
    O.engines = cd_engine.engines(gravity=(0, -9.81, 0))
    O.run(5, True)
    assert O.engines[-1].steps >= 4 and O.engines[-1].converged


def test_gravity_of_two_engines(O):
    """GravityEngine alone is fine."""
    reset, collider, cd = plane.disk_on_a_floor()
    O.engines = [reset, collider, wrapper.GravityEngine(gravity=(1, 0, 0)), cd]
    with pytest.raises(RuntimeError, match=r"both GravityEngine and the attribute `gravity`.*gravity=\(0, 0, 0\)"):
        O.run(1, True)
    cd.gravity = (0, 0, 0)
    O.run(10, True)
    assert O.bodies[1].state.vel[0] == pytest.approx(1 * 10 * 1e-3)
    cd.gravity = (0, -9.81, 0)
    with pytest.raises(RuntimeError, match="would weigh twice"):
        O.run(1, True)


def test_the_same_engine_twice(O):
    reset, collider, cd = plane.disk_on_a_floor()
    O.engines = [reset, collider, cd, cd]
    with pytest.raises(RuntimeError, match="it stands twice in O.engines"):
        O.run(1, True)


# All engines of YADE 2023.02a, 2025.2.0 and 2026.1.0. What they do to a scene stands in cd_engine/yade_plugin/other_engines.cpp.
ENGINES = set("""
    AxialGravityEngine BicyclePedalEngine BoundDispatcher BoundaryController BoxFactory CapillarityEngine CapillaryStressRecorder
    CentralConstantAccelerationEngine CircularFactory CohesiveFrictionalContactLaw Collider CombinedKinematicEngine CpmStateUpdater
    Disp2DPropLoadEngine Dispatcher DomainLimiter DragEngine ElasticContactLaw FEInternalForceEngine FacetTopologyAnalyzer FieldApplier
    FlatGridCollider FlowEngine FlowEngineT FlowEngine_PeriodicInfo FoamCoupling ForceEngine ForceRecorder ForceResetter
    GeneralIntegratorInsertionSortCollider GlBoundDispatcher GlIGeomDispatcher GlIPhysDispatcher GlShapeDispatcher GlStateDispatcher GlobalEngine
    GlobalStiffnessTimeStepper GravityEngine HarmonicForceEngine HarmonicMotionEngine HarmonicRotationEngine HdapsGravityEngine HelixEngine
    HydroForceEngine HydrodynamicsLawLBM IGeomDispatcher IPhysDispatcher InsertionSortCollider Integrator InteractionLoop InternalForceDispatcher
    InterpolatingDirectedForceEngine InterpolatingHelixEngine KinemCNDEngine KinemCNLEngine KinemCNSEngine KinemCTDEngine KinemSimpleShearBox
    KinematicEngine Law2_ScGeom_CapillaryPhys_Capillarity LawDispatcher LawTester LinearDragEngine LubricationPDFEngine MeasureCapStress
    MicroMacroAnalyser NewtonIntegrator PDFEngine ParallelEngine PartialEngine PartialSatClayEngine PartialSatClayEngineT Peri3dController
    PeriIsoCompressor PeriTriaxController PeriodicEngine PeriodicFlowEngine PolyhedraSplitter PotentialParticleVTKRecorder PyRunner RadialForceEngine
    Recorder ResetRandomPosition RotationEngine RungeKuttaCashKarp54Integrator SegmentedMatSprinkler SegmentedStateUpdater ServoPIDController
    SnapshotEngine SpatialQuickSortCollider SpheresFactory SplitPolyMohrCoulomb SplitPolyTauMax StepDisplacer TesselationWrapper TetraVolumetricLaw
    ThermalEngine ThreeDTriaxialEngine TimeAverager TimeStepper TorqueEngine TorqueRecorder TranslationEngine TriaxialCompressionEngine
    TriaxialStateRecorder TriaxialStressController TwoPhaseFlowEngine TwoPhaseFlowEngineT UniaxialStrainer UnsaturatedEngine VESupportEngine
    VTKRecorder
""".split())
CRASH = {"MicroMacroAnalyser"}  # where nothing has been set


def test_every_engine_is_refused_or_leaves_the_forces(O, tmp_path, monkeypatch):
    """Of two disks on the floor one is pressed by 1000 N. A new release may have an engine that this file does not list: look whether it writes to
    interactions, and name it here, and in other_engines.cpp if it does not."""
    names = yade.system.childClasses("Engine") - set(cd_engine.ENGINES)
    assert names <= ENGINES
    monkeypatch.chdir(tmp_path)  # recorders write files
    refused = set()
    for name in sorted(names - CRASH):
        O.reset()
        O.engines = plane.disk_on_a_floor() + [getattr(wrapper, name)()]
        plane.disk((0.1, 0.01), 0.01, mat=O.bodies[1].mat)
        O.forces.setPermF(1, (0, -1000, 0))
        O.dt = 1e-3
        try:
            O.run(2, True)
        except RuntimeError as error:
            refused |= {name} if str(error).startswith("ContactDynamics") else set()  # others cannot work with nothing set
            continue
        forces = [O.interactions[0, i].phys.normalForce.norm() for i in (1, 2)]
        assert forces == pytest.approx([1009.81, 9.81], rel=1e-6), name
    assert {"LawDispatcher", "ElasticContactLaw", "CohesiveFrictionalContactLaw"} <= refused
    assert not {"PyRunner", "VTKRecorder", "SpheresFactory", "TranslationEngine", "DomainLimiter"} & refused


def test_forces_that_are_cleared_at_once(O):
    O.engines = [wrapper.ForceEngine(ids=[1], force=(1, 0, 0))] + plane.disk_on_a_floor()
    with pytest.raises(RuntimeError, match="ForceEngine stands before ForceResetter.*Put it between"):
        O.run(1, True)


@pytest.mark.parametrize("go", [lambda O: O.run(1, True), lambda O: O.step()], ids=["run", "step"])
def test_lists_at_which_yade_would_end(O, go, capfd):
    """YADE stops the whole process where an engine in a ParallelEngine throws, and its collider asks for an integrator that is not needed."""
    reset, collider, cd = plane.disk_on_a_floor()
    O.engines = [reset, collider, wrapper.ParallelEngine([cd])]
    with pytest.raises(RuntimeError, match="ContactDynamics stands in a ParallelEngine.*into O.engines itself"):
        go(O)
    O.engines = [reset, collider, wrapper.ParallelEngine([cd_engine.DashpotWork()])]
    with pytest.raises(RuntimeError, match="DashpotWork stands in a ParallelEngine"):
        go(O)
    far_looking = wrapper.InsertionSortCollider([wrapper.Bo1_Sphere_Aabb(), wrapper.Bo1_Wall_Aabb()], verletDist=0.001)
    O.engines = [reset, far_looking, cd]
    with pytest.raises(RuntimeError, match="give it verletDist=0"):
        go(O)
    O.engines = [reset, far_looking, cd, wrapper.NewtonIntegrator(dead=True)]
    go(O)
    assert cd.steps == 1
    assert "a NewtonIntegrator stands dead in O.engines" in capfd.readouterr().err


@pytest.mark.parametrize("path", ["run", "step", "loaded"])
def test_springs_on_contacts_that_have_no_stiffness(O, tmp_path, path):
    """However ContactDynamics came to leave them: by O.run, by O.step, or in a file that is loaded when springs have run last."""
    plane.disk_on_a_floor()
    O.run(10, True)
    O.save(str(tmp_path / "rigid.yade.gz"))
    if path == "step":
        O.step()
    elif path == "loaded":
        cd_engine.release()
        O.engines = plane.springs()
        O.run(1, True)
        O.load(str(tmp_path / "rigid.yade.gz"))
    O.engines = plane.springs()
    for go in (lambda: O.run(1, True), O.step):
        with pytest.raises(RuntimeError, match="no stiffness.*cd_engine.release()"):
            go()
    cd_engine.release()
    O.dt = 1e-5
    O.run(100, True)
    assert O.interactions[0, 1].phys.kn > 0


def test_springs_that_an_engine_of_a_run_sets(O):
    reset, collider, cd = plane.disk_on_a_floor()
    O.run(5, True)

    def change():
        O.engines = plane.springs()

    O.engines = [reset, collider, cd, hooks.runner(change, iterPeriod=1)]
    with pytest.raises(RuntimeError, match="springs cannot take over from ContactDynamics within a run.*cd_engine.release"):
        hooks.simulate(5)
    assert type(O.engines[2]).__name__ == "ContactDynamics"


def test_springs_set_at_the_console_of_a_run(O):
    plane.disk_on_a_floor()
    O.run()
    try:
        with pytest.raises(RuntimeError, match="springs cannot take over from ContactDynamics within a run"):
            O.engines = plane.springs()
    finally:
        O.pause()
    cd_engine.release()
    O.engines = plane.springs()
    assert len(O.engines) == 4


def test_springs_of_a_soft_material_are_its_own(O):
    """Young's modulus 0 gives contacts without stiffness as well, and they are meant so."""
    plane.disk_on_a_floor()
    O.bodies[1].material = wrapper.FrictMat(young=0, poisson=0.3)
    cd_engine.release()
    O.engines = plane.springs()
    O.dt = 1e-5
    O.run(2, True)
    O.engines = plane.springs()
    O.run(2, True)
    assert O.interactions[0, 1].phys.kn == 0


def test_forces_before_it_act(O):
    reset, collider, cd = plane.disk_on_a_floor()
    O.engines = [reset, collider, wrapper.ForceEngine(ids=[1], force=(3, 0, 0)), cd]
    O.materials[0].frictionAngle = 0
    O.run(10, True)
    assert O.bodies[1].state.vel[0] == pytest.approx(3 * 10 * 1e-3)


def test_an_engine_that_moves_bodies_after_it_is_told(O, capfd):
    """Its motion comes a step late. Before ContactDynamics it is welcome."""
    for after in False, True:
        O.reset()
        reset, collider, engine = plane.disk_on_a_floor()
        drive = wrapper.HarmonicMotionEngine(ids=[0], A=(0, 1e-3, 0), f=(0, 5, 0), fi=(0, 0, 0))
        O.engines = [reset, collider, engine, drive] if after else [reset, collider, drive, engine]
        O.run(5, True)
        said = capfd.readouterr().err
        assert said.count("HarmonicMotionEngine stands after ContactDynamics in O.engines, so the motion that it sets comes a step late.") == after


def test_lists_that_are_none(O):
    with pytest.raises(TypeError, match=r"engines is a function; call it: engines\(\)"):
        O.engines = cd_engine.engines
    with pytest.raises(TypeError, match=r"a list in the list; join lists of engines by \+"):
        O.engines = [cd_engine.engines(), wrapper.PyRunner()]
    O.engines = (*cd_engine.engines(), wrapper.PyRunner(command="pass"))
    assert len(O.engines) == 4
