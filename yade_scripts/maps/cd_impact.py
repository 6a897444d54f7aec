"""CD: restitution against friction, a disk thrown into a groove."""
from yade_scripts.maps import Axis, Map, Search, product


def grid(full):
    """restitution by friction."""
    return product(restitution=[0.0, 0.2, 0.4, 0.6, 0.8, 0.9, 0.95, 1.0] if full else [0.0, 0.5, 0.9, 1.0],
                   friction=[0.0, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 2.0] if full else [0.0, 0.1, 0.5, 1.0])


def searches(full):
    """The least restitution that makes energy."""
    return [Search(at, "restitution", 0.1, 1.0, 1.003 if full else 1.02) for at in product(friction=[0.1, 0.2, 0.3, 0.5] if full else [0.1, 0.5])]


MAP = Map(
    title="Rigid contacts: restitution with friction",
    question="Where does restitution together with friction make energy?",
    criterion="A disk with spin is thrown at the bottom of a groove, so that it hits both sides at once; 60 draws of angle, velocity and spin. Unstable: its "
              "kinetic energy exceeds the first by more than 1e-9 after one of the next six steps.",
    remedy="Laws of impact make energy in simultaneous impacts with friction (Kane and Levinson 1985) as e comes close to 1. The engine takes a smaller "
           "e in the islands of contacts that would make some, so there is no such boundary; what rebounds there is slower than e says.",
    x=Axis("restitution", "restitution e"), y=Axis("friction", r"friction $\mu$"), panels="",
    measures={"energy_gain": ("1", "largest kinetic energy over the first, less 1"), "draws_that_gain": ("1", "share of the draws")},
    grid=grid, searches=searches)
