"""Map of MD in a flow: time step against damping, for springs of two stiffnesses."""
from yade_scripts.measuring import filling
from yade_scripts.measuring.maps import Axis, Map, lines, logarithmic, product

STIFF, DAMPING = {True: (2e6, 2e7), False: (2e6,)}, {True: (0.05, 0.1, 0.2, 0.4, 0.9), False: (0.2, 0.9)}  # of the full and of the quick map

MAP = Map(
    order=13,
    title="Flows: springs",
    question="Which step, damping and stiffness give the height of a filling?",
    criterion=filling.CRITERION,
    remedy="Above its limit a run ends as unstable. With weak damping disks rebound and pack more densely: another material, not an error of "
           "the step.",
    x=Axis("md_dt_factor", r"md_dt_factor $= dt/\sqrt{m_{\min}/k_n}$"), y=Axis("beta_n", r"damping ratio $\beta_n$"), panels="kn",
    measures=filling.MEASURES,
    grid=lambda full: product(kn=STIFF[full], beta_n=DAMPING[full], md_dt_factor=logarithmic(0.15, 1.0, 6 if full else 2)),
    searches=lambda full: lines("md_dt_factor", 0.15, 1.0, 1.1 if full else 2.0, kn=STIFF[full][-1:], beta_n=DAMPING[full]),
    marks={"default": 0.2})


def probe(case):
    return filling.judge(method="MD", md_energies=False, **case)
