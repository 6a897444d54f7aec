"""The paper's experiment: a packing prepared under P0, then sigma2 changed while sigma1 = P0 (eqs. 1 and 7, Figs. 3 to 5)."""
from yade import O

from yade_scripts import loading, parameters, prepare
from yade_scripts.scenes import Scene, largest_step, load_walls, set_step


def build(full, folder):
    """Load the prepared packing (made if it is missing) and set up the row's method on it."""
    path, checksum = prepare.ensure(full, folder)
    O.load(str(path))
    every = set_step(full, largest_step(full))
    per_cycle, samples = full["records_per_cycle"], full["records_per_cycle"] * full["cycles"]
    scene = Scene(every=every, samples=samples, state_sha256=checksum, snapshots={per_cycle // 2, samples - per_cycle // 2})
    load_walls(full, scene, loading.goals(full, parameters.pressure(full)))
    return scene
