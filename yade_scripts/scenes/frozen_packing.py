"""A prepared packing that does not move: a walk over the contact forces it admits under P0 (see preparing/force_network.py).

The first snapshot holds the forces of the springs that prepared it, from which the walk starts. Every step gives a sample, after which the
bodies are put back. The step is so short that no gap closes within it. So the forces act on the contacts that the springs left, and not on
pairs some 1e-12 m apart, which a longer step would close.
"""
import numpy as np

from yade_scripts import parameters
from yade_scripts.errors import ParameterError
from yade_scripts.scenes import Scene

TITLE = "Walk over the force networks of a packing at rest"
KIND = "dense packings under load"
METHODS = ("CD",)
ONLY = "the positions of the grains determine the forces of springs"
HORIZON = "Each step by itself, since the grains are put back; nothing is known exactly except the balance of forces."
LEFT_OUT = "motion"
DEFAULTS = dict(method="CD", network_seed=1, tolerance=1e-10, cd_dt=1e-6, period=2e-4)


def check(full):
    """Check that the solver starts from the perturbed forces: this needs warm_start and a network_seed."""
    if not full["warm_start"] or not full["network_seed"]:
        raise ParameterError("scene = frozen_packing: needs warm_start = True and a network_seed above 0, for its perturbed forces are the "
                             "solver's first guess")


def build(full, folder):
    """Load the packing (made if missing) under P0; make one step from zero forces, then a walk of records_per_cycle times cycles steps."""
    from yade import O
    from yade_scripts.preparing import force_network, prepare
    from yade_scripts.running import loading, stage
    checksum = prepare.load(full, folder)
    O.dt = full["cd_dt"]
    scene = Scene(every=1, samples=full["records_per_cycle"] * full["cycles"] + 1, state_sha256=checksum)
    p0 = parameters.pressure(full)
    stage.load_walls(full, scene, loading.constant(p0))
    walk = force_network.Walk(full["network_seed"], full["network_perturbation"], cold_first=True)
    walk.surround()
    scene.extra = {
        "normal": ("N", "R of each contact of the first snapshot (columns), at each step of the walk (rows)", lambda: np.array(walk.normal[1:])),
        "tangential": ("N", "T likewise", lambda: np.array(walk.tangential[1:])),
        "converged": ("1", "whether the solver met the tolerance in that step", lambda: np.array(walk.converged[1:])),
        "cold_normal": ("N", "R that the solver finds from no forces at all", lambda: walk.normal[0]),
        "cold_tangential": ("N", "T likewise", lambda: walk.tangential[0]),
    }
    return scene
