"""A drum made of triangles turns and mixes two kinds of spheres: how well are they mixed after a while?

    yade yade_scripts/examples/tumbler.py                         with YADE's window or console at the end; -n -x: without
    yade yade_scripts/examples/tumbler.py spheres=200 springs=1   another size; YADE's springs instead of Contact Dynamics
    yade yade_scripts/examples/tumbler.py film=1                  with a film of the run, tumbler.gif
    yade-batch TABLE yade_scripts/examples/tumbler.py             the rows of a table with columns spheres, springs, seconds, film

The script writes the drum, with six blades, to tumbler.stl, as a program for construction would, and reads it by YADE's ymport.stl; YADE's
RotationEngine turns it. The spheres differ by their density, and first lie side by side. tumbler.png shows them at the end, coloured by where they
came from, tumbler-mixing.png how far the two kinds are apart against time; tumbler-*.vtk hold spheres and facets for Paraview, tumbler.yade.gz the
last state. From that state both methods then run for a moment, and their costs are printed. After a run of
springs Contact Dynamics may say once that its first, longer step lets two fast spheres overlap.
"""
import math, pathlib, random, sys, time
file = sys._getframe().f_code.co_filename  # YADE sets no __file__
if locals() is not globals():
    sys.exit(f"write execfile({file!r}, globals()): without globals() the functions of a script do not find its names")
sys.path.insert(0, str(pathlib.Path(file).resolve().parents[2]))  # this clone; not needed after `make install`
import cd_engine
from yade import export, plot, ymport

settings = dict(spheres=600, springs=0, seconds=3.0, film=0)
for word in sys.argv[1:]:
    name, _, value = word.partition("=")
    try:
        settings[name] = type(settings[name])(value)
    except (KeyError, ValueError):
        sys.exit(f"{word}: write name=number as in spheres=100; the names are {', '.join(settings)}")
readParamsFromTable(noTableOk=True, **settings)
from yade.params.table import spheres, springs, seconds, film
if not (isinstance(spheres, int) and spheres >= 1 and isinstance(seconds, (int, float)) and 0.1 <= seconds < 1e9 and {springs, film} <= {0, 1}):
    sys.exit(f"spheres={spheres}, springs={springs}, seconds={seconds}, film={film}: spheres must be a whole number of at least 1, springs and film "
             "0 or 1, seconds at least 0.1")
name = f"tumbler-{O.tags['d.id']}" if runningInBatch() else "tumbler"  # of the files written: every row of a table has its own

draw = random.Random(1).uniform                                                            # YADE reseeds the common generator for colours
radius, gravity, spin, sides = 0.005, (0, 0, -9.81), 3.0, 36                              # m, m/s^2, rad/s
inner = radius * (12 * spheres)**(1 / 3)                                                  # inner radius [m] of a drum filled by a third
long = 1.2 * inner                                                                        # along y, its axis


