"""CD: the step against the tolerance, a packing that must bear a small load without moving."""
from yade_scripts.maps import Axis, Map, Search, logarithmic, product


def grid(full):
    """tolerance by step."""
    tolerances, steps = ((logarithmic(1e-9, 1e-1, 9), logarithmic(1e-5, 1e-2, 7)) if full else (logarithmic(1e-7, 1e-1, 4), logarithmic(1e-4, 1e-2, 3)))
    return product(tolerance=tolerances, dt=steps)


def searches(full):
    """The loosest tolerance at which it does not strain, for each step."""
    return [Search(at, "tolerance", 1e-8, 1.0, 1.1 if full else 1.5) for at in product(dt=logarithmic(1e-5, 1e-2, 7) if full else logarithmic(1e-4, 1e-2, 3))]


MAP = Map(
    title="Rigid contacts: a small load on a packing",
    question="At what step and tolerance does a packing far below yield stay at rest, as rigid grains must?",
    criterion="100 disks at rest under P0 with free walls; sigma2 rises by 5 % at once and stays for 50 steps. Inaccurate: |gamma| above 1e-6. Unstable: above 1e-3. "
              "Not solved: steps that missed the tolerance.",
    remedy="Until it is proven to be at rest and sleeps, an unsolved rest moves the packing by about tolerance times dt^2. The defaults of runs (1e-8, 1 ms) "
           "are three decades inside the boundary; the engine's own tolerance of 1e-6 is at it at 10 ms.",
    x=Axis("tolerance", "tolerance"), y=Axis("dt", "step dt [s]"), panels="",
    measures={"gamma": ("1", "strain2 - strain1 after the last step"), "unconverged": ("1", "share of the steps that missed the tolerance"),
              "sweeps": ("1", "mean number of sweeps a step")},
    grid=grid, searches=searches, marks={"default of runs": 1e-8, "of the engine": 1e-6})
