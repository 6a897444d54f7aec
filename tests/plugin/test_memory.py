"""A step allocates no memory once sizes have settled. Counted for the whole engine in a running YADE, including libraries that it calls."""
import os
import subprocess

import pytest

from . import plane, programs

PROGRAM = """
import ctypes
import yade
from tests.plugin import plane, tumbler
from yade_scripts.running import hooks
{scene}
counter = ctypes.CDLL(None)
# In one run, since each is a thread of its own, whose memory begins anew. The second hook asks for some, which has to be seen.
yade.O.engines = yade.O.engines + [hooks.runner(counter.countStart, iterPeriod=10**9, firstIterRun=yade.O.iter + {settle}),
                                   hooks.runner(counter.askForMemory, iterPeriod=10**9, firstIterRun=yade.O.iter + {settle} + 1)]
yade.O.run({settle} + {steps}, True)
counter.countStop()
counter.countPrint({output!r}.encode())
assert engine.contacts > 20, engine.contacts
"""
# What YADE asks for in a step of any engine: the collider's new interactions, and teams of threads.
YADES = ("ForceContainer4sync", "InteractionContainer")
OURS = "_yade_plugin.so:"


@pytest.fixture(scope="module")
def counter(tmp_path_factory):
    """The library that counts."""
    library = tmp_path_factory.mktemp("counter") / "allocations.so"
    source = os.path.join(os.path.dirname(__file__), "allocations.cpp")
    subprocess.run(["g++", "-std=c++17", "-O1", "-shared", "-fPIC", source, "-o", str(library), "-ldl"], check=True)
    return library


def requests(counter, folder, **scene):
    """Requests for memory a step: the engine's, also through YADE's class factory, and those that YADE's collider and forces make when it calls
    them."""
    output = folder / "requests.txt"
    done = programs.in_python(PROGRAM.format(output=str(output), **scene), LD_PRELOAD=str(counter))
    assert done.returncode == 0, done.stderr
    ours = yades = 0
    lines = output.read_text().splitlines()
    assert any("allocations.so:askForMemory" in line for line in lines)
    for line in lines:
        times, *callers = line.split()
        before = [OURS in caller for caller in callers]
        if not any(before):
            continue
        if any(name in caller for name in YADES for caller in callers[:before.index(True)]):
            yades += int(times)
        else:
            ours += int(times)
            print(line)  # pytest shows it if the test fails
    return ours / scene["steps"], yades / scene["steps"]


def test_at_rest_none(counter, tmp_path):
    """A heap that has come to rest: no request at all, the collider sleeps."""
    scene = """
plane.heap(0.3)
engine = plane.run(1, 1e-3, gravity=(0, -9.81, 0), tolerance=1e-6)
"""
    assert requests(counter, tmp_path, scene=scene, settle=2500, steps=500) == (0, 0)


def test_while_contacts_come_and_go_none_but_for_new_records(counter, tmp_path):
    """More contacts than ever before ask for memory, 0.003 times a step after 20 000 steps and falling; those that replace others do not, where
    five contacts close in every four steps. By sweeps: Newton's method plans its factorization anew for every set of contacts. YADE makes a new
    interaction in every fourth step, by four requests."""
    ours, yades = requests(counter, tmp_path, scene="engine = tumbler.build(40); engine.method = 'accelerated'", settle=6000, steps=2000)
    assert yades > 0.5
    assert ours < 0.03


PER_CYCLE = """
import ctypes
from yade import O
import cd_engine
from tests.plugin import plane

class Use(ctypes.Structure):
    _fields_ = [(name, ctypes.c_size_t) for name in "arena ordblks smblks hblks hblkhd usmblks fsmblks uordblks fordblks keepcost".split()]

libc = ctypes.CDLL(None)
libc.mallinfo2.restype = Use

def build(contact_dynamics):
    O.reset()
    plane.grid(150, 15, (0, 0.011), (0.021, 0.021), plane.ground())
    plane.engine(1e-4, gravity=(0, -9.81, 0))
    if not contact_dynamics:
        O.engines = plane.springs(verletDist=0)
    O.run(20, True)

for contact_dynamics in (False, True):
    for cycle in range(35):
        build(contact_dynamics)
        if cycle in (4, 34):
            use = libc.mallinfo2()
            print("used", use.uordblks + use.hblkhd)
"""


