"""A hopper runs empty: how many disks leave it in a second?

    yade yade_scripts/examples/hopper.py                       with YADE's window or console at the end; -n -x: without
    yade yade_scripts/examples/hopper.py disks=200 springs=1   another size; YADE's springs instead of Contact Dynamics
    yade-batch TABLE yade_scripts/examples/hopper.py           the rows of a table with columns disks, springs, seconds

The script removes disks that have left: a disk that falls for ever would get faster and faster. hopper.png shows the
disks and their forces after a fifth of the time, hopper-left.png the discharge; hopper-*.vtk hold the disks for Paraview, hopper.yade.gz
the last state. To load it elsewhere, import cd_engine and define what the PyRunners below use, then call O.load.
"""
import math, pathlib, random, sys, time
file = sys._getframe().f_code.co_filename  # YADE sets no __file__
if locals() is not globals():
    sys.exit(f"write execfile({file!r}, globals()): without globals() the functions of a script do not find its names")
sys.path.insert(0, str(pathlib.Path(file).resolve().parents[2]))  # this clone; not needed after `make install`
import cd_engine
from yade import export, plot

settings = dict(disks=600, springs=0, seconds=2.0)
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
name = f"hopper-{O.tags['d.id']}" if runningInBatch() else "hopper"  # of the files written: every row of a table has its own

draw = random.Random(1).uniform                                                            # YADE reseeds the common generator for colours
radius, opening, gravity = 0.005, 0.06, (0, -9.81, 0)                                     # m, m, m/s^2
O.materials.append(FrictMat(young=1e7, poisson=0.3, density=2600, frictionAngle=math.atan(0.4), label="grains"))
for side in (-1, 1):                                                                      # on either side a slope of 50 degrees and a wall above it
    turn, half = side * math.radians(50), 0.1
    O.bodies.append(box((side * (opening / 2 + half * math.cos(turn)), half * abs(math.sin(turn)), 0), (half, 0.001, 0.1),
                        orientation=Quaternion((0, 0, 1), turn), fixed=True, material="grains"))
    O.bodies.append(box((side * (opening / 2 + 2 * half * math.cos(turn)), 0.65, 0), (0.001, 0.5, 0.1), fixed=True, material="grains"))
for k in range(disks):                                                                    # loose rows of 24 disks above the opening
    disk = sphere((0.0115 * (k % 24 - 11.5) + draw(0, 0.001), 0.16 + 0.0115 * (k // 24), 0), radius * draw(0.9, 1), material="grains")
    disk.state.blockedDOFs = "zXY"                                                        # kept in the plane
    O.bodies.append(disk)

left = []                                                                                 # masses of the disks that have left


def record():
    for disk in [b for b in O.bodies if isinstance(b.shape, Sphere) and b.state.pos[1] < -0.1]:
        left.append(disk.state.mass)
        O.bodies.erase(disk.id)
    plot.addData(t=O.time, left=len(left))


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
O.engines = O.engines + [PyRunner(command="record()", virtPeriod=0.01), PyRunner(command="space.exportSpheres()", virtPeriod=0.25 * seconds)]
plot.plots = {"t": "left"}

mass, start = sum(b.state.mass for b in O.bodies), time.time()
O.run(int(0.2 * seconds / O.dt), True)
cd_engine.picture(f"{name}.png")
O.run(int(seconds / O.dt) - O.iter, True)
plot.plot(noShow=True).savefig(f"{name}-left.png")
print(f"{len(left)} of {disks} disks left the hopper in {O.time:.2f} s; mass left and remaining / mass at the start: "
      f"{(sum(left) + sum(b.state.mass for b in O.bodies)) / mass:.6f}; {time.time() - start:.1f} s of computing, O.dt = {O.dt:.2g} s")
O.save(f"{name}.yade.gz")
