"""A column of disks is released on one side and collapses onto a rough floor.

The column is deposited without dynamics (running/deposit.py), with width L0 and height about column_aspect L0, against a smooth wall on the left.
There is no wall on the right. The floor is a row of fixed disks. The exact heap at rest is known only as a mean over runs: round-off changes the
paths of single grains, but front and height of the heap vary little between deposits. Without rebound (restitution 0, beta_n 0.9) springs spread some
per cent farther than rigid contacts (study flows). CD's tolerance hardly matters (1e-2 gives the same as 1e-4), its time step a little: the front of
400 disks reaches 3.84 +- 0.04 column widths with steps of 1e-3 s (mean of ten deposits and its standard error) and 3.99 +- 0.04 with 2.5e-4 s; with
springs it reaches 4.03 +- 0.07 (four deposits).
"""
import math

from yade_scripts import parameters
from yade_scripts.parameter import Parameter
from yade_scripts.scenes import Chart
from yade_scripts.scenes._converged import converged

TITLE = "Collapse of a column"
KIND = "flow"
HORIZON = "At rest, about four times the fall sqrt(2H/g) from the start on, and as a mean over seeds; one run is off by the spread."
LEFT_OUT = "the gate's removal, which takes no time here; grains that fly ahead of the heap, by taking the front where 98 % are behind"
DEFAULTS = dict(method="CD", disks=4000, friction=0.5, kn=2e7, beta_n=0.9, gravity=9.81, period=2.5, records_per_cycle=20, tolerance=1e-3,
                max_iterations=2000)
POSITIVE = ("gravity",)
PARAMETERS = (Parameter("column_aspect", 2.0, "1", "height of the column over its width, about: at a solid fraction of 0.8", low=0.1, high=20),)
CHART = Chart(base={"disks": 400}, patience=2, physics=("beta_n",), rolling=True)

SHARE = 0.98  # of the disks behind the front, and below the height
# In column widths, found with the parameters of SAME. _converged.py explains the form.
CONVERGED = {400: ({"front": (3.99, 0.13), "height": (0.817, 0.033)}, "CD, restitution 0, cd_dt 2.5e-4, tolerance 1e-3, seeds 1 to 10"),
             4000: ({"front": (4.67, 0.05), "height": (0.733, 0.006)}, "CD, restitution 0, cd_dt 5e-4, tolerance 1e-2, seeds 1 to 4")}
SAME = dict(column_aspect=2.0, friction=0.5, radius_spread=0.3)
REST = 3.5  # the heap is at rest after this many falls through the column's height


def build(full, folder):
    """Build the deposit of `seed` from x = 0 to L0 on the row of fixed disks, whose tops are at y = 0."""
    import numpy as np
    from yade import O
    from yade_scripts.running import bodies, stage
    ground = stage.Ground(full)
    bodies.append_material("wall", 0.0, full)
    radius, span = ground.radius, parameters.width(full, full["column_aspect"])
    height = 3 * full["column_aspect"] * span
    ground.box((-radius, height / 2), (radius, height / 2 + 2 * radius), material="wall")
    for k in range(math.ceil(span * (2 + 3 * full["column_aspect"]) / (2 * radius))):
        ground.disk(((2 * k + 1) * radius, -radius), blocked="xyzXYZ")
    heap = ground.deposit(span)

    def quantile(axis):
        return float(np.quantile([O.bodies[disk].state.pos[axis] for disk in heap], SHARE)) / span

    extra = {"front": ("L0", f"x that {SHARE:.0%} of the disks are behind, over the width of the column", lambda: quantile(0)),
             "height": ("L0", f"y that {SHARE:.0%} of the disks are below, likewise", lambda: quantile(1))}
    rests = ground.time >= REST * math.sqrt(2 * full["column_aspect"] * span / full["gravity"])
    return stage.small(full, converged(full, CONVERGED, SAME, extra) if rests else [], kept={}, extra=extra)
