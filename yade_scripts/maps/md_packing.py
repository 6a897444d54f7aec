"""MD: the step against the damping, for a packing."""
from yade_scripts.maps import Axis, Map, Search, logarithmic, product

RATIOS = (0.25, 0.5, 1.0)
LAWS = ("standard", "avoid_ratcheting", "path_independent")


def grid(full):
    """md_dt_factor by beta_n, a panel for each k_t/k_n."""
    steps, damping = ((logarithmic(0.1, 1.6, 13), logarithmic(0.01, 0.9, 7)) if full else (logarithmic(0.1, 1.6, 7), [0.01, 0.1, 0.5]))
    return product(kt_over_kn=RATIOS if full else RATIOS[1:2], beta_n=damping, md_dt_factor=steps, tangential_law=LAWS[:1])


def searches(full):
    """Of instability."""
    damping = logarithmic(0.01, 0.9, 7) if full else [0.01, 0.1, 0.5]
    precision = 1.005 if full else 1.03
    return [Search(at, "md_dt_factor", 0.1, 2.0, precision)
            for at in product(kt_over_kn=RATIOS if full else RATIOS[1:2], beta_n=damping, tangential_law=LAWS[:1])
            + product(kt_over_kn=RATIOS[1:2], beta_n=[0.1], tangential_law=LAWS[1:])]


MAP = Map(
    title="Springs: the step for a packing",
    question="How long a step does a packing under pressure bear, and does the largest eigenvalue of its stiffness tell?",
    criterion="A packing of 100 disks at rest under P0 between fixed walls, its contacts sticking, is pushed by 1e-5 of an overlap. Unstable: its kinetic "
              "energy grows tenfold between the second and the last quarter of 2000 steps, or 1e6-fold in all.",
    remedy="A run is refused above the limit of the springs it begins with: from a packing before the first step, of another scene in it. Springs that "
           "only form later are not asked; md_dt_factor of at most 0.25 serves any beta_n and k_t/k_n.",
    x=Axis("md_dt_factor", r"md_dt_factor $= dt/\sqrt{m_{\min}/k_n}$"), y=Axis("beta_n", r"damping ratio $\beta_n$"), panels="kt_over_kn",
    measures={"growth": ("1", "largest kinetic energy of the last quarter over that of the second"),
              "theory": ("1", "md_dt_factor at which dt^2 K + 2 dt C = 4 M has a solution, of the packing's matrices"),
              "bound": ("1", "md_dt_factor that is safe for every packing in which no disk is held more stiffly than here")},
    grid=grid, searches=searches, marks={"default": 0.2}, theory_label=r"largest eigenvalue of the packing", theory_along="md_dt_factor")
