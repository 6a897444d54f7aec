"""Map of springs in Contact Dynamics in a flow: time step against damping, for springs of two stiffnesses."""
from yade_scripts.measuring import filling
from yade_scripts.measuring.maps import Axis, Map, lines, logarithmic, product
from yade_scripts.measuring.maps.flow_md import DAMPING, STIFF
from yade_scripts.parameters import SPRING_TOLERANCE

MAP = Map(
    order=15,
    title="Flows: springs in Contact Dynamics",
    question="Which step, damping and stiffness give the height of a filling?",
    criterion=filling.CRITERION,
    remedy="Long steps are stable. Stiff springs miss their tolerance in some of them, with a message.",
    x=Axis("cd_dt", "step dt [s]"), y=Axis("beta_n", r"damping ratio $\beta_n$"), panels="kn", measures=filling.MEASURES,
    grid=lambda full: product(kn=STIFF[full], beta_n=DAMPING[full][::2] if full else DAMPING[full],
                              cd_dt=logarithmic(2.5e-4, 1.6e-2, 7) if full else (1e-3, 8e-3)),
    searches=lambda full: lines("cd_dt", 2.5e-4, 1.6e-2, 1.1 if full else 3.0, kn=STIFF[full][-1:], beta_n=DAMPING[full][::2]))


def probe(case):
    return filling.judge(method="CD", cd_contacts="springs", tolerance=SPRING_TOLERANCE, **case)
