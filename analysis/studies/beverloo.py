"""Does the discharge of a silo follow Beverloo's law in the plane, and do both methods give the same law?"""
import matplotlib.pyplot as plt
import numpy as np
import pandas

from analysis import observables, style, summary
from yade_scripts.tables import product

TITLE = "Discharge against the width of the slot"
QUESTION = "Do rigid contacts and springs follow Beverloo's law in the plane, (D - k d)^(3/2), with the same k?"
ORDER = 31  # in the report
PART = "engine"
PERIOD = {6: 6.5, 8: 4.0, 10: 3.0, 14: 1.8, 20: 1.2}  # s, by the width of the slot in diameters: until half of 2000 disks have left
RIGID, SPRINGS = dict(method="CD", cd_dt=1e-3, tolerance=1e-3), dict(method="MD", md_dt_factor=0.3, kn=2e7, md_energies=False)
ROWS = {"quick": product(scene="hopper", disks=500, slot=(6, 8, 10), period=3.0, seed=1, method="CD", cd_dt=2e-3, tolerance=1e-2),
        "full": [row for settings, seeds in ((RIGID, range(1, 5)), (SPRINGS, range(1, 5)))
                 for slot, period in PERIOD.items() for row in product(scene="hopper", disks=2000, slot=slot, period=period, seed=seeds, **settings)]}


def summarize(runs):
    """Return one row a method and width.

    rate: disks that leave in a time sqrt(d/g), mean over the seeds; deviation: its standard error. width: of the slot, in diameters. law: the rate
    by Beverloo's law C (D/d - k)^(3/2), where C and k come from a straight line fitted to rate^(2/3) at all widths of the method. unsolved: share
    of the steps of rigid contacts that missed the tolerance. Runs that end before half of the disks have left show no rate.
    """
    rows, runs = [], [run for run in runs if not run.not_shown]
    for (method, slot), group in summary.groups(runs, lambda run: (run.method, run.parameters["slot"])).items():
        rates = np.array([float(run.extra["rate"]) for run in group]) / np.sqrt(slot)  # the scene counts in sqrt(D/g)
        rows.append({"method": method, "width": slot, "rate": float(rates.mean()), "seeds": len(rates),
                     "unsolved": _unsolved(group) if method == "CD" else 0.0,
                     "deviation": float(rates.std(ddof=1) / np.sqrt(len(rates))) if len(rates) > 1 else np.nan})
    for method in {row["method"] for row in rows}:
        own = [row for row in rows if row["method"] == method]
        slope, shift = np.polyfit([row["width"] for row in own], [row["rate"]**(2 / 3) for row in own], 1) if len(own) > 1 else (np.nan, np.nan)
        for row in own:
            row |= {"C": slope**1.5, "k": -shift / slope, "law": (slope * row["width"] + shift)**1.5}
    return rows


def _unsolved(runs):
    return sum(observables.unconverged_steps(run) for run in runs) / sum(run.values("time")[-1] / run.parameters["cd_dt"] for run in runs)


def draw(runs, rows, path):
    """Draw rate^(2/3) against the width of the slot with the lines of the law."""
    table = pandas.DataFrame(rows)
    fig, axes = plt.subplots(figsize=(7.6, 4.0))
    for method, own in table.groupby("method"):
        bars = 2 / 3 * own.rate**(-1 / 3) * own.deviation.fillna(0)
        axes.errorbar(own.width, own.rate**(2 / 3), bars, ls="", marker=style.MARKER[method], mfc="none", color=style.COLOUR[method], label=method)
        widths = np.array([own.k.iloc[0], own.width.max()])
        axes.plot(widths, own.C.iloc[0]**(2 / 3) * (widths - own.k.iloc[0]), color=style.COLOUR[method], lw=1)
    axes.set(xlabel="width of the slot, in diameters", ylabel=r"(disks in $\sqrt{d/g}$)$^{2/3}$", xlim=(0, None), ylim=(0, None))
    axes.legend()
    style.finish(fig, path, "Means over the seeds with standard errors; lines: Beverloo's law in the plane, fitted.", runs)


def _fit(own, power):
    """Return (k, the largest relative miss) of the line through rate^(1/power)."""
    slope, shift = np.polyfit(own.index, own.rate**(1 / power), 1)
    return -shift / slope, np.abs((slope * own.index + shift)**power / own.rate - 1).max()


def _error_of_k(own):
    """Return the standard error of k by those of the rates."""
    bars, (slope, shift) = 2 / 3 * own.deviation * own.rate**(-1 / 3), np.linalg.pinv(np.vander(own.index, 2))
    return np.sqrt((((shift + own.k.iloc[0] * slope) * bars)**2).sum()) / own.C.iloc[0]**(2 / 3)


def _chi_square(own):
    """Return chi^2 a degree of freedom of the line through rate^(2/3), weighted by the standard errors."""
    rates, bars = own.rate**(2 / 3), 2 / 3 * own.deviation * own.rate**(-1 / 3)
    line = np.polyfit(own.index, rates, 1, w=1 / bars)
    return (((np.polyval(line, own.index) - rates) / bars)**2).sum() / (len(own) - 2)


def quantities(table):
    cd, md = (table[table.method == method].set_index("width") for method in ("CD", "MD"))

    def law(width):
        """Return the rate of rigid contacts through a slot of `width` diameters by the law, in disks per sqrt(D/g)."""
        return cd.C.iloc[0] * (width - cd.k.iloc[0])**1.5 * width**0.5

    return {"cd": cd, "md": md, "fit": _fit, "error_of_k": _error_of_k, "chi_square": _chi_square, "apart": md.rate / cd.rate - 1, "law": law}
