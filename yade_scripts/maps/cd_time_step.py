"""CD: the step against restitution, disks that fall into a trough."""
import math

from yade_scripts.maps import Axis, Map, Search, logarithmic, product


def grid(full):
    """step by restitution, a panel for each friction."""
    steps = logarithmic(0.003, 3, 10) if full else logarithmic(0.01, 3, 6)
    return product(friction=[0.0, 0.5] if full else [0.5], restitution=[0.0, 0.2, 0.4, 0.6, 0.8, 1.0] if full else [0.0, 0.5, 0.9], dt=steps)


def searches(full):
    """The longest step without deep overlaps."""
    return [Search(at, "dt", 0.003, 10.0, 1.05 if full else 1.2)
            for at in product(friction=[0.0, 0.5] if full else [0.5], restitution=[0.0, 0.2, 0.4, 0.6, 0.8] if full else [0.0, 0.5])]


MAP = Map(
    title="Rigid contacts: the step of a fall",
    question="How long a step do falling and settling disks bear?",
    criterion="30 disks fall into a trough and settle, 20 sqrt(R/g), tolerance 1e-5. Unstable: kinetic and potential energy with what was dissipated "
              "grow by more than 1e-5 of the fall's, or a disk leaves the trough. Inaccurate: bodies overlap by more than 1 % of the radius. "
              "Not solved: more than 1 % of the steps missed the tolerance.",
    remedy="Without restitution no step is too long for contacts to hold. With it, contacts that only others close overlap by up to "
           "a step's way, of which the engine warns; beyond dt sqrt(g/R) = 0.1 they may make energy.",
    x=Axis("dt", r"$dt\,\sqrt{g/R}$"), y=Axis("restitution", "restitution e"), panels="friction",
    measures={"penetration": ("1", "largest overlap over the radius"), "energy_balance": ("1", "kinetic, potential and dissipated energy less the first, over the fall's"),
              "energy_gain": ("1", "largest kinetic and potential energy less the first, over the fall's"),
              "unconverged": ("1", "share of the steps that missed the tolerance")},
    grid=grid, searches=searches,
    marks={"1 ms at R = 1 cm": 1e-3 * math.sqrt(9.81 / 0.01)})
