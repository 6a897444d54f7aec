"""A ramp of sigma2 on a packing until it yields, compared with the largest load that its contacts can carry.

The static theorem of limit analysis, a linear programme over the contact forces (theory/statics.py) without any dynamics, gives the
largest sigma2/P0 at which the contacts of the initial geometry admit forces within Coulomb's cones. For sliding with friction, which is not
associated, this is an upper bound: rigid contacts may yield somewhat below it. Contacts that close in the first motion let them carry more.
Springs strain before: |gamma| passes yield_strain earlier, unless they are so stiff that P0/k_n is far below it.
"""
from yade_scripts import parameters
from yade_scripts.errors import ParameterError
from yade_scripts.parameter import Parameter
from yade_scripts.scenes import Chart, Known, biaxial

TITLE = "Yield under a ramp"
KIND = "dense packings under load"
HORIZON = ("Until the packing yields; later it has new contacts. Springs of P0/k_n = 6e-4 reach yield_strain elastically before they yield: their "
           "error is that of a softer material. Springs a thousand times as stiff have the answer of rigid grains.")
LEFT_OUT = "the motion after yield, and its delay by the inertia of the walls"
DEFAULTS = dict(method="CD", disks=60, loading="ramp", ramp_rate=0.4, period=3.0, records_per_cycle=600, cd_dt=5e-3, md_walls="force",
                collapse_strain=1e-3)
PARAMETERS = (Parameter("yield_strain", 2e-5, "1", "|gamma| that counts as yield", low=1e-8, high=1),)
CHART = Chart(patience=6, physics=("beta_n",), rolling=True)


def check(full):
    """Check that yield is measured before the run ends at collapse_strain, and that the loading is a ramp."""
    if full["yield_strain"] > full["collapse_strain"] or full["loading"] != "ramp":
        raise ParameterError(f"yield_strain = {full['yield_strain']}: must be at most collapse_strain, {full['collapse_strain']}, and loading = ramp")


def build(full, folder):
    """Build the packing and the walls of the biaxial test; gamma is checked with every sample."""
    from yade import O
    from yade_scripts.theory import statics
    from yade_scripts.running import hooks, observe, walls
    p0 = parameters.pressure(full)
    scene = biaxial.build(full, folder)
    limit = statics.limit_loads(observe.snapshot(True), p0, full["depth"], full["stress_path"])[1]
    sides, yielded = walls.sides(), []

    def watch():
        """Store sigma2/P0 when |gamma| first exceeds yield_strain."""
        if not yielded and abs(walls.gamma(sides)) > full["yield_strain"]:
            yielded.append(1 + full["ramp_rate"] * O.time)

    O.engines = O.engines + [hooks.runner(watch, iterPeriod=scene.every)]
    scene.kept["yielded"] = yielded
    scene.known = [Known("yield_load", "P0", limit, lambda: yielded[0] if yielded else float("nan"),
                         source="linear programme over the contact forces of the geometry at the start")]
    return scene
