"""Three thousand cycles by springs in Contact Dynamics, checked against MD's thousand, and rigid contacts: regimes, and sudden compactions."""
from pathlib import Path

import numpy as np
import pandas

from analysis import cycles, limits, publish, style
from analysis.studies import fig3
from analysis.studies.implicit import COLOUR, MD, RIGID, SPRINGS, kind
from analysis.style import plt
from yade_scripts.tables import product

PUBLISHED = Path(__file__).resolve().parents[1] / "published"
TITLE = "What happens in three thousand cycles?"
QUESTION = "Three packings under dSigma = 0.4, sigma1 held, in cycles of 0.5, 2 and (one packing) 8 s."
ORDER = 3.3  # in the report
LOAD = dict(delta_sigma=0.4)
SHARE = 400  # steps of springs in a cycle
PERIODS, COUNT, FEWER = (0.5, 2.0), 3000, 1000
SLOWEST = dict(period=8.0, cd_dt=1e-2, cycles=500)
SEEDS = 1, 2, 3
SOFT = fig3.LOADING | dict(method="CD", cd_contacts="springs") | LOAD
SELDOM = dict(records_per_cycle=4)  # a sample costs as much as some thirty steps
# Three times MD's default step: stable where a servo moves the walls, not with light walls that are pushed.
SERVO = fig3.SPRINGS | LOAD | dict(md_walls="servo", md_dt_factor=0.6)
RIGID_ROW = fig3.RIGID | LOAD
CHECK = {0.5: 1000, 2.0: 100}  # cycles of MD by period [s], in the study of a thousand cycles
SERVO_COUNT = 300
CHECKED = SOFT | SELDOM | dict(seed=1)  # the packing whose rate stays the same from cycle 1001 on
UNTIL = {0.5: 2 * FEWER, 2.0: 1500}  # cycles of its checks, by period
USUAL, FINER = 0.1, 0.01  # tolerance
CHECKS = ((1, FINER), (2, USUAL))  # what the late rates owe to tolerance and step: in how many parts a step is divided, and the tolerance
SHORT = ((4, USUAL), (8, USUAL), (4, FINER))  # steps from which on the step does not matter any more
APART = dict(seed=3, cycles=750)  # the packing on which springs in Contact Dynamics and MD part after some hundred cycles
NO_SLIP = dict(friction=1.0, pressure_ratio=6e-3, period=2.0)  # where McNamara et al. (2008) see ratcheting without sliding
NO_SLIP_COUNT, NO_SLIP_CHECK = 300, 100  # cycles by springs in Contact Dynamics and by MD, whose law causes it
NO_SLIP_SEED = 2  # of the packing whose rate is the largest, for the same checks
ROWS = {"quick": [SOFT | dict(cd_dt=PERIODS[0] / SHARE, cycles=40, seed=1), RIGID_ROW | dict(cycles=10, seed=1)],
        "full": [row for period in PERIODS
                 for row in product(**SOFT | SELDOM | dict(period=period, cd_dt=period / SHARE, cycles=COUNT, seed=SEEDS))]
        + [RIGID_ROW | SELDOM | dict(cycles=COUNT, seed=SEEDS[0])] + product(**RIGID_ROW | SELDOM, cycles=FEWER, seed=SEEDS[1:])
        + [CHECKED | dict(period=period, cycles=UNTIL[period], cd_dt=period / SHARE / parts, tolerance=tolerance)
           for period in PERIODS for parts, tolerance in CHECKS]
        + [CHECKED | APART | dict(cd_dt=PERIODS[0] / SHARE / parts, tolerance=tolerance) for parts, tolerance in (*CHECKS, *SHORT)]
        + product(**SOFT | SELDOM | dict(cd_dt=PERIODS[0] / SHARE / SHORT[0][0], cycles=APART["cycles"], seed=SEEDS[:2]))
        + [fig3.SPRINGS | LOAD | SELDOM | APART | dict(md_dt_factor=fig3.SPRINGS["md_dt_factor"] / 2)]
        + [SOFT | SLOWEST | dict(seed=SEEDS[0])]
        + product(**SERVO, cycles=SERVO_COUNT, seed=SEEDS)
        + product(**SOFT | NO_SLIP | dict(cd_dt=2.0 / SHARE), cycles=NO_SLIP_COUNT, seed=SEEDS)
        + [fig3.SPRINGS | LOAD | NO_SLIP | dict(cycles=NO_SLIP_CHECK, seed=NO_SLIP_SEED)]
        + [SOFT | NO_SLIP | dict(cycles=NO_SLIP_COUNT, seed=NO_SLIP_SEED) | change
           for change in (dict(cd_dt=2.0 / SHARE, tolerance=FINER), dict(cd_dt=1.0 / SHARE))]}
EDGES = (0, 1, 2, 5, 10, 20, 50, 100, 200, 300, 500, 750, 1000, 1500, 2000, 2500, 3000)  # last cycles of the windows


def medium(run):
    """Return which grains a run has, with its walls where a servo moves them."""
    return kind(run) + (", servo" if run.method == "MD" and run.parameters["md_walls"] == "servo" else "")


