"""A thousand cycles: does the strain of springs go on, does it end, and does the energy balance hold so long?"""
import numpy as np
import pandas

from analysis import cycles, observables, style, summary
from analysis.studies.fig3 import SPRINGS
from analysis.style import plt
from yade_scripts.tables import product

TITLE = "A thousand cycles"
QUESTION = ("Forty cycles do not show whether a falling strain rate reaches zero. What do springs do in a thousand, under the standard and the "
            "path-independent law, and does their energy balance hold so long?")
ORDER = 9.5  # in the report
EDGES = (0, 1, 2, 5, 10, 20, 50, 100, 200, 500, 625, 750, 875, 1000)  # last cycles of the windows
BASE = SPRINGS | dict(delta_sigma=0.4)
SLOW = dict(period=2.0)  # 0.5 s is short for springs of k_n (study of ratcheting)
LINES = "-", "--", ":"  # of the packings
LOOK = {("standard", SPRINGS["period"]): ("#1A1A1A", "standard law"),  # colours of the laws as in their study
        ("path_independent", SPRINGS["period"]): ("#CC79A7", "path-independent law"),
        ("standard", SLOW["period"]): ("#0072B2", "standard law, cycles of 2 s")}
ROWS = {"quick": product(cycles=20, **BASE),
        "full": product(tangential_law="standard", seed=(1, 2, 3), cycles=1000, **BASE)
        + product(tangential_law="path_independent", seed=(1, 2, 3), cycles=1000, **BASE)
        + product(tangential_law="standard", seed=(1, 2, 3), cycles=100, **BASE | SLOW)}


def summarize(runs):
    """Return one row a run and window of cycles: strain and rate there, and the error of the energy balance up to its end.

    rate error: standard error of the mean rate, from the means of ten blocks of cycles. balance error: over the work of the walls up to there.
    """
    rows = []
    for run in runs:
        found, ends, same = cycles.of(run), cycles.ends(run), summary.columns(run, "law", "period", "seed", "load over limit")
        edges = [cycle for cycle in EDGES if cycle < len(found.number)] + [len(found.number)]
        for first, last in zip(edges[:-1], edges[1:]):
            rate = found.rate[first:last]
            rows.append(same | {
                "from cycle": first + 1, "to cycle": last, "|gamma|": abs(found.gamma[last]), "rate": found.rates([(first + 1, last)])[0],
                "rate error": cycles.error_of_mean(rate), "largest cycle": np.abs(rate).max(), "median cycle": np.median(np.abs(rate)),
                "dissipated/P0V0 a cycle": found.dissipated[first:last].mean(), "sliding at most": found.sliding_max[first:last].max(),
                "2M/N": found.contacts[last - 1], "balance error": observables.balance_error(run, slice(0, ends[last] + 1)), "outcome": run.outcome})
    return rows


def draw(runs, rows, path):
    """Draw the strain, and the strain of each cycle, against the number of the cycle."""
    fig, (left, right) = plt.subplots(1, 2, figsize=(9, 3.9))
    table = pandas.DataFrame(rows)
    for run in runs:
        law, period, seed = (run.parameters[name] for name in ("tangential_law", "period", "seed"))
        found, (colour, words), line = cycles.of(run), LOOK[law, period], LINES[(seed - 1) % len(LINES)]
        left.plot(found.number, np.abs(found.permanent), color=colour, ls=line, label=words if seed == 1 else None)
        means = table[(table.law == law) & (table.period == period) & (table.seed == seed)]
        middle, known = np.sqrt(means["from cycle"] * means["to cycle"]), (means.rate.abs() > 2 * means["rate error"]) | (means["to cycle"] <= 10)
        right.plot(middle, means.rate.abs(), color=colour, ls=line)
        for part, face in ((known, colour), (~known, "w")):
            right.plot(middle[part], means.rate.abs()[part], ls="", marker="o", ms=3, color=colour, mfc=face)
    for axis, label in ((left, r"accumulated strain $|\gamma|$"), (right, r"strain of a cycle $|\Delta\gamma|$")):
        axis.set(xscale="log", yscale="log", xlabel="cycle", ylabel=label)
    left.legend(loc="lower right")
    style.finish(fig, path, "Springs of $k_n$, cycles of 0.5 s unless named; a packing has one kind of line. "
                 "Right: means over the cycles 1, 2, 3 to 5, 6 to 10 and so on; from cycle 11 on, open: less than two standard errors.", runs)


