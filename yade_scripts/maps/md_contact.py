"""MD: the step against the damping, for one contact."""
from yade_scripts import spring_limits
from yade_scripts.maps import INACCURATE, STABLE, Axis, Map, Search, logarithmic, product

RATIOS = (0.25, 0.5, 1.0)
LAWS = ("standard", "avoid_ratcheting", "path_independent")


def grid(full):
    """omega_n dt by beta_n, a panel for each k_t/k_n; the other laws where they are searched."""
    steps, damping = ((logarithmic(0.05, 3, 15), logarithmic(0.01, 0.9, 9)) if full else (logarithmic(0.1, 3, 6), [0.01, 0.1, 0.5]))
    return product(kt_over_kn=RATIOS if full else RATIOS[1:], beta_n=damping, omega_dt=steps, tangential_law=LAWS[:1])


def searches(full):
    """Of instability, and of an error of a tenth in the way a contact swings."""
    damping = logarithmic(0.01, 0.9, 9) if full else [0.01, 0.1, 0.5]
    precision = 1.003 if full else 1.03
    found = [Search(at, "omega_dt", 0.2 if at["beta_n"] < 0.7 else 0.1, 3.5, precision, (STABLE, INACCURATE))
             for at in product(kt_over_kn=RATIOS if full else RATIOS[1:], beta_n=damping, tangential_law=LAWS[:1])
             + product(kt_over_kn=RATIOS[1:2], beta_n=[0.1], tangential_law=LAWS[1:])]
    return found + [Search(at, "omega_dt", 0.01, 1.5, 1.03) for at in product(kt_over_kn=RATIOS[1:2], beta_n=damping, tangential_law=LAWS[:1])]


MAP = Map(
    title="Springs: the step for one contact",
    question="How long a step does a spring with a dashpot bear, in YADE's scheme?",
    criterion="A disk pressed on a fixed one, free to move along the normal and to turn, is pushed by 1e-5 of its overlap. Unstable: its kinetic energy "
              "grows tenfold between the second and the last quarter of 1000 steps, or 1e6-fold in all. Inaccurate: decay or frequency of the normal "
              "motion off by more than a tenth.",
    remedy="The default, md_dt_factor = 0.2, is far below; dashpots, evaluated half a step late, err in the decay by a share of "
           "beta_n omega dt long before that.",
    x=Axis("omega_dt", r"$\omega_n\,dt$, $\omega_n=\sqrt{k_n/m}$"), y=Axis("beta_n", r"damping ratio $\beta_n$"), panels="kt_over_kn",
    measures={"growth": ("1", "largest kinetic energy of the last quarter over that of the second"),
              "decay_error": ("1", "of the decay a step of the normal motion, relative"),
              "frequency_error": ("1", "of its frequency, relative")},
    grid=grid, searches=searches, theory=lambda at: spring_limits.contact_limit(at["beta_n"], at["kt_over_kn"]),
    theory_label=r"$\min(2\sqrt{1+\beta_n^2}-2\beta_n,\ 2/\sqrt{2k_t/k_n})$", theory_along="omega_dt")
