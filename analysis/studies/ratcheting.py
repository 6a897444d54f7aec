"""Strain a cycle against the load over the static limit, for springs of three stiffnesses and for rigid contacts on the same packings."""

import matplotlib.pyplot as plt
import numpy as np

from analysis import cycles, limits, observables, style, summary
from yade_scripts.tables import product

TITLE = "Ratcheting: stiffness of the springs, or rearrangement?"
QUESTION = ("Does the strain that remains after every cycle vanish as springs get stiffer, as rigid contacts say, or does it belong to the packing? Below its static "
            "limit a packing can deform without changing its contacts (type I of Combe and Roux, Phys. Rev. Lett. 85, 2000, whose strain goes as 1/k_n) or by "
            "contacts that open and close (type II, whose strain does not).")
ORDER = 2.5  # in the report
# sigma1 = P0; sigma2/sigma1 rises to 1.4, which is 0.80 to 1.04 of the static limits of these packings.
LOADING = dict(loading="cosine", period=0.5, records_per_cycle=20, wall_mass_ratio=1.0)
SPRINGS = dict(method="MD", md_dt_factor=0.3, md_walls="force", **LOADING)
RIGID = dict(method="CD", cd_dt=2.5e-3, tolerance=1e-9, method_cd="auto", **LOADING)
STIFFER, LOAD, SEEDS = (1, 10, 100), 0.4, range(1, 11)
LOOSER = 1e-6  # a tolerance for comparison
ROWS = {"quick": product(stiffening=STIFFER[:2], delta_sigma=LOAD, cycles=6, **SPRINGS) + product(delta_sigma=LOAD, cycles=6, **RIGID),
        "full": [row for base in (SPRINGS, RIGID) for row in product(stiffening=STIFFER, delta_sigma=LOAD, cycles=20, seed=SEEDS, **base)]
        + product(delta_sigma=LOAD, cycles=20, seed=SEEDS, **RIGID | dict(tolerance=LOOSER))}


def summarize(runs):
    """Return one row a run: the first cycle's strain, the rate of the last half of the cycles, and how many contacts change.

    lost: share of the contacts that carry at the start and no more when the load is largest for the first time. changed: contacts lost and made from that
    largest load to that of the last cycle, over those that carried; a packing whose strain is of type I keeps its contacts.
    """
    return [_row(run) for run in runs]


def _row(run):
    full, found = run.parameters, cycles.of(run)
    start, first, last = run.snapshots[:3]
    return {"method": run.method, "k_n over the usual": full["stiffening"], "tolerance": full["tolerance"] if run.method == "CD" else np.nan, "dSigma": full["delta_sigma"],
            "seed": full["seed"], "static limit": limits.static_limit(run), "load over limit": limits.load_over_limit(run),
            "first cycle": float(abs(found.rate[0])) if found else np.nan, "rate": abs(cycles.late_rate(found)), "gamma at the end": float(run.values("gamma")[-1]),
            "last quarter's rate over the one before": cycles.last_quarter(found), "contacts lost": _changed(start, first)[0],
            "contacts changed": sum(_changed(first, last)),
            "unsolved steps": observables.unconverged_steps(run) if run.method == "CD" else "", "balance error": float(observables.balance_error(run)),
            "outcome": run.outcome}


def _changed(first, last):
    """Return (lost, made) between two snapshots: shares of the contacts that carry a force in the first one."""
    before, after = ({tuple(ids) for ids, force in zip(snapshot["contact_ids"].tolist(), snapshot["force_normal"]) if force > 0} for snapshot in (first, last))
    return len(before - after) / len(before), len(after - before) / len(before)


def draw(runs, rows, path):
    """Draw the strain of the first cycle and of a late one against the load over the static limit, and the latter against the contacts that change."""
    fig, axes = plt.subplots(1, 3, figsize=(12, 4.2), sharey=True)
    x = "load over limit"
    panels = ((x, "first cycle", r"largest $\sigma_2/\sigma_1$ over its static limit", "first cycle"),
              (x, "rate", r"largest $\sigma_2/\sigma_1$ over its static limit", "a cycle of the last half"),
              ("contacts changed", "rate", "contacts that change from the first to the last load", "a cycle of the last half"))
    shades = dict(zip(STIFFER, ("#0072B2", "#56B4E9", "#CC79A7")))
    for axis, (across, up, label, title) in zip(axes, panels):
        for stiffer, colour in shades.items():
            own = [row for row in rows if row["method"] == "MD" and row["k_n over the usual"] == stiffer]
            axis.plot([row[across] for row in own], [row[up] for row in own], ls="", marker=style.MARKER["MD"], ms=4.5, color=colour,
                      label=f"springs of {'' if stiffer == 1 else f'{stiffer:g} '}$k_n$")
        own = [row for row in rows if row["method"] == "CD" and row["tolerance"] != LOOSER]
        axis.plot([row[across] for row in own], [row[up] for row in own], ls="", marker=style.MARKER["CD"], ms=4.5, color=style.COLOUR["CD"], mfc="none",
                  label="rigid contacts")
        if across == x:
            axis.axvline(1, color="k", lw=0.7, ls=":")
        else:
            axis.set_xscale("log")
        axis.set(yscale="log", xlabel=label, title=title)
    axes[0].set_ylabel(r"strain of a cycle $|\Delta\gamma|$")
    axes[0].legend(loc="center left")
    style.finish(fig, path, "A point a packing. Rigid contacts are put into the packings of all three stiffnesses, whose limits differ.", runs)


