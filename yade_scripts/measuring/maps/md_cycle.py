"""Map of MD: time step against load, for a load cycle of a packing, of three periods."""
import math

from yade_scripts.measuring.maps import Axis, INACCURATE, Map, UNSTABLE, judged, lines, logarithmic, product

FINEST = 0.02  # md_dt_factor of the truth
OFF, FAR_OFF = 0.01, 0.5
PERIODS, LOADS = {True: (0.25, 1.0, 4.0), False: (0.25,)}, {True: (0.05, 0.1, 0.2, 0.3, 0.4), False: (0.1, 0.4)}  # of the full and of the quick map

MAP = Map(
    order=2,
    title="Springs: the step of a load cycle",
    question="How long a step does the strain of a load cycle allow?",
    criterion="100 disks, one cycle, walls pushed by forces. Inaccurate: the strain at the peak of the load or the one that remains differs from "
              "that with a fiftieth of sqrt(m/k_n) by more than 1 % of the strain at the peak. Unstable: by more than 50 %, or the run ends as "
              "unstable.",
    remedy="Up to its stability limit the step hardly matters; above it the run ends as unstable.",
    x=Axis("md_dt_factor", r"md_dt_factor $= dt/\sqrt{m_{\min}/k_n}$"), y=Axis("delta_sigma", r"load $\Delta\sigma$"), panels="period",
    measures={"peak_error": "strain at the peak, less the true one, over the latter", "rest_error": "the same of the strain that remains"},
    grid=lambda full: product(period=PERIODS[full], delta_sigma=LOADS[full], md_dt_factor=logarithmic(0.1, 1.0, 9 if full else 4)),
    searches=lambda full: lines("md_dt_factor", 0.1, 1.0, 1.05 if full else 1.3, period=PERIODS[full], delta_sigma=LOADS[full]),
    marks={"default": 0.2})


def probe(case):
    from cd_engine import watching
    from yade_scripts.measuring import packing_cycle
    row, told, errors = dict(method="MD", md_walls="force"), "", [math.nan] * 2
    try:
        errors = packing_cycle.errors(packing_cycle.cycle(**row, **case), **row | case | {"md_dt_factor": FINEST})
    except watching.Unstable as error:
        told = str(error)
    worst = max(map(abs, errors))
    return judged(dict(zip(("peak_error", "rest_error"), errors)), told, (UNSTABLE, "energy growth", bool(told)),
                  (UNSTABLE, "wrong motion", not worst <= FAR_OFF), (INACCURATE, "wrong motion", worst > OFF))
