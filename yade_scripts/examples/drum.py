"""A drum half full of disks turns: how steep is the surface?

    yade yade_scripts/examples/drum.py                       with YADE's window or console at the end; -n -x: without
    yade yade_scripts/examples/drum.py disks=100 springs=1   another size; YADE's springs instead of Contact Dynamics
    yade yade_scripts/examples/drum.py film=1                with a film of the run, drum.gif
    yade-batch TABLE yade_scripts/examples/drum.py           the rows of a table with columns disks, springs, seconds, film

The drum is a ring of boxes that YADE's RotationEngine turns. Like every engine that moves or pushes bodies it stands before ContactDynamics.
drum.png shows the disks, half of each shaded, and the forces between them; drum-slope.png the slope against time. It swings, and the
mean over 2 s differs by some degrees from one start to the next. drum-*.vtk hold the disks for Paraview, drum.yade.gz the last state.
To load it elsewhere, import cd_engine and define what the PyRunners below use, then call O.load.
"""
import math, pathlib, random, sys, time
file = sys._getframe().f_code.co_filename  # YADE sets no __file__
if locals() is not globals():
    sys.exit(f"write execfile({file!r}, globals()): without globals() the functions of a script do not find its names")
sys.path.insert(0, str(pathlib.Path(file).resolve().parents[2]))  # this clone; not needed after `make install`
import cd_engine
from yade import export, plot

settings = dict(disks=200, springs=0, seconds=4.0, film=0)
for word in sys.argv[1:]:
    name, _, value = word.partition("=")
    try:
        settings[name] = type(settings[name])(value)
    except (KeyError, ValueError):
        sys.exit(f"{word}: write name=number as in disks=100; the names are {', '.join(settings)}")
readParamsFromTable(noTableOk=True, **settings)
from yade.params.table import disks, springs, seconds, film
if not (isinstance(disks, int) and disks >= 1 and isinstance(seconds, (int, float)) and 0.1 <= seconds < 1e9 and {springs, film} <= {0, 1}):
    sys.exit(f"disks={disks}, springs={springs}, seconds={seconds}, film={film}: disks must be a whole number of at least 1, springs and film 0 or "
             "1, seconds at least 0.1")
name = f"drum-{O.tags['d.id']}" if runningInBatch() else "drum"  # of the files written: every row of a table has its own

draw = random.Random(1).uniform                                                            # YADE reseeds the common generator for colours
radius, gravity, spin, sides = 0.005, (0, -9.81, 0), 1.0, 32                              # m, m/s^2, rad/s
inner = radius * math.sqrt(2.4 * disks)                                                   # inner radius [m] of a drum that the disks fill by half
O.materials.append(FrictMat(young=1e7, poisson=0.3, density=2600, frictionAngle=math.atan(0.5), label="grains"))
drum, half = [], (0.02 * inner, 1.04 * inner * math.tan(math.pi / sides), 0.1)            # half sides of a box of the ring
for k in range(sides):
    angle = 2 * math.pi * k / sides
    drum.append(O.bodies.append(box((1.02 * inner * math.cos(angle), 1.02 * inner * math.sin(angle), 0), half,
                                    orientation=Quaternion((0, 0, 1), angle), fixed=True, material="grains")))
places = [(2.2 * radius * i, 2.2 * radius * j) for j in range(-50, 50) for i in range(-50, 50)]
places = [place for place in places if math.hypot(*place) < inner - 1.5 * radius]
for x, y in places[:disks]:                                                               # from the bottom row upwards
    disk = sphere((x + draw(0, 0.1 * radius), y, 0), radius * draw(0.85, 1), material="grains")
    disk.state.blockedDOFs = "zXY"                                                        # kept in the plane
    O.bodies.append(disk)
grains = [b for b in O.bodies if isinstance(b.shape, Sphere)]


def slope():
    """Return the slope of the bed [degrees]. The drum is half full, so the normal of the surface runs from the bed's centre of mass to the axis."""
    mass = sum(b.state.mass for b in grains)
    x, y = (sum(b.state.mass * b.state.pos[axis] for b in grains) / mass for axis in (0, 1))
    return math.degrees(math.atan2(x, -y))


turn = RotationEngine(ids=drum, rotationAxis=(0, 0, 1), angularVelocity=spin, rotateAroundZero=True, zeroPoint=(0, 0, 0))
if springs:
    O.engines = [
        ForceResetter(),
        InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Box_Aabb()]),
        InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Box_Sphere_ScGeom()], [Ip2_FrictMat_FrictMat_MindlinPhys(en=0.3, es=0.3)],
                        [Law2_ScGeom_MindlinPhys_Mindlin()]),
        turn,
        NewtonIntegrator(gravity=gravity, damping=0),
    ]
    O.dt = 0.5 * PWaveTimeStep()
else:
    reset, collider, contact_dynamics = cd_engine.engines(gravity=gravity, tolerance=1e-3, gapCorrection=0.1)  # without it: overlaps of 0.05 radii
    O.engines = [reset, collider, turn, contact_dynamics]
    O.dt = cd_engine.timeStep(speed=0.5)                                                  # [m/s], of disks that roll down the surface
space = export.VTKExporter(name)  # Debian's VTKRecorder reads uninitialized memory and crashes some runs
O.engines = O.engines + [PyRunner(command="plot.addData(t=O.time, slope=slope())", virtPeriod=0.02),
                         PyRunner(command="space.exportSpheres()", virtPeriod=0.25 * seconds)]
if film:
    O.engines = O.engines + [cd_engine.film(f"{name}.gif", every=0.05)]
plot.plots = {"t": "slope"}

start = time.time()
O.run(int(seconds / O.dt), True)
plot.plot(noShow=True).savefig(f"{name}-slope.png")
cd_engine.picture(f"{name}.png")
last = plot.data["slope"][len(plot.data["slope"]) // 2:]
inside = sum(b.state.pos.norm() < inner for b in grains)
print(f"slope of the surface: {sum(last) / len(last):.0f} degrees (mean over the second half, in which it swings from {min(last):.0f} to "
      f"{max(last):.0f}); {inside} of {disks} disks in the drum; {time.time() - start:.1f} s of computing, O.dt = {O.dt:.2g} s")
O.save(f"{name}.yade.gz")