ANSWER = """
Springs ratchet because they are soft. At equal load over the static limit the strain of a late cycle goes as k_n to the power -0.99
(standard error 0.13; 26 runs on 10 packings, all below the limit), and that of the first cycle to the power -0.94 (0.09). Both vanish
with the deformation of the springs: this is type I of Combe and Roux. The medians, of 10 packings each, are 4.1e-5 a cycle with k_n,
1.1e-5 with 10 k_n and 1.9e-6 with 100 k_n, on packings that are nearer to their limits the stiffer they are; a tenth of the limit more
makes the strain about 13 times as large.

Rigid contacts are the end of this series. Below the limit a late cycle strains them by 2.7e-10 (median of 26 cases from 10 packings),
which is their solver's error: with a tolerance of 1e-6 instead of 1e-9 it is 5.1e-7. In 3 of the 26 cases, at 0.982 to 0.999 of the
limit, they yield after all, by 1.8e-5 to 2.9e-4 in 20 cycles. Beyond the limit, up to 1.04 of it, they strain by 3.1e-4 to 1.2e-3 in the
first cycle (4 cases from 3 packings), and springs of 100 k_n on the same packings 1.06 to 1.19 times as far (3 of these cases): this
strain does not depend on the stiffness; it is type II, rearrangement. It comes once. In the late cycles rigid contacts rest there too,
with 2.3e-8 a cycle at most, since the packing has found contacts that carry the load. Further beyond the limit, where packings collapse,
rigid contacts strain in every cycle: see Fig. 3.

Whether contacts are kept does not tell the two types apart. From the first to the last load 1.0 to 12 % of the contacts that carry a
force change in springs, and 0.8 to 12 % in rigid packings, most of which do not move at all: forces leave contacts that stay where they
are. Nor is the ratcheting constant: the rate of the last five cycles is 0.76 times that of the five before (median of 26 runs of springs
below the limit; quartiles 0.67 and 0.91).
"""
GIVEN = ("1e-6", "1e-9", "20", "100")
POINTS = ()


def law(table, name, most=np.inf):
    """Return [(value, standard error)] of the powers b and c in name ~ k_n^b exp(c load/limit), by least squares over the springs' runs up to the load `most`.

    Stiffer packings have other limits, so that both have to be fitted at once. Errors: by leaving out one packing at a time (jackknife).
    """
    rows = table[(table.method == "MD") & (table["load over limit"] < most)]
    count, without = rows.seed.nunique(), np.array([_fit(rows[rows.seed != seed], name) for seed in rows.seed.unique()])
    return list(zip(_fit(rows, name), np.sqrt((count - 1) * without.var(axis=0))))


def _fit(rows, name):
    known = np.column_stack([np.log(rows["k_n over the usual"]), rows["load over limit"], np.ones(len(rows))])
    return np.linalg.lstsq(known, np.log(rows[name]), rcond=None)[0][:2]


def numbers(table):
    """Return the numbers of the text, from the summary table."""
    load, first, rate, changed = "load over limit", "first cycle", "rate", "contacts changed"
    springs, rigid = table[table.method == "MD"], table[(table.method == "CD") & (table.tolerance != LOOSER)]
    below, rests, beyond = springs[springs[load] < 1], rigid[rigid[load] < 1], rigid[rigid[load] > 1]
    (power, error), (steeper, _) = law(table, rate, 1)
    (power_first, error_first), _ = law(table, first, 1)
    medians = springs.groupby("k_n over the usual")[rate].median()
    yields = rests.assign(strain=rests["gamma at the end"].abs())[lambda rows: rows.strain > 1e-5]
    pairs = beyond.merge(springs[springs["k_n over the usual"] == STIFFER[-1]], on=["k_n over the usual", "seed"], suffixes=("", " MD"))
    ratio, slows = pairs[f"{first} MD"] / pairs[first], below["last quarter's rate over the one before"]
    assert (springs.groupby("k_n over the usual")[load].median().diff().dropna() > 0).all()
    return {"-0.99": power, "0.13": error, "26": [len(below), len(rests), len(slows)], "10": [below.seed.nunique(), *springs.groupby("k_n over the usual").size(), rests.seed.nunique()],
            "-0.94": power_first, "0.09": error_first, "4.1e-5": medians[1], "1.1e-5": medians[10], "1.9e-6": medians[100],
            "13": np.exp(0.1 * steeper), "2.7e-10": rests[rate].median(),
            "5.1e-7": table[table.tolerance == LOOSER][rate].median(), "3": [len(yields), beyond.seed.nunique(), len(ratio)], "0.982": yields[load].min(), "0.999": yields[load].max(),
            "1.8e-5": yields.strain.min(), "2.9e-4": yields.strain.max(), "1.04": beyond[load].max(), "3.1e-4": beyond[first].min(),
            "1.2e-3": beyond[first].max(), "4": len(beyond), "1.06": ratio.min(), "1.19": ratio.max(), "2.3e-8": beyond[rate].max(),
            "1.0": 100 * springs[changed].min(), "12": [100 * rows[changed].max() for rows in (springs, rigid)], "0.8": 100 * rigid[changed].min(), "0.76": slows.median(), "0.67": slows.quantile(0.25), "0.91": slows.quantile(0.75)}
