"""A plate presses on spheres in a box and is lifted again: the oedometric test of YADE's tutorial.

    yade yade_scripts/examples/oedometer.py                         with YADE's window or console at the end; -n -x: without
    yade yade_scripts/examples/oedometer.py spheres=100 springs=1   another size; YADE's springs instead of Contact Dynamics
    yade-batch TABLE yade_scripts/examples/oedometer.py             the rows of a table with columns spheres, springs, load

The spheres fall into a box of facets and come to rest; then a plate (a Wall) goes down at 0.1 m/s until it carries the load [kN], and up until it
carries a hundredth of it. Contacts have the springs of the material in both methods, since rigid grains would not yield: Contact Dynamics solves them
implicitly, in longer steps. oedometer.png shows the spheres under the load, oedometer-force.png the force on the plate against its way;
oedometer-*.vtk hold spheres, contacts and facets for Paraview, oedometer.yade.gz the state under the load. From that state both methods then run for
a moment, and their costs are printed.
"""
import pathlib, sys, time
file = sys._getframe().f_code.co_filename  # YADE sets no __file__
if locals() is not globals():
    sys.exit(f"write execfile({file!r}, globals()): without globals() the functions of a script do not find its names")
sys.path.insert(0, str(pathlib.Path(file).resolve().parents[2]))  # this clone; not needed after `make install`
import cd_engine
from yade import export, geom, pack, plot

settings = dict(spheres=400, springs=0, load=100.0)
for word in sys.argv[1:]:
    name, _, value = word.partition("=")
    try:
        settings[name] = type(settings[name])(value)
    except (KeyError, ValueError):
        sys.exit(f"{word}: write name=number as in spheres=100; the names are {', '.join(settings)}")
readParamsFromTable(noTableOk=True, **settings)
from yade.params.table import spheres, springs, load                                       # load [kN]
if not (isinstance(spheres, int) and spheres >= 20 and isinstance(load, (int, float)) and 1 <= load < 1e4 and springs in (0, 1)):
    sys.exit(f"spheres={spheres}, springs={springs}, load={load}: spheres must be a whole number of at least 20, springs 0 or 1, load from 1 to 1e4")
name = f"oedometer-{O.tags['d.id']}" if runningInBatch() else "oedometer"  # of the files written: every row of a table has its own

gravity, radius = (0, 0, -9.81), 0.05 * (400 / spheres)**(1 / 3)                           # m/s^2, mean radius [m]: they fill a half of the box
O.materials.append(FrictMat(young=1e8, poisson=0.3, density=1000, frictionAngle=0.5, label="grains"))
O.bodies.append(geom.facetBox((0.5, 0.5, 0.5), (0.5, 0.5, 0.5), wallMask=31, material="grains"))
cloud = pack.SpherePack()
cloud.makeCloud((0, 0, 0), (1, 1, 1), rMean=radius, rRelFuzz=0.3, num=spheres, seed=1)
cloud.toSimulation(material="grains")
grains = [b.id for b in O.bodies if isinstance(b.shape, Sphere)]


def set_engines(springs):
    """Set the engines and the time step of YADE's springs or of Contact Dynamics. Both have springs of the same stiffness."""
    if springs:
        O.engines = [
            ForceResetter(),
            InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Facet_Aabb(), Bo1_Wall_Aabb()]),
            InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Facet_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom()],
                            [Ip2_FrictMat_FrictMat_FrictPhys()], [Law2_ScGeom_FrictPhys_CundallStrack()]),
            NewtonIntegrator(gravity=gravity, damping=0.5),
        ]
        O.dt = 0.5 * PWaveTimeStep()
    else:
        O.engines = cd_engine.engines(gravity=gravity, materialStiffness=True)
        O.dt = cd_engine.timeStep(speed=2)                                                # [m/s], of spheres that fall into the box


def observe():
    """Record the way of the plate [mm] and the force on it [kN]. Pause where it carries its load, and where it has been lifted from it."""
    state, force = O.bodies[plate].state, O.forces.f(plate)[2] / 1000
    plot.addData(way=1000 * (top - state.pos[2]), force=force)
    if force > load if state.vel[2] < 0 else force < 0.01 * load:
        O.pause()


def wait_for_rest():
    if O.time > 0.6 and unbalancedForce() < 0.1 or O.time > 3:
        O.pause()


def draw_in_space():
    space.exportSpheres(), space.exportFacets(), space.exportInteractions(what={"force": "i.phys.normalForce.norm()"})


set_engines(springs)
space = export.VTKExporter(name)  # Debian's VTKRecorder reads uninitialized memory and crashes some runs
plot.plots = {"way": "force"}
start = time.process_time()
observer = PyRunner(command="wait_for_rest()", virtPeriod=0.02)
O.engines = O.engines + [observer]
O.run(), O.wait()
draw_in_space()
top = max(O.bodies[i].state.pos[2] + O.bodies[i].shape.radius for i in grains)
plate = O.bodies.append(wall(top, axis=2, sense=-1, material="grains"))
O.bodies[plate].state.vel = (0, 0, -0.1)
observer.command, observer.virtPeriod = "observe()", 2e-3
O.run(), O.wait()
pressed = O.bodies[plate].state.pos[2]
cd_engine.picture(f"{name}.png", colour="force", forces=True)
draw_in_space()
O.save(f"{name}.yade.gz")
O.bodies[plate].state.vel = (0, 0, 0.1)
O.run(), O.wait()
draw_in_space()
plot.plot(noShow=True).savefig(f"{name}-force.png")
print(f"under {load:g} kN the plate is at {pressed:.3f} m, after unloading at {O.bodies[plate].state.pos[2]:.3f} m; {spheres} spheres; "
      f"{time.process_time() - start:.1f} s of computing, O.dt = {O.dt:.2g} s")

cost = []
for springy in 0, 1:
    O.load(f"{name}.yade.gz")
    set_engines(springy)
    O.bodies[plate].state.vel = (0, 0, 0.1)
    O.run(10, True)
    begun, start = O.time, time.process_time()
    O.run(int(0.1 / O.dt), True)
    cost.append((time.process_time() - start) / (O.time - begun))
print(f"a second of the scene from {name}.yade.gz on takes {cost[0]:.3g} s of computing by Contact Dynamics, {cost[1]:.3g} s by springs")
