"""Both methods: speed against the thickness of a wall that must stop a disk."""
import math

from yade_scripts.maps import INACCURATE, STABLE, Axis, Map, Search, logarithmic, product

KINDS = ("MD", "CD", "CD e=0.5", "CD from near", "CD colliderMargin=0")


def grid(full):
    """speed by thickness, a panel for each way of computing."""
    speeds, thicknesses = (logarithmic(0.01, 100, 13), logarithmic(0.01, 10, 4)) if full else (logarithmic(0.01, 100, 5), [0.1, 1.0])
    return product(kind=KINDS, thickness=thicknesses, speed=speeds)


def searches(full):
    """The speed that gets through."""
    return [Search(at, "speed", 0.01, 1000.0, 1.02 if full else 1.1, (STABLE, INACCURATE)) for at in product(kind=KINDS, thickness=logarithmic(0.01, 10, 4) if full else [0.1, 1.0])]


def turning(at):
    """Of springs: the speed, in R sqrt(k_n/m), at which the centre reaches the wall's mid-plane, where a box turns its normal round."""
    return 1 + at["thickness"] / 2 if at["kind"] == "MD" else math.nan


MAP = Map(
    title="Both methods: a disk thrown at a wall",
    question="How fast must a disk be to get through a wall?",
    criterion="A disk flies at a fixed box without gravity, from four distances of two to three ways of a step (from near: 0.1 to 0.4); springs without dashpots, md_dt_factor 0.2. Unstable: it is beyond the box. Inaccurate: it overlaps the box by more "
              "than half its radius on the way.",
    remedy="With colliderMargin above 0, as cd_engine.engines sets it, a rigid disk is stopped at any speed. Contact is looked for at mid-step: if its "
           "flight begins, or another engine gives it its speed, within half a step's way of the wall, it overlaps the wall by up to its radius from "
           "then on. Springs need v sqrt(m/k_n) below R, and an overlap below a tenth of it to mean anything: k_n above 100 m v^2/R^2.",
    x=Axis("speed", r"$v\sqrt{m/k_n}/R$ (MD), $v\,dt/R$ (CD)"), y=Axis("thickness", "thickness of the wall / R"), panels="kind",
    measures={"through": ("1", "share of the four that got through"), "penetration": ("1", "largest overlap over the radius")},
    grid=grid, searches=searches, theory=turning,
    theory_label="springs: the centre\npasses the mid-plane", theory_along="speed")
