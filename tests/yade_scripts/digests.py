"""Prints one digest for each scene, method and solver, which tests/yade_scripts/test_same_everywhere.py compares between processes.

    yade -n -x digests.py METHODS [backwards] [instruction set]      METHODS: MD, CD or MD,CD
"""
import hashlib
import json
import pathlib
import sys

if __name__ == "__main__":
    sys.path.insert(0, str(pathlib.Path(sys.argv[0]).resolve().parents[2]))

import numpy as np

from yade_scripts import parameters, scenes

# Most of a row: the scenes with one contact are over by then or have had it, the packings have been loaded.
STEPS = 1000
SMALL = {"collapse": dict(disks=300, period=0.3), "triaxial": dict(disks=60)}
# More disks than make up one group of the space order; cycles; random orders and given numbers of sweeps.
VARIANTS = {"many disks": dict(scene="collapse", disks=2500, period=0.03), "cycles": dict(scene="biaxial", period=0.3),
            "random order": dict(scene="biaxial", solver_seed=7), "fixed": dict(scene="biaxial", fixed_iterations=50)}


def rows(methods, solvers):
    """{name: row} of all scenes by the methods given, CD's variants and solvers."""
    found = {f"{scene} {method}": dict(scene=scene, method=method) for scene in scenes.names() for method in scenes.module(scene).METHODS
             if method in methods}
    if "CD" in methods:
        found |= {name: row | dict(method="CD") for name, row in VARIANTS.items()}
        # So many sweeps are needed here that every solver goes its own way.
        found |= {f"stack by {solver}": dict(scene="stack", method_cd=solver, method="CD") for solver in solvers}
    return {name: {"disks": scenes.module(row["scene"]).DEFAULTS.get("disks", 60)} | SMALL.get(row["scene"], {}) | row for name, row in found.items()}


def digest():
    """SHA-256 of time, all positions, orientations, velocities and contact forces."""
    from yade import O
    numbers = [(O.time,)] + [(*b.state.pos, *b.state.ori, *b.state.vel, *b.state.angVel) for b in O.bodies]
    real = sorted((i for i in O.interactions if i.isReal), key=lambda i: (i.id1, i.id2))
    numbers += [(i.id1, i.id2, *i.phys.normalForce, *i.phys.shearForce) for i in real]
    return hashlib.sha256(b"".join(np.array(row, float).tobytes() for row in numbers)).hexdigest()


def main(methods, *options):
    """{name: [digest, steps]} and the number of threads, as JSON."""
    from yade import O, config

    import cd_engine
    from yade_scripts.running import hooks
    cd_engine.ContactDynamics  # loads the module, whose instruction sets are asked for next
    from cd_engine import _yade_plugin
    used = (*(name for name in options if name != "backwards"), _yade_plugin.instruction_sets()[0])[0]
    _yade_plugin.use_instruction_set(used)
    todo = list(rows(methods.split(","), cd_engine.methods()).items())
    found = {}
    for name, row in todo[::-1] if "backwards" in options else todo:
        scene = scenes.build(parameters.complete(row), "results")
        hooks.simulate(min(STEPS, scene.every * scene.samples))
        found[name] = [digest(), O.iter]
    print(json.dumps({"yade": config.version, "threads": O.numThreads, "instruction_set": used,
                      "instruction_sets": list(_yade_plugin.instruction_sets()),
                      "digests": found}))


if __name__ == "__main__":
    main(*sys.argv[1:])
