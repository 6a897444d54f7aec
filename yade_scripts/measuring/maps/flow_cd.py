"""Map of CD in a flow: time step against tolerance, with and without a correction of overlaps."""
from yade_scripts.measuring import filling
from yade_scripts.measuring.maps import Axis, Map, lines, logarithmic, product

CORRECTION = {True: (0.0, 0.1), False: (0.0,)}  # of the full and of the quick map
STEPS = {True: logarithmic(2.5e-4, 1.6e-2, 7), False: (1e-3, 8e-3)}  # [s]

MAP = Map(
    order=14,
    title="Flows: rigid contacts",
    question="Which step and tolerance give the height of a filling?",
    criterion=filling.CRITERION + " The longest step is 13.3 ms, a third of the time between two samples.",
    remedy="What fails is the overlap, with a warning; a few steps miss 1e-4, with a message. In steps of 1 ms a "
           "tolerance of 0.1 still gives the height.",
    x=Axis("tolerance", "tolerance"), y=Axis("cd_dt", "step dt [s]"), panels="gap_correction", measures=filling.MEASURES,
    grid=lambda full: product(gap_correction=CORRECTION[full], cd_dt=STEPS[full], tolerance=logarithmic(1e-4, 1.0, 7) if full else (1e-3, 0.1)),
    searches=lambda full: lines("tolerance", 1e-4, 1.0, 1.2 if full else 5.0, gap_correction=CORRECTION[full], cd_dt=STEPS[full][:-2] or STEPS[full]))


def probe(case):
    return filling.judge(method="CD", **case)
