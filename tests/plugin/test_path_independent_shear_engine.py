"""What the engine of the path-independent springs refuses."""
import pytest
from yade import wrapper as w

import cd_engine

from .test_path_independent_shear import R1, R2, engines, pair


def with_engines(change):
    """Return a function that sets O.engines to what `change` makes of its list."""
    return lambda O: setattr(O, "engines", change(O.engines))


def mindlin(engines):
    """Return the engines with springs of another kind."""
    loop = w.InteractionLoop([w.Ig2_Sphere_Sphere_ScGeom()], [w.Ip2_FrictMat_FrictMat_MindlinPhys()], [w.Law2_ScGeom_MindlinPhys_Mindlin()])
    return engines[:2] + [loop] + engines[3:]


@pytest.mark.parametrize("spoil, words", [
    (with_engines(lambda all: all[:2] + all[3:]), "no InteractionLoop before it.*right behind InteractionLoop"),
    (lambda O: setattr(O.engines[2], "dead", True), "no InteractionLoop before it"),
    (with_engines(lambda all: all[:3] + all[4:] + [all[3]]), "NewtonIntegrator before it"),
    (with_engines(lambda all: all[:4] + [cd_engine.PathIndependentShear()] + all[4:]), "another one before it"),
    (with_engines(mindlin), "#0 and #1 has ScGeom and MindlinPhys"),
    (lambda O: setattr(O.bodies[1].state, "pos", (R1 + R2 - 1e-3, 0, 1e-4)), "out of the plane"),
    (lambda O: setattr(O.bodies[1].state, "angVel", (1, 0, 0)), "#1 turns out of the plane"),
    (lambda O: setattr(O, "periodic", True), "periodic"),
], ids=["no loop", "dead loop", "behind the integrator", "two of them", "other springs", "different heights", "turning out of the plane", "periodic"])
def test_refused(O, spoil, words):
    """Each by its reason; the message names the remedy."""
    pair(O, 1e-3)
    engines(O)
    spoil(O)
    with pytest.raises(RuntimeError, match=words):
        O.step()