def write_stl(path):
    """Write the drum as a file of triangles: its mantle, two ends, and six blades."""
    rim = [(inner * math.cos(2 * math.pi * k / sides), inner * math.sin(2 * math.pi * k / sides)) for k in range(sides + 1)]
    quads = [[(*rim[k], -1), (*rim[k + 1], -1), (*rim[k + 1], 1), (*rim[k], 1)] for k in range(sides)]
    quads += [[(x, z, -1), (x, z, 1), (0.8 * x, 0.8 * z, 1), (0.8 * x, 0.8 * z, -1)] for x, z in rim[0:sides:sides // 6]]
    triangles = [corners for q in quads for corners in ((q[0], q[1], q[2]), (q[0], q[2], q[3]))]
    triangles += [((0, 0, end), (*rim[k], end), (*rim[k + 1], end)) for k in range(sides) for end in (-1, 1)]
    with open(path, "w") as stl:
        stl.write("solid drum\n")
        for corners in triangles:
            points = "".join(f"vertex {x:.9g} {y * long / 2:.9g} {z:.9g}\n" for x, z, y in corners)
            stl.write(f"facet normal 0 0 0\nouter loop\n{points}endloop\nendfacet\n")
        stl.write("endsolid drum\n")


O.materials.append(FrictMat(young=1e8, poisson=0.3, density=2600, frictionAngle=math.atan(0.4), label="heavy"))
O.materials.append(FrictMat(young=1e8, poisson=0.3, density=1300, frictionAngle=math.atan(0.4), label="light"))
write_stl(f"{name}.stl")
drum = O.bodies.append(ymport.stl(f"{name}.stl", material="heavy", color=(0.5, 0.5, 0.5)))
step, turn = 2.2 * radius, spin * seconds
places = [(step * i, step * j, step * k) for k in range(-60, 60) for j in range(-60, 60) for i in range(-60, 60)
          if math.hypot(step * i, step * k) < 0.78 * inner - radius and abs(step * j) < long / 2 - 1.5 * radius]
if len(places) < spheres:
    sys.exit(f"spheres={spheres}: there is room for {len(places)} only")
grains = [O.bodies[O.bodies.append(sphere((x + draw(0, 0.1 * radius), y, z + draw(0, 0.1 * radius)), radius * draw(0.9, 1),
                                          material="heavy" if x < 0 else "light"))] for x, y, z in places[:spheres]]
ids = [b.id for b in grains]
heavy = [b.id for b in grains if b.mat.label == "heavy"]


def apart():
    """Return how far the centres of the two kinds are apart, over the radius of the drum."""
    centres = [sum((O.bodies[i].state.pos for i in kind), Vector3.Zero) / max(1, len(kind)) for kind in (heavy, list(set(ids) - set(heavy)))]
    return (centres[0] - centres[1]).norm() / inner


def set_engines(springs):
    """Set the engines and the time step of YADE's springs or of Contact Dynamics. Engines that move bodies stand before ContactDynamics."""
    cd_engine.release()                                                                   # contacts without springs, which Contact Dynamics has made
    turns = RotationEngine(ids=drum, rotationAxis=(0, 1, 0), angularVelocity=spin, rotateAroundZero=True, zeroPoint=(0, 0, 0))
    if springs:
        O.engines = [
            ForceResetter(),
            InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Facet_Aabb()]),
            InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Facet_Sphere_ScGeom(hertzian=True)],
                            [Ip2_FrictMat_FrictMat_MindlinPhys(en=0.3, es=0.3)], [Law2_ScGeom_MindlinPhys_Mindlin()]),
            turns,
            NewtonIntegrator(gravity=gravity, damping=0),
        ]
        O.dt = 0.5 * PWaveTimeStep()
    else:
        reset, collider, contact_dynamics = cd_engine.engines(gravity=gravity, tolerance=1e-3, gapCorrection=0.1)
        O.engines = [reset, collider, turns, contact_dynamics]
        O.dt = cd_engine.timeStep(speed=1.5)                                              # [m/s], of spheres that fall from a blade


set_engines(springs)
space = export.VTKExporter(name)  # Debian's VTKRecorder reads uninitialized memory and crashes some runs
O.engines = O.engines + [PyRunner(command="plot.addData(t=O.time, apart=apart())", virtPeriod=0.02),
                         PyRunner(command="space.exportSpheres(); space.exportFacets()", virtPeriod=0.25 * seconds)]
origin = [0 if i in set(heavy) else 1 for i in ids]
view = (-1.6 * inner, 1.6 * inner, -1.4 * inner, 1.4 * inner)
if film:
    O.engines = O.engines + [cd_engine.film(f"{name}.gif", every=0.05, view=view)]
plot.plots = {"t": "apart"}

start = time.process_time()
O.run(int(seconds / O.dt), True)
plot.plot(noShow=True).savefig(f"{name}-mixing.png")
cd_engine.picture(f"{name}.png", colour=origin, label="light spheres", limits=(-0.3, 1.2), view=view)
inside = sum(math.hypot(b.state.pos[0], b.state.pos[2]) < inner and abs(b.state.pos[1]) < long / 2 for b in grains)
print(f"the two kinds are apart by {plot.data['apart'][0]:.2f} radii of the drum at the start and by {plot.data['apart'][-1]:.2f} after "
      f"{spin * O.time / 2 / math.pi:.1f} turns; {inside} of {spheres} spheres in the drum; {time.process_time() - start:.1f} s of computing, "
      f"O.dt = {O.dt:.2g} s")
O.save(f"{name}.yade.gz")

cost = []
for springy in 0, 1:
    O.load(f"{name}.yade.gz")
    set_engines(springy)
    O.run(10, True)
    begun, start = O.time, time.process_time()
    O.run(int(0.02 / O.dt), True)
    cost.append((time.process_time() - start) / (O.time - begun))
print(f"a second of the scene from {name}.yade.gz on takes {cost[0]:.3g} s of computing by Contact Dynamics, {cost[1]:.3g} s by springs")
