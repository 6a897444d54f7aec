"""Three thousand cycles by springs in Contact Dynamics and by rigid contacts, checked against MD on a part: regimes, and sudden compactions."""
import numpy as np
import pandas

from analysis import cycles, limits, style, summary
from analysis.studies import fig3
from analysis.studies.implicit import COLOUR, MD, RIGID, SPRINGS, kind
from analysis.style import plt
from yade_scripts.tables import product

TITLE = "What happens in three thousand cycles?"
QUESTION = "Three packings under dSigma = 0.4, sigma1 held; springs in Contact Dynamics with periods of 0.5, 2 and 8 s, rigid contacts, and MD for a part."
ORDER = 3.3  # in the report
LOAD = dict(delta_sigma=0.4)
SHARE = 400  # steps of springs in a cycle
PERIODS, COUNT, FEWER = (0.5, 2.0), 3000, 1000
SLOWEST = dict(period=8.0, cd_dt=1e-2, cycles=FEWER)
SEEDS = 1, 2, 3
SOFT = {name: value for name, value in fig3.LOADING.items()} | dict(method="CD", cd_contacts="springs") | LOAD
# MD's answer holds to 0.3 % up to this step (study of three methods).
MOLECULAR = fig3.SPRINGS | LOAD | dict(md_dt_factor=0.6)
RIGID_ROW = fig3.RIGID | LOAD
PART = {0.5: 300, 2.0: 100}  # cycles of MD by period
ROWS = {"quick": [SOFT | dict(cd_dt=PERIODS[0] / SHARE, cycles=40, seed=1), RIGID_ROW | dict(cycles=10, seed=1), MOLECULAR | dict(cycles=10, seed=1)],
        "full": [row for period in PERIODS
                 for row in product(**SOFT | dict(period=period, cd_dt=period / SHARE, cycles=COUNT, seed=SEEDS))]
        + product(**SOFT | SLOWEST | dict(seed=SEEDS)) + product(**RIGID_ROW, cycles=COUNT, seed=SEEDS)
        + [row for period, count in PART.items() for row in product(**MOLECULAR | dict(period=period, cycles=count, seed=SEEDS))]
        + product(**MOLECULAR | dict(md_walls="servo"), cycles=PART[0.5], seed=SEEDS)}