def test_scenes_that_are_gone_leave_no_more_than_springs_do():
    """Reset and build anew, 30 times. YADE never destroys an engine that was in O.engines, and loses 63 kB a scene of 150 disks with springs."""
    done = programs.in_python(PER_CYCLE)
    used = [int(line.split()[1]) for line in done.stdout.splitlines() if line.startswith("used")]
    assert len(used) == 4, done.stderr
    springs, rigid = (used[1] - used[0]) / 30, (used[3] - used[2]) / 30
    print(f"{springs / 1000:.0f} kB a scene with springs, {rigid / 1000:.0f} with Contact Dynamics")
    assert rigid < springs


@pytest.mark.parametrize("kn", [0, 1e5])
def test_stiffness_stays_with_its_pair(O, kn):
    """A contact's objects serve another pair when it is gone, but not those that springs gave a stiffness."""
    first, second, third = (plane.disk((x, 0), 0.1) for x in (0, 0.199, 0.6))
    plane.run(1, 1e-3, handover=True)
    O.bodies[second].state.vel = (-1, 0, 0)
    O.run(1, True)
    assert O.interactions[first, second].isReal
    O.interactions[first, second].phys.kn = kn
    for body, place in ((second, -1), (third, 0.2)):
        O.bodies[body].state.pos, O.bodies[body].state.vel = (place, 0, 0), (0, 0, 0)
    O.bodies[first].state.vel = (0, 0, 0)
    O.run(2, True)
    assert not (O.interactions.has(first, second) and O.interactions[first, second].isReal)
    O.bodies[third].state.vel = (-1, 0, 0)
    O.run(1, True)
    contact = O.interactions[first, third]
    assert contact.isReal and contact.phys.kn == 0


REFUSED = """
import ctypes
from yade import O
import cd_engine
from tests.plugin import plane
refuse = ctypes.CDLL(None).refuse
refuse.restype, refuse.argtypes = ctypes.c_long, [ctypes.c_long]

def digest(number, at):
    O.reset()
    plane.heap(0.3)
    plane.engine(gravity=(0, -9.81, 0), tolerance=1e-6, reduce={reduce})
    if at:
        O.run(at, True)
    refuse(number)
    told = ""
    try:
        O.run(1, True)
    except RuntimeError as error:
        told = str(error)
    refused = number > 0 and refuse(0) <= 0
    # Where the memory of a finished step cannot be kept for the next one (workspace.hpp), nothing is told.
    assert not told or refused and "no memory is left" in told, (number, told)
    heard.append(told)
    O.run(at + 20 - O.iter, True)
    return refused, plane.digest()

heard = []
for at in (0, 60):
    known, number, refused = digest(0, at)[1], 1, True
    while refused:
        refused, found = digest(number, at)
        assert found == known, (number, at)
        number += 1 + number // 10
    print("refused up to request", number, flush=True)
    assert at or number > 20
assert sum(map(bool, heard)) > 15, heard

# In a long run, after steps of which the scene knows nothing yet, and with an engine that pushes.
from yade import wrapper
ends = set()
for number in (1, 2, 5, 15, 40, *range(93, 240, 6)):
    O.reset()
    plane.heap(0.3)
    ball = plane.disk((5, 1000), 0.01)
    reset, collider, cd = cd_engine.engines(gravity=(0, -9.81, 0), tolerance=1e-6, reduce={reduce})
    O.engines, O.dt = [reset, collider, wrapper.ForceEngine(ids=[ball], force=(O.bodies[ball].state.mass, 0, 0)), cd], 1e-3
    O.run(5, True)
    refuse(number)
    try:
        O.run(200, True)
    except RuntimeError as error:
        ends.add("to show" if "is left to show this step" in str(error) else "for it" if "is left for this step" in str(error) else str(error))
    refuse(0)
    time = O.time
    assert abs(O.iter * 1e-3 - time) < 1e-12
    assert abs(O.bodies[ball].state.pos[1] - 1000 + 9.81 * time**2 / 2) < 1e-9, (number, O.iter, O.bodies[ball].state.pos)
    assert abs(O.bodies[ball].state.vel[0] - time) < 1e-9
    O.run(20, True)
    assert abs(O.bodies[ball].state.vel[0] - O.iter * 1e-3) < 1e-9, (number, O.bodies[ball].state.vel)
assert ends == {{"for it", "to show"}}, ends
"""


@pytest.mark.parametrize("reduce", [True, False])
def test_a_step_that_gets_no_memory_can_be_made_again(counter, reduce):
    """Whichever request is refused: the step is refused in words, and the next attempt makes it, with the same bits. If the bodies have moved
    before the refusal, the step counts."""
    done = programs.in_python(REFUSED.format(reduce=reduce), LD_PRELOAD=str(counter))
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("refused up to request") == 2
