"""One loading and unloading by three methods: MD's springs, the same springs in the solver of Contact Dynamics, and rigid contacts."""
import numpy as np
import pandas

from analysis import loops, style
from analysis.style import plt
from yade_scripts.tables import product

TITLE = "What is left if only the stiffness differs?"
QUESTION = "Springs of k_n to 10 000 k_n in Contact Dynamics (cd_contacts=springs), beside MD's springs and rigid contacts, in one cycle of 1 s."
ORDER = 1.45  # in the report
LOADING = dict(loading="cosine", period=1.0)
MD, SPRINGS, RIGID = "MD", "CD with springs", "CD, rigid"
STIFFENING = (1, 10, 100, 10000)


def _rows(seeds, md, springs):
    return (product(method="MD", md_walls="force", stiffening=md, seed=seeds, **LOADING)
            + product(method="CD", cd_contacts="springs", stiffening=springs, seed=seeds, **LOADING)
            + product(method="CD", seed=seeds, **LOADING))


ROWS = {"quick": _rows((1,), (1,), (1, 100)),
        "full": _rows(range(1, 11), (1, 10), STIFFENING)
        # The step's error, the load near the limit, and the law whose springs conserve energy on closed paths in MD.
        + product(method="CD", cd_contacts="springs", cd_dt=(5e-3, 2.5e-3, 5e-4, 2.5e-4), seed=1, **LOADING)
        + product(method="MD", md_walls="force", delta_sigma=0.4, seed=(1, 2, 3), **LOADING)
        + product(method="CD", cd_contacts="springs", delta_sigma=0.4, cd_dt=2.5e-4, seed=(1, 2, 3), **LOADING)
        + product(method="MD", md_walls="force", tangential_law="path_independent", seed=(1, 2, 3), **LOADING)}
COLOUR = {MD: style.COLOUR["MD"], SPRINGS: style.GREEN, RIGID: style.COLOUR["CD"]}
MARKER = {MD: "o", SPRINGS: "s", RIGID: "D"}


def kind(run):
    """Return which of the three methods a run is."""
    if run.method == "MD":
        return MD
    return SPRINGS if run.parameters["cd_contacts"] == "springs" else RIGID


def summarize(runs):
    """Return one row a run. `over MD`: over the run by MD of the same packing, load and stiffness."""
    rows = []
    for run in runs:
        row = run.parameters
        rows.append({"medium": kind(run), "packing": row["seed"], "dSigma": row["delta_sigma"], "stiffness_over_kn": row["stiffening"],
                     "step_s": row["cd_dt"] if run.method == "CD" else np.nan, "law": row["tangential_law"] if run.method == "MD" else "standard",
                     **loops.of(run), "unsolved_steps": int(run.values("unconverged_steps")[-1]) if run.method == "CD" else 0})
    table = pandas.DataFrame(rows)
    plain = table[(table.medium == MD) & (table.law == "standard")].set_index(["packing", "dSigma", "stiffness_over_kn"])
    for name in ("largest", "remanent"):
        table[f"{name} over MD"] = [row[name] / plain[name].get((row.packing, row.dSigma, row.stiffness_over_kn), np.nan)
                                    if row.medium != RIGID else np.nan for _, row in table.iterrows()]
    return table.to_dict("records")


def usual(table):
    """Return the rows of one load, step and law, over which the packings are compared."""
    return table[(table.dSigma == table.dSigma.min()) & (table.law == "standard") & ~((table.medium == SPRINGS) & (table.step_s != 1e-3))]


