"""What the maps of load cycles share inside YADE: one cycle of a packing, and the strain of another one that counts as true."""
import functools
import math

from yade_scripts import parameters, run
from yade_scripts.running import hooks, observe, walls
from yade_scripts.theory import statics

DISKS = 100


def cycle(**row):
    """Return gamma at the peak of the load and at the end of a cosine cycle. Raise Unstable if the watch of runs ends it.

    Two samples: half the cycle each, which a step of CD divides.
    """
    scene = run.start(**{"disks": DISKS, "loading": "cosine", "records_per_cycle": 2} | row)
    sides, strains = walls.sides(), []
    for _ in range(scene.samples):
        hooks.simulate(scene.every)
        strains.append(walls.gamma(sides))
    assert all(map(math.isfinite, strains))
    return strains


@functools.cache
def _stored(row):
    return cycle(**dict(row))


def errors(found, **truth):
    """Return by how much the two strains differ from those of the row `truth`, over the strain at the peak."""
    exact = _stored(tuple(truth.items()))
    return [(one - true) / exact[0] for one, true in zip(found, exact)]


@functools.cache
def limit():
    """Return the largest rise of sigma2/P0 that the contacts of the packing can carry (theory/statics.py)."""
    full = parameters.complete({"disks": DISKS, "method": "CD"})
    run.start(**{"disks": DISKS, "method": "CD"})
    return statics.limit_loads(observe.snapshot(True), parameters.pressure(full), full["depth"], full["stress_path"])[1] - 1