def summarize(runs):
    """Return one row a run and window of cycles. rate: mean strain a cycle, positive where the sample goes on shortening along axis 2; rate error:
    its standard error, from ten blocks of cycles. largest cycle: the largest strain of one cycle, and in which cycle. compaction: loss of volume
    over the window."""
    rows = []
    for run in runs:
        found = cycles.of(run)
        volume = ((1 + run.values("strain1")) * (1 + run.values("strain2")))[found.ends]
        row = run.parameters
        same = {"medium": medium(run), "law": row["tangential_law"], "friction": row["friction"], "usual": usual_step(row),
                "tolerance": row["tolerance"], "period": row["period"], "packing": row["seed"],
                "step_s": row["cd_dt"] if run.method == "CD" else np.nan, "load over limit": limits.load_over_limit(run)}
        edges = [cycle for cycle in EDGES if cycle < len(found.number)] + [len(found.number)]
        for first, last in zip(edges[:-1], edges[1:]):
            rate = -found.rate[first:last]
            largest = int(np.argmax(np.abs(rate)))
            rows.append(same | {
                "from cycle": first + 1, "to cycle": last, "|gamma|": abs(found.gamma[last]), "rate": rate.mean(),
                "rate error": cycles.error_of_mean(rate), "largest cycle": abs(rate[largest]), "in cycle": int(found.number[first + largest]),
                "compaction": volume[first] - volume[last], "sliding at most": found.sliding_max[first:last].max(), "2M/N": found.contacts[last - 1],
                "seconds": float(run.values("processor_time")[found.ends[last]]), "outcome": run.outcome})
    return rows


def draw(runs, rows, path):
    """Draw the strain against the number of the cycle for one period, and the strain a cycle for all periods."""
    fig, (left, right) = plt.subplots(1, 2, figsize=(10, 4.2))
    table = pandas.DataFrame(rows)
    usual = table[table.medium.isin((SPRINGS, RIGID)) & table.usual]
    for packing, own in usual[(usual.medium == SPRINGS) & (usual.period == PERIODS[0])].groupby("packing"):
        left.plot(own["to cycle"], own["|gamma|"], color=COLOUR[SPRINGS], marker=".", ms=5, label=SPRINGS if packing == SEEDS[0] else None)
        known = molecular()[PERIODS[0]][packing]
        left.plot(known.index, known, ls="", marker="o", mfc="none", color=COLOUR[MD], label=MD if packing == SEEDS[0] else None)
    for (which, period, packing), own in usual.groupby(["medium", "period", "packing"]):
        middle = np.sqrt(own["from cycle"] * own["to cycle"])
        label = (f"{which}, {period:g} s" if which == SPRINGS else which) if packing == SEEDS[0] else None
        colour, unsure = COLOUR[which] if which == RIGID else SHADE[period], own.rate.abs() < 2 * own["rate error"]
        right.plot(middle, own.rate.abs(), color=colour, marker=".", ms=5, lw=1, label=label)
        right.plot(middle[unsure], own.rate.abs()[unsure], color=colour, marker=".", ms=5, mfc="white", ls="")
    for axis, label in ((left, r"accumulated strain $|\gamma|$"), (right, r"strain of a cycle $|\Delta\gamma|$")):
        axis.axvline(EVENT, color="k", lw=0.8, ls=":")
        axis.set(xscale="log", yscale="log", xlabel="cycle", ylabel=label)
        axis.legend(loc="upper left" if axis is left else "lower left")
    right.set_ylim(bottom=1e-14)  # room for the words
    left.text(EVENT, 0.02, f"N = {EVENT} ", transform=left.get_xaxis_transform(), ha="right", fontsize=8)
    left.set_title("cycles of 0.5 s")
    right.set_title("means over windows of cycles")
    style.finish(fig, path, "Each line is a packing. Dotted: the cycle in which the paper names a sudden compression. Open dots: not different from "
                 "zero (less than two standard errors). Rigid packings rest: what is drawn is the error of the solver.", runs)


def molecular():
    """Return {period: {packing: |gamma| at the end of each window of cycles}} of MD with the standard law, of the study of a thousand cycles."""
    table = publish.read_table(PUBLISHED / "thousand.csv")
    own = table[table.law == "standard"].set_index("to cycle")
    return {period: {packing: rows["|gamma|"] for packing, rows in several.groupby("seed")} for period, several in own.groupby("period")}


EVENT = 2700  # the paper's "N = 2700"
SHADE = {0.5: style.GREEN, 2.0: style.LIME, 8.0: style.OLIVE}  # of springs in Contact Dynamics, by period [s]
STANDING = 500  # cycles after which the rates are compared


def usual_step(row):
    """Return whether a run has the usual step and tolerance, and the usual friction."""
    halved = row["period"] in PERIODS and row["cd_dt"] < 0.9 * row["period"] / SHARE
    usual = row["method"] == "MD" or row["cd_contacts"] == "rigid" or (row["tolerance"] == USUAL and not halved)
    return usual and row["friction"] != NO_SLIP["friction"]


