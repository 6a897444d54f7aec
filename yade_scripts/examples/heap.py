"""A column of disks is released on a rough floor and comes to rest as a heap. The scene is saved and loaded again.

    yade yade_scripts/examples/heap.py                       with YADE's window or console at the end; -n -x: without
    yade yade_scripts/examples/heap.py disks=100 springs=1   another size; YADE's springs instead of Contact Dynamics
    yade-batch TABLE yade_scripts/examples/heap.py           the rows of a table with columns disks, springs, seconds

heap.png shows the heap with the forces in it, heap-energy.png the kinetic energy against time; heap-*.vtk hold the disks for Paraview,
heap.yade.gz the scene at rest.
"""
import math, pathlib, random, sys, time
file = sys._getframe().f_code.co_filename  # YADE sets no __file__
if locals() is not globals():
    sys.exit(f"write execfile({file!r}, globals()): without globals() the functions of a script do not find its names")
sys.path.insert(0, str(pathlib.Path(file).resolve().parents[2]))  # this clone; not needed after `make install`
import cd_engine
from yade import export, plot

settings = dict(disks=300, springs=0, seconds=1.5)
for word in sys.argv[1:]:
    name, _, value = word.partition("=")
    try:
        settings[name] = type(settings[name])(value)
    except (KeyError, ValueError):
        sys.exit(f"{word}: write name=number as in disks=100; the names are {', '.join(settings)}")
readParamsFromTable(noTableOk=True, **settings)
from yade.params.table import disks, springs, seconds
if not (isinstance(disks, int) and disks >= 1 and isinstance(seconds, (int, float)) and 0.1 <= seconds < 1e9 and springs in (0, 1)):
    sys.exit(f"disks={disks}, springs={springs}, seconds={seconds}: disks must be a whole number of at least 1, springs 0 or 1, seconds at least 0.1")
name = f"heap-{O.tags['d.id']}" if runningInBatch() else "heap"  # of the files written: every row of a table has its own

draw = random.Random(1).uniform                                                            # YADE reseeds the common generator for colours
radius, gravity, friction = 0.005, (0, -9.81, 0), 0.5                                     # m, m/s^2, coefficient
wide = max(4, round(math.sqrt(disks / 2)))                                                # disks in a row; the column is about twice as high as wide
O.materials.append(FrictMat(young=1e7, poisson=0.3, density=2600, frictionAngle=math.atan(friction), label="grains"))
floor = 8 * wide                                                                          # number of spaces between fixed disks that make it rough
for k in range(floor + 1):
    O.bodies.append(sphere((2 * radius * (k - floor / 2), 0, 0), radius, fixed=True, material="grains"))
for side in (-1, 1):                                                                      # side walls, so that no disk rolls away
    O.bodies.append(box((side * radius * (floor + 2), 4 * radius, 0), (radius, 5 * radius, 0.1), fixed=True, material="grains"))
for k in range(disks):
    disk = sphere((2.1 * radius * (k % wide - wide / 2) + draw(0, 0.1 * radius), 2.2 * radius * (1 + k // wide), 0), radius * draw(0.8, 1),
                  material="grains")
    disk.state.blockedDOFs = "zXY"                                                        # kept in the plane
    O.bodies.append(disk)


def slope():
    """Return the slope of the heap [degrees]: that of an isosceles triangle of equal area (solid fraction 0.8) and mean height of the disks."""
    grains = [b for b in O.bodies if b.state.blockedDOFs == "zXY"]
    height = 3 * sum(b.state.pos[1] - radius for b in grains) / len(grains)
    return math.degrees(math.atan(height**2 / (sum(math.pi * b.shape.radius**2 for b in grains) / 0.8)))


if springs:
    O.engines = [
        ForceResetter(),
        InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Box_Aabb()]),
        InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Box_Sphere_ScGeom()], [Ip2_FrictMat_FrictMat_MindlinPhys(en=0.3, es=0.3)],
                        [Law2_ScGeom_MindlinPhys_Mindlin()]),
        NewtonIntegrator(gravity=gravity, damping=0),
    ]
    O.dt = 0.5 * PWaveTimeStep()
else:
    O.engines = cd_engine.engines(gravity=gravity)
    O.dt = cd_engine.timeStep()
space = export.VTKExporter(name)  # Debian's VTKRecorder reads uninitialized memory and crashes some runs
O.engines = O.engines + [PyRunner(command="plot.addData(t=O.time, energy=kineticEnergy())", virtPeriod=0.01),
                         PyRunner(command="space.exportSpheres()", virtPeriod=0.25 * seconds)]
plot.plots = {"t": "energy"}

start = time.time()
O.run(int(seconds / O.dt), True)
plot.plot(noShow=True).savefig(f"{name}-energy.png")
cd_engine.picture(f"{name}.png")
print(f"slope of the heap: {slope():.1f} degrees, friction angle {math.degrees(math.atan(friction)):.1f}; kinetic energy {kineticEnergy():.2g} J, "
      f"{max(plot.data['energy']):.2g} J at its largest; {time.time() - start:.1f} s of computing, O.dt = {O.dt:.2g} s")
O.save(f"{name}.yade.gz")
O.load(f"{name}.yade.gz")                                                                # elsewhere: first import cd_engine, make space and plot
O.run(100, True)
print(f"saved, loaded and 100 steps on: slope {slope():.1f} degrees, kinetic energy {kineticEnergy():.2g} J")