ANSWER = """
A thousand cycles cannot be predicted from tens of them. Under dSigma = 0.4 three packings stand 1000 cycles at 0.87 to 0.95 of their static limits.
Packings 2 and 3 strain steadily at first, by 9.0e-5 and 2.0e-4 a cycle in cycles 11 to 20. Before cycle 100 this is over. In packing 1 the rate falls
from 1.8e-5 in cycles 6 to 10 to 3.0e-6 in cycles 51 to 100. Then a burst comes: in cycles 201 to 500 it strains by 1.6e-3, as much as in the first
100, and by up to 2.4e-5 in one cycle.

In cycles of 0.5 s the strain dies out in the end, or nearly so. Over the last 250 cycles the means are 1.1e-7, 2.4e-8 and 1.2e-7 a cycle, with
standard errors of 4.0e-8, 7.9e-8 and 5.8e-8. Packing 3 strained for hundreds of cycles at a small rate that stayed within a factor of two, which the
paper calls constant: by 1.0e-6 a cycle in cycles 101 to 200 (standard error 3.0e-7), 5.8e-7 in 201 to 500 (9.3e-8), 8.0e-7 in 501 to 625 (4.2e-7) and
1.2e-6 in 626 to 750 (1.9e-7). Then this falls to a tenth. In all three packings single cycles still strain by 1.4e-6 to 3.2e-6 (medians of the last
125) in either direction, which nearly cancels in the sum. After 40 cycles one cannot say whether a packing shakes down.

Garcia-Rojo, Alonso-Marroquin and Herrmann (2005) report that after a short transient the strain a cycle no longer depends on the number of cycles.
Here it does: such stretches occur, but each of them ends, in cycles of 0.5 s by a fall and in cycles of 2 s by a burst.

Under the path-independent law, whose closed paths leave neither force nor energy, all three packings do the same, including the bursts and the end:
after each of the 13 numbers of cycles in the table they have strained 0.98 to 1.00 times as far. So the tangential law causes neither.

In cycles of 2 s, which the springs follow more closely, packings 1 and 2 have strained 0.79 and 0.61 times as far after 100 cycles, by 9.8e-7 and
8.3e-6 a cycle in cycles 51 to 100. Packing 3 strains at a constant rate there: by 5.5e-5 a cycle in cycles 11 to 20 (standard error 8.8e-7) and
6.1e-5 in 21 to 50 (3.2e-6). Then it strains faster, by 1.5e-4 in cycles 51 to 100 (6.5e-5; 1.4e-3 of it in one cycle), and has then strained 1.01
times as far as in cycles of 0.5 s. These runs end there: whether the strain dies out in slow cycles, too, is not known. The error of the energy
balance is 8.1e-5 of the work at most.
"""
GIVEN = ("0.4", "1", "2", "3", "6", "10", "11", "20", "21", "50", "51", "100", "101", "125", "200", "201", "250", "500", "501", "625", "626", "750",
         "40", "0.5", "1000")


def numbers(table):
    packing = {key: own.set_index("to cycle") for key, own in table.groupby(["law", "period", "seed"])}
    one, two, three = fast = [packing["standard", SPRINGS["period"], seed] for seed in (1, 2, 3)]
    slow = [packing["standard", SLOW["period"], seed] for seed in (1, 2, 3)]
    rates, bars, strain, steady = [own.rate.abs() for own in fast], [own["rate error"] for own in fast], one["|gamma|"], slow[2]
    last = [abs(own.rate[[875, 1000]].mean()) for own in fast]
    errors = [np.hypot(*own["rate error"][[875, 1000]]) / 2 for own in fast]
    alike = [packing["path_independent", SPRINGS["period"], seed]["|gamma|"] / own["|gamma|"] for seed, own in zip((1, 2, 3), fast)]
    later = [own["|gamma|"][100] / usual["|gamma|"][100] for own, usual in zip(slow, fast)]
    return {**summary.stated("0.87 0.95", table["load over limit"]), "9.0e-5": rates[1][20], "2.0e-4": rates[2][20],
            "1.8e-5": rates[0][10], "3.0e-6": rates[0][100],
            "1.6e-3": [strain[500] - strain[200], strain[100]], "2.4e-5": one["largest cycle"][500],
            "1.1e-7": last[0], "2.4e-8": last[1], "1.2e-7": last[2],
            "4.0e-8": errors[0], "7.9e-8": errors[1], "5.8e-8": errors[2],
            "1.0e-6": rates[2][200], "3.0e-7": bars[2][200], "5.8e-7": rates[2][500], "9.3e-8": bars[2][500], "8.0e-7": rates[2][625],
            "4.2e-7": bars[2][625], "1.2e-6": rates[2][750], "1.9e-7": bars[2][750],
            **summary.stated("1.4e-6 3.2e-6", [own["median cycle"][1000] for own in fast]),
            "13": [len(own) for own in alike], **summary.stated("0.98 1.00", pandas.concat(alike)), "0.79": later[0], "0.61": later[1],
            "9.8e-7": slow[0].rate.abs()[100], "8.3e-6": slow[1].rate.abs()[100],
            "5.5e-5": steady.rate.abs()[20], "8.8e-7": steady["rate error"][20], "6.1e-5": steady.rate.abs()[50], "3.2e-6": steady["rate error"][50],
            "1.5e-4": steady.rate.abs()[100], "6.5e-5": steady["rate error"][100], "1.4e-3": steady["largest cycle"][100], "1.01": later[2],
            "8.1e-5": table["balance error"].abs().max()}
