"""A lid presses on disks in a box: which force reaches the floor?

    yade yade_scripts/examples/loaded_box.py                       with YADE's window or console at the end; -n -x: without
    yade yade_scripts/examples/loaded_box.py disks=100 springs=1   another size; YADE's springs instead of Contact Dynamics
    yade-batch TABLE yade_scripts/examples/loaded_box.py           the rows of a table with columns disks, springs, load, seconds

The lid is a Box that is free to move up and down; its load is a permanent force on it. There is no gravity. loaded_box.png shows the forces in
the box, loaded_box-height.png the height of the lid; loaded_box-*.vtk hold disks and forces for Paraview, loaded_box.yade.gz the last
state. To load it elsewhere, import cd_engine and define what the PyRunners below use, call O.load, and set the permanent force again.
"""
import math, pathlib, random, sys, time
file = sys._getframe().f_code.co_filename  # YADE sets no __file__
if locals() is not globals():
    sys.exit(f"write execfile({file!r}, globals()): without globals() the functions of a script do not find its names")
sys.path.insert(0, str(pathlib.Path(file).resolve().parents[2]))  # this clone; not needed after `make install`
import cd_engine
from yade import export, plot

settings = dict(disks=300, springs=0, load=10.0, seconds=1.5)
for word in sys.argv[1:]:
    name, _, value = word.partition("=")
    try:
        settings[name] = type(settings[name])(value)
    except (KeyError, ValueError):
        sys.exit(f"{word}: write name=number as in disks=100; the names are {', '.join(settings)}")
readParamsFromTable(noTableOk=True, **settings)
from yade.params.table import disks, springs, load, seconds                                # load [N]
if not (isinstance(disks, int) and disks >= 1 and springs in (0, 1)
        and all(isinstance(value, (int, float)) and 0.1 <= value < 1e9 for value in (load, seconds))):
    sys.exit(f"disks={disks}, springs={springs}, load={load}, seconds={seconds}: disks must be a whole number of at least 1, springs 0 or 1, "
             "load and seconds at least 0.1")
name = f"loaded_box-{O.tags['d.id']}" if runningInBatch() else "loaded_box"  # of the files written: every row of a table has its own

draw = random.Random(1).uniform                                                            # YADE reseeds the common generator for colours
radius, row = 0.005, max(5, round(math.sqrt(disks)))                                      # m; disks in a row
half, height = 1.1 * radius * row, 2.2 * radius * math.ceil(disks / row)                  # of the box [m]
O.materials.append(FrictMat(young=1e7, poisson=0.3, density=2600, frictionAngle=math.atan(0.3), label="grains"))
O.materials.append(FrictMat(young=1e7, poisson=0.3, density=2600, frictionAngle=0, label="smooth"))  # so that the side walls carry none of the load
for side in (-1, 1):
    O.bodies.append(box((side * (half + 0.01), height / 2, 0), (0.01, height, 0.1), fixed=True, material="smooth"))
floor = O.bodies.append(box((0, -0.01, 0), (half, 0.01, 0.1), fixed=True, material="smooth"))
lid = O.bodies.append(box((0, height + 0.01, 0), (half, 0.01, 0.1), material="smooth"))
for k in range(disks):
    disk = sphere((2.2 * radius * (k % row + 0.5) - half + draw(-0.05, 0.05) * radius, 2.2 * radius * (k // row + 0.5), 0), radius * draw(0.8, 1),
                  material="grains")
    disk.state.blockedDOFs = "zXY"                                                        # kept in the plane
    O.bodies.append(disk)
O.bodies[lid].state.blockedDOFs = "xzXYZ"
O.bodies[lid].state.mass = sum(b.state.mass for b in O.bodies if isinstance(b.shape, Sphere))
O.forces.setPermF(lid, (0, -load, 0))

if springs:
    O.engines = [
        ForceResetter(),
        InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Box_Aabb()]),
        InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Box_Sphere_ScGeom()], [Ip2_FrictMat_FrictMat_MindlinPhys(en=0.3, es=0.3)],
                        [Law2_ScGeom_MindlinPhys_Mindlin()]),
        NewtonIntegrator(damping=0),
    ]
    O.dt = 0.5 * PWaveTimeStep()
else:
    O.engines = cd_engine.engines()
    O.dt = cd_engine.timeStep(speed=math.sqrt(load * height / O.bodies[lid].state.mass))  # as if load times height became kinetic energy
O.engines = O.engines + [
    PyRunner(command="plot.addData(t=O.time, height=O.bodies[lid].state.pos[1], floor=-O.forces.f(floor)[1])", virtPeriod=0.01),
    PyRunner(command="draw_in_space()", virtPeriod=0.25 * seconds),
]
space = export.VTKExporter(name)  # Debian's VTKRecorder reads uninitialized memory and crashes some runs


def draw_in_space():
    space.exportSpheres(what={"speed": "b.state.vel.norm()"})
    space.exportInteractions(what={"force": "i.phys.normalForce.norm()"})


plot.plots = {"t": ("height", None, "floor")}

start = time.time()
O.run(int(seconds / O.dt), True)
plot.plot(noShow=True).savefig(f"{name}-height.png")
cd_engine.picture(f"{name}.png")
last = plot.data["floor"][-20:]
print(f"the floor carries {sum(last) / len(last):.4g} N of {load:g} N; the net vertical force on the lid is {O.forces.f(lid)[1]:.2g} N; "
      f"{time.time() - start:.1f} s of computing, O.dt = {O.dt:.2g} s")
O.save(f"{name}.yade.gz")