def of_step(rows, step, tolerance):
    """Return the rows of springs in Contact Dynamics with a step [s] and a tolerance."""
    return rows[(rows.medium == SPRINGS) & np.isclose(rows.step_s, step) & np.isclose(rows.tolerance, tolerance)]


def mean_rate(rows, first, last):
    """Return the mean strain a cycle of a run from cycle `first` + 1 to `last`, which are ends of windows, and its standard error."""
    own = rows[(rows["from cycle"] > first) & (rows["to cycle"] <= last)]
    count = own["to cycle"] - own["from cycle"] + 1
    return (own.rate * count).sum() / count.sum(), np.sqrt(((own["rate error"] * count)**2).sum()) / count.sum()


POINTS = (
    (12, "A sudden compression is perceived N = 2700, after which the deformation rate seems to grow in each cycle.", "section 3",
     "agrees in part"),
)


def quantities(table):
    soft, rigid = table[(table.medium == SPRINGS) & table.usual], table[table.medium == RIGID]
    at, md = table[table.usual].set_index(["medium", "period", "packing", "to cycle"]).sort_index()["|gamma|"], molecular()
    over_md = {period: pandas.Series([at[SPRINGS, period, seed, count] / md[period][seed][count] for seed in SEEDS])
               for period, count in CHECK.items()}
    servo = pandas.Series([at[f"{MD}, servo", 0.5, seed, 200] / md[0.5][seed][200] for seed in SEEDS])
    late = soft[soft["from cycle"] > STANDING]
    burst = soft[soft["from cycle"] > 20].sort_values("largest cycle").iloc[-1]
    last = soft[soft["to cycle"] == COUNT]
    around = soft[(soft["from cycle"] <= EVENT) & (soft["to cycle"] >= EVENT)]
    strain = soft[soft.period.isin(PERIODS)].set_index(["period", "packing", "to cycle"])["|gamma|"]
    share = strain.xs(STANDING, level="to cycle") / strain.xs(COUNT, level="to cycle")
    glued, checked = table[table.friction == NO_SLIP["friction"]], table[(table.friction < 1) & (table.packing == CHECKED["seed"])]
    unslipped = {seed: mean_rate(rows, 20, NO_SLIP_COUNT) for seed, rows in of_step(glued, 2.0 / SHARE, USUAL).groupby("packing")}
    glued_rates = pandas.Series({seed: rate for seed, (rate, _) in unslipped.items()})
    same = glued[glued.packing == NO_SLIP_SEED]
    glued_finer = mean_rate(of_step(same, 2.0 / SHARE, FINER), 20, NO_SLIP_COUNT)[0]
    glued_md = mean_rate(same[same.medium == MD], 20, NO_SLIP_CHECK)
    checks = {period: [mean_rate(of_step(checked[checked.period == period], period / SHARE / parts, tolerance), FEWER, UNTIL[period])
                       for parts, tolerance in ((1, USUAL), *CHECKS)] for period in PERIODS}
    known = publish.read_table(PUBLISHED / "thousand.csv")
    # Rates are positive here where the sample goes on shortening, and negative in that study.
    known = known[(known.law == "standard") & (known.period == PERIODS[0])].assign(packing=known.seed, rate=-known.rate)
    parted, until = table[(table.period == PERIODS[0]) & (table.friction < 1)], APART["cycles"]
    whole = lambda rows: tuple((until - 100) * value for value in mean_rate(rows, 100, until))  # strain of cycles 101 to `until`, and its error
    apart = {parts: {seed: whole(rows) for seed, rows in of_step(parted, PERIODS[0] / SHARE / parts, USUAL).groupby("packing")}
             for parts in (1, 2, 4, 8)}
    md_apart = {seed: whole(rows) for seed, rows in known.groupby("packing")}
    half_apart = whole(parted[(parted.medium == MD) & (parted.packing == APART["seed"])])
    finer_apart = whole(of_step(parted[parted.packing == APART["seed"]], PERIODS[0] / SHARE / SHORT[-1][0], FINER))
    # Half of MD's step does not change its strain, nor an eighth of CD's step and a tolerance of a tenth what a quarter gives.
    assert all(abs(one[0] - other[0]) < 2 * np.hypot(one[1], other[1]) for one, other in (
        (half_apart, md_apart[3]), (apart[8][3], apart[4][3]), (finer_apart, apart[4][3])))
    latest = max(late.rate.abs().max(), known[known["from cycle"] > STANDING].rate.abs().max())
    steady = {period: mean_rate(soft[(soft.period == period) & (soft.packing == CHECKED["seed"])], FEWER, COUNT) for period in PERIODS}
    assert abs(glued_finer) < 0.3 * abs(glued_rates[NO_SLIP_SEED]) and checks[0.5][1][0] < 0.5 * checks[0.5][0][0]
    assert last["in cycle"].size == 6 and set(soft.outcome) == {"completed"}
    assert late.rate.abs().max() < soft[soft["to cycle"] <= 50].rate.min()
    return locals() | {name: globals()[name] for name in (
        "APART", "CHECK", "CHECKED", "EVENT", "UNTIL", "STANDING", "COUNT", "FEWER", "NO_SLIP_COUNT", "NO_SLIP_CHECK", "NO_SLIP_SEED")}