def draw(runs, rows, path):
    """Draw loops of one packing, the largest strain against the stiffness, and each packing's strain over that of MD."""
    fig, (left, middle, right) = plt.subplots(1, 3, figsize=(12, 4.4))
    table = usual(pandas.DataFrame(rows))
    seed, load = table.packing.min(), table.dSigma.min()
    for run in runs:
        row = run.parameters
        if (row["seed"], row["delta_sigma"]) != (seed, load) or row["stiffening"] not in (1, 100) or row["tangential_law"] != "standard" \
                or (run.method == "CD" and row["cd_dt"] != 1e-3) or (run.method == "MD" and row["stiffening"] != 1):
            continue
        label = kind(run) + ("" if kind(run) == RIGID else ", $k_n$" if row["stiffening"] == 1 else f", {row['stiffening']:g} $k_n$")
        left.plot(-1e4 * run.values("gamma"), run.values("sigma2") / run.pressure, color=COLOUR[kind(run)], label=label,
                  ls="-" if kind(run) != SPRINGS else "--" if row["stiffening"] == 1 else ":",
                  **(dict(lw=4, alpha=0.6) if kind(run) == MD else dict(lw=1.5)))
    left.set(xlabel=r"strain $-\gamma$  [$10^{-4}$]", ylabel=r"$\sigma_2/P_0$", title=f"packing {seed}")
    left.legend(fontsize=7)
    for medium in (MD, SPRINGS):
        part = table[table.medium == medium].groupby("stiffness_over_kn")["largest"].agg(["mean", "min", "max"])
        middle.errorbar(part.index, part["mean"], yerr=[part["mean"] - part["min"], part["max"] - part["mean"]], fmt=MARKER[medium], mfc="none",
                        color=COLOUR[medium], capsize=2, label=medium)
    rigid = table[table.medium == RIGID].largest
    middle.axhspan(rigid.min(), rigid.max(), color=COLOUR[RIGID], alpha=0.3, lw=0, label="rigid: error of the solver")
    soft = table[(table.medium == SPRINGS) & (table.stiffness_over_kn == 1)].largest.mean()
    x = np.unique(table[table.medium == SPRINGS].stiffness_over_kn).astype(float)
    middle.plot(x, soft / x, ":", color="k", lw=0.8, label="inverse to the stiffness")
    middle.set(xscale="log", yscale="log", xlabel="stiffness of a contact over $k_n$", ylabel=r"largest strain $|\gamma|$", title="all packings")
    middle.legend(fontsize=7)
    springs = table[table.medium == SPRINGS].dropna(subset=["largest over MD"])
    for (stiffening, part), face in zip(springs.groupby("stiffness_over_kn"), (COLOUR[SPRINGS], "none")):
        for name, marker in (("largest", "s"), ("remanent", "^")):
            right.plot(part.packing, part[f"{name} over MD"], marker, color=COLOUR[SPRINGS], mfc=face, label=f"{name}, {stiffening:g} $k_n$")
    right.axhline(1, color="k", lw=0.8, ls=":")
    right.set(xlabel="packing", ylabel="CD with springs over MD", title="the same springs, two methods")
    right.legend(fontsize=7)
    style.finish(fig, path, "Bars and band: smallest and largest of the packings", runs)


def quantities(table):
    main, seeds = usual(table), sorted(table.packing.unique())
    springs, rigid = main[main.medium == SPRINGS], main[main.medium == RIGID]
    by = springs.pivot(index="stiffness_over_kn", columns="packing", values="largest")
    checks = table[(table.medium == SPRINGS) & (table.packing == seeds[0]) & (table.dSigma == table.dSigma.min()) & (table.stiffness_over_kn == 1)]
    high = table[(table.medium == SPRINGS) & (table.dSigma > table.dSigma.min())]
    means = main[main.medium == MD].groupby("stiffness_over_kn").largest.mean()
    return {"packings": len(seeds), "same": springs.dropna(subset=["largest over MD"]), "usual_over": springs[springs.stiffness_over_kn == 1],
            "md_means": means, "rigid": rigid.largest, "steps": checks.sort_values("step_s"),
            "powers": pandas.Series(np.polyfit(np.log(by.index.astype(float)), np.log(by), 1)[0]), "by": by, "high": high,
            "unsolved": int(springs.unsolved_steps.sum())}
