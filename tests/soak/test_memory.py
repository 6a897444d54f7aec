"""Contact Dynamics over long times."""
import json
import os
import subprocess
import sys

import pytest

SAMPLES = 100
PROGRAM = """
import glob, json, sys
sys.path[:0] = [{root!r}, *glob.glob("/usr/lib/*/yade-double/py")]
import yade
from tests.plugin import plane, tumbler
from yade_scripts.running import hooks
tumbler.enlarge_table_of_names()
engine, memory, contacts = tumbler.build(40), [], []

def sample():
    memory.append(next(int(line.split()[1]) * 1024 for line in open("/proc/self/status") if line.startswith("RssAnon")))
    contacts.append(engine.contacts)

yade.O.engines = yade.O.engines + [hooks.runner(sample, iterPeriod={steps} // {samples})]
hooks.simulate({steps})
print(json.dumps(dict(steps=yade.O.iter, memory=memory, contacts=contacts, unconverged=engine.unconvergedSteps, energy=plane.kinetic_energy())))
"""


@pytest.mark.timeout(3600)
def test_a_million_steps_leave_the_memory_as_it_is(root):
    """After a tenth of the steps memory grows by less than a quarter of a byte a step. So a leak of malloc's smallest block, 32 bytes, in every 128th
    step would be found. The growth comes from new maxima of the numbers of contacts and near pairs."""
    program = PROGRAM.format(root=str(root), steps=1000000, samples=SAMPLES)
    done = subprocess.run([sys.executable, "-c", program], env=os.environ | {"OMP_NUM_THREADS": "1"}, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout.splitlines()[-1])
    memory, contacts = found["memory"][SAMPLES // 10:], found["contacts"]
    print(f"memory {memory[0] / 2**20:.2f} MiB after a tenth, {memory[-1] / 2**20:.2f} MiB at the end, most {max(memory) / 2**20:.2f}; "
          f"contacts {min(contacts)} to {max(contacts)}; {found['unconverged']} steps short of the tolerance")
    assert found["steps"] == 1000000 and found["energy"] > 0
    assert len(set(contacts)) > 10  # they did come and go
    assert max(memory) - memory[0] < 0.25 * 900000, memory
