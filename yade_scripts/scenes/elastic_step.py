"""A small step of sigma2 on a packing, far from any slip: springs strain by linear elasticity, rigid contacts do not strain.

The step P0 delta_sigma comes as half a cosine over the whole time. The exact gamma of the springs follows from the stiffness matrix of
the contact network (running/elastic.py) and is proportional to 1/k_n. In the stiff limit, and of rigid contacts, it is 0.
"""
from yade_scripts import parameters
from yade_scripts.scenes import Chart, Known, biaxial

TITLE = "Small elastic load step on a packing"
KIND = "dense packings under load"
HORIZON = "The end of the step; for MD only if it takes many periods of the slowest oscillation of sample and walls."
LEFT_OUT = "slip, and contacts that open or close, which are few in a step of a thousandth of P0; changes of geometry, of the order P0/k_n"
DEFAULTS = dict(method="CD", disks=60, delta_sigma=1e-3, md_walls="force", period=0.5, records_per_cycle=10)
CHART = Chart(prepared=True, physics=("beta_n",), rolling=True, sizes=(60, 240, 960))


def build(full, folder):
    """Build the packing and the walls of the biaxial test, loaded by this step."""
    from yade_scripts.running import elastic, loading, walls
    p0, time = parameters.pressure(full), full["period"] * full["cycles"]

    step = {"loading": "smoothStep", "rise": (0, full["delta_sigma"], 0), "period": time}
    scene = biaxial.build(full, folder, loading.constant(p0) | step)
    sides = walls.sides()
    springs = elastic.strain(p0 * full["delta_sigma"])
    scene.known = [
        Known("gamma", "1", springs if parameters.has_springs(full) else 0.0, lambda: walls.gamma(sides), scale=abs(springs),
              source="springs: stiffness matrix of the contacts; rigid contacts rest below yield; scale: the strain of the springs"),
        Known("sigma2", "Pa", p0 * (1 + full["delta_sigma"]), lambda: walls.mean_stresses()[1], scale=p0 * full["delta_sigma"],
              source="the prescribed load; scale: its step")]
    return scene
