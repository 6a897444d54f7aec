"""A silo made of facets runs empty: how many spheres leave it, and is it Beverloo's law?

    yade yade_scripts/examples/silo.py                         with YADE's window or console at the end; -n -x: without
    yade yade_scripts/examples/silo.py spheres=200 springs=1   another size; YADE's springs instead of Contact Dynamics
    yade-batch TABLE yade_scripts/examples/silo.py             the rows of a table with columns spheres, springs, seconds

A funnel of facets under a cylinder of facets, both open at their ends. The script removes spheres that have left. silo.png shows the spheres after a
quarter of the time, silo-left.png the discharge; silo-*.vtk hold spheres and facets for Paraview, silo.yade.gz the state after a quarter of the time.
From that state both methods then run for a moment, and their costs are printed. After a run of
springs Contact Dynamics may say once that its first, longer step lets two fast spheres overlap.
"""
import math, pathlib, random, sys, time
file = sys._getframe().f_code.co_filename  # YADE sets no __file__
if locals() is not globals():
    sys.exit(f"write execfile({file!r}, globals()): without globals() the functions of a script do not find its names")
sys.path.insert(0, str(pathlib.Path(file).resolve().parents[2]))  # this clone; not needed after `make install`
import cd_engine
from yade import export, geom, plot

settings = dict(spheres=800, springs=0, seconds=1.0)
for word in sys.argv[1:]:
    name, _, value = word.partition("=")
    try:
        settings[name] = type(settings[name])(value)
    except (KeyError, ValueError):
        sys.exit(f"{word}: write name=number as in spheres=100; the names are {', '.join(settings)}")
readParamsFromTable(noTableOk=True, **settings)
from yade.params.table import spheres, springs, seconds
if not (isinstance(spheres, int) and spheres >= 1 and isinstance(seconds, (int, float)) and 0.1 <= seconds < 1e9 and springs in (0, 1)):
    sys.exit(f"spheres={spheres}, springs={springs}, seconds={seconds}: spheres must be a whole number of at least 1, springs 0 or 1, seconds at "
             "least 0.1")
name = f"silo-{O.tags['d.id']}" if runningInBatch() else "silo"  # of the files written: every row of a table has its own

draw = random.Random(1).uniform                                                            # YADE reseeds the common generator for colours
radius, opening, inner, gravity = 0.005, 0.05, 0.06, (0, 0, -9.81)                        # m; diameter of the opening, radius of the cylinder
funnel, high, mu = 0.05, 0.013 * (1 + spheres // 70), 0.4                                 # heights of funnel and cylinder [m]; friction
O.materials.append(FrictMat(young=1e8, poisson=0.3, density=2600, frictionAngle=math.atan(mu), label="grains"))
O.bodies.append(geom.facetCone((0, 0, funnel / 2), inner, opening / 2, funnel, segmentsNumber=24, wallMask=4, material="grains"))
O.bodies.append(geom.facetCylinder((0, 0, funnel + high / 2), inner, high, segmentsNumber=24, wallMask=4, material="grains"))
places = [(0.0125 * i, 0.0125 * j) for i in range(-5, 6) for j in range(-5, 6) if math.hypot(0.0125 * i, 0.0125 * j) < inner - 1.5 * radius]
for k in range(spheres):                                                                  # loose layers
    x, y = places[k % len(places)]
    O.bodies.append(sphere((x + draw(-1e-3, 1e-3), y + draw(-1e-3, 1e-3), funnel + 0.006 + 0.0115 * (k // len(places))), radius * draw(0.9, 1),
                           material="grains"))

left = []                                                                                 # masses of the spheres that have left


def record():
    for grain in [b for b in O.bodies if isinstance(b.shape, Sphere) and b.state.pos[2] < -0.05]:
        left.append(grain.state.mass)
        O.bodies.erase(grain.id)
    plot.addData(t=O.time, left=sum(left))


def set_engines(springs):
    """Set the engines and the time step of YADE's springs or of Contact Dynamics."""
    cd_engine.release()                                                                   # contacts without springs, which Contact Dynamics has made
    if springs:
        O.engines = [
            ForceResetter(),
            InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Facet_Aabb()]),
            InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Facet_Sphere_ScGeom(hertzian=True)],
                            [Ip2_FrictMat_FrictMat_MindlinPhys(en=0.3, es=0.3)], [Law2_ScGeom_MindlinPhys_Mindlin()]),
            NewtonIntegrator(gravity=gravity, damping=0),
        ]
        O.dt = 0.5 * PWaveTimeStep()
    else:
        O.engines = cd_engine.engines(gravity=gravity, tolerance=1e-3)                    # enough for a mean rate of discharge
        O.dt = cd_engine.timeStep(speed=2)                                                # [m/s], at the opening


set_engines(springs)
space = export.VTKExporter(name)  # Debian's VTKRecorder reads uninitialized memory and crashes some runs
space.exportFacets()
O.engines = O.engines + [PyRunner(command="record()", virtPeriod=0.01), PyRunner(command="space.exportSpheres()", virtPeriod=0.25 * seconds)]
plot.plots = {"t": "left"}

mass, start = sum(b.state.mass for b in O.bodies), time.process_time()
O.run(int(0.25 * seconds / O.dt), True)
cd_engine.picture(f"{name}.png")
O.save(f"{name}.yade.gz")
O.run(int(seconds / O.dt) - O.iter, True)
plot.plot(noShow=True).savefig(f"{name}-left.png")
flowing = [(t, m) for t, m in zip(plot.data["t"], plot.data["left"]) if 0.2 * mass < m < 0.7 * mass]
rate = (flowing[-1][1] - flowing[0][1]) / (flowing[-1][0] - flowing[0][0]) if len(flowing) > 2 else math.nan
beverloo = 0.58 * 0.6 * 2600 * math.sqrt(9.81) * (opening - 1.4 * 1.9 * radius)**2.5      # bulk density 0.6 times that of the grains
print(f"{len(left)} of {spheres} spheres left the silo in {O.time:.2f} s; mass left and remaining / mass at the start: "
      f"{(sum(left) + sum(b.state.mass for b in O.bodies)) / mass:.6f}; rate {rate:.2f} kg/s, by Beverloo {beverloo:.2f}; "
      f"{time.process_time() - start:.1f} s of computing, O.dt = {O.dt:.2g} s")

cost = []
for springy in 0, 1:
    O.load(f"{name}.yade.gz")
    set_engines(springy)
    O.run(10, True)
    begun, start = O.time, time.process_time()
    O.run(int(0.02 / O.dt), True)
    cost.append((time.process_time() - start) / (O.time - begun))
print(f"a second of the scene from {name}.yade.gz on takes {cost[0]:.3g} s of computing by Contact Dynamics, {cost[1]:.3g} s by springs")
