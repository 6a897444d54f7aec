"""MD: the servo of the walls, its gain against the largest speed of the walls."""
from yade_scripts.maps import Axis, Map, Search, logarithmic, product


def grid(full):
    """gain by largest speed, a panel for each period of the load."""
    gains, speeds = ((logarithmic(0.25, 8, 11), logarithmic(1e-4, 1e2, 13)) if full else (logarithmic(0.5, 4, 4), logarithmic(1e-3, 1e2, 6)))
    return product(period=[0.2, 0.02] if full else [0.2], max_velocity=speeds, gain=gains)


def searches(full):
    """The gain at which the walls lock, and the speed below which they are too slow."""
    gain = [Search(at, "gain", 0.5, 8.0, 1.02 if full else 1.1) for at in product(period=[0.2], max_velocity=[0.1, 1.0, 10.0] if full else [1.0])]
    return gain + [Search(at, "max_velocity", 1.0, 1e-6, 1.05 if full else 1.5) for at in product(period=[0.2, 0.02] if full else [0.2], gain=[1.0])]


MAP = Map(
    title="The walls' servo",
    question="When do servo-driven walls carry their load, and is it noticed when they do not?",
    criterion="100 disks under one triangle of 0.2 P0, damping ratio 0.3, recorded 20 times as any run. Stress (mean of opposite walls) off its goal by more than 5 % of P0 in most samples of the second half: unstable (locked) if walls change direction at more than half the steps, else inaccurate (load missed); inaccurate too if the largest "
              "gamma is off by a tenth of that under gain 1. Told: the run ends with an error, as it must.",
    remedy="walls.servo keeps the gain at 1; a run whose walls carry another stress than asked for, more than 5 % of P0 off, ends with an error. "
           "Below that, where walls are slow or flip a little, nothing is said, and under a load of 0.2 P0 gamma was off by up to 38 %: look at "
           "'stress error/P0' of `python3 -m analysis summary`, which is a few 1e-3 at most where the servo works.",
    x=Axis("gain", r"gain $(1-\mathtt{stressDamping})\,2\beta_n\,\sqrt{m/k_n}/dt$"), y=Axis("max_velocity", "max_vel [m/s]"), panels="period",
    measures={"stress_error": ("1", "error of the worst wall's stress over P0, median of the second half"),
              "mean_stress_error": ("1", "the same of the means of opposite walls, which is what a history shows"),
              "reversals": ("1", "share of the steps at which wall y+ changes direction"), "largest_gamma": ("1", "largest |gamma|"),
              "strain_error": ("1", "of the largest |gamma|, relative to that under gain 1"), "samples": ("1", "taken before the run ended"),
              "theory": ("1", "gain at which walls begin to flip by a theory of equal disks")},
    grid=grid, searches=searches, marks={"largest that walls.servo sets": 1.0}, theory_label="flipping walls, equal disks", theory_along="gain")
