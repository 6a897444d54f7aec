"""The ensemble of contact forces that a packing at rest admits: how wide it is, and where the springs' own forces lie in it.

A walk over the ensemble (scene frozen_packing) gives forces F_c, two components a contact. Ambiguity of Unger, Kertesz and Wolf:
eta = <deltaF>/<|F|>, deltaF_c the standard deviation of F_c over the walk, means over contacts. Samples count when they are admissible
by code of its own (analysis/statics.py), whatever the solver said of them.
"""

import numpy as np

from analysis import statics, style
from analysis.style import plt

TITLE = "Indeterminacy of the contact forces"
QUESTION = ("How far do friction and geometry leave the forces between rigid grains at rest open, as Unger, Kertesz and Wolf measured "
            "(PRL 94, 178001), and where in the set of admissible forces does the network lie that springs have chosen?")
TABLES = {"quick": ("quick/indeterminacy.txt",), "full": ("indeterminacy.txt",)}

# Largest resultant, excess over Coulomb's limit or pull, over the mean normal force, of a sample that counts. Converged samples reach
# 1e-6; it is a twentieth of the smallest ambiguity that friction gives here (2e-3 at mu = 0.001).
ADMISSIBLE = 1e-4
# Contacts at which the walk's range is held against the exact one, two linear programmes each; the first seed of the smaller packings.
PROBED = 8
OWN, DENSE = "near the rigid limit", "dense, P0 = 6e-4 k_n"


def kind(run):
    """Which of the table's two kinds of packing a run has."""
    return OWN if run.parameters["stiffening"] > 1 else DENSE


def summarize(runs):
    """One row a walk."""
    order = sorted(runs, key=lambda run: (kind(run) == DENSE, run.parameters["friction"], run.parameters["seed"]))
    first = min((run.parameters["seed"] for run in runs), default=0)
    return [_row(run, kind(run) == OWN and run.parameters["seed"] == first) for run in order]


def _row(run, probed):
    snapshot, normal, tangential = run.snapshots[0], run.extra["normal"], run.extra["tangential"]
    load = statics.wall_loads(snapshot, (run.pressure, run.pressure), run.attributes["depth"])
    worst = statics.violations(snapshot, normal, tangential, load).max(axis=1)
    use = worst <= ADMISSIBLE
    loaded = (normal[use] > 0).any(axis=0)
    contacts, disks, counted = statics.degrees_of_freedom(snapshot, loaded)
    dimension = statics.dimension(snapshot, loaded)
    networks = np.stack([normal, tangential], axis=2)[use]
    springs = np.stack([snapshot["force_normal"], snapshot["force_tangential"]], axis=1)
    cold = np.stack([run.extra["cold_normal"], run.extra["cold_tangential"]], axis=1)
    away = distances(networks, np.stack([springs, cold])) if dimension else np.full(2, np.nan)
    half = len(networks) // 2
    return {
        "packing": kind(run), "mu": run.parameters["friction"], "seed": run.parameters["seed"], "disks held": disks,
        "contacts": contacts, "dimension": dimension, "2M-3N counted": counted, "samples": len(use), "used": int(use.sum()),
        "unconverged": int((~run.extra["converged"]).sum()), "largest violation used": float(worst[use].max()),
        "eta": ambiguity(networks), "eta first half": ambiguity(networks[:half]), "eta second half": ambiguity(networks[half:]),
        "springs from mean": away[0], "cold start from mean": away[1], "springs within range": within(networks, springs),
        "walk's range over the exact": coverage(snapshot, load, normal[use]) if probed and dimension else np.nan}


def ambiguity(networks):
    """eta of networks (samples, contacts, 2) [1]."""
    return float(_spread(networks).mean() / np.linalg.norm(networks, axis=2).mean())


def _spread(networks):
    """deltaF of each contact [N]."""
    return np.sqrt(networks.var(axis=0).sum(axis=1))


def distances(networks, others):
    """Distance of each of `others` from the mean of `networks`, over all contacts, in units of the samples' own rms distance."""
    centre, unit = networks.mean(axis=0), np.sqrt((_spread(networks)**2).sum())
    return np.sqrt(((others - centre)**2).sum(axis=(1, 2))) / unit


def within(networks, forces):
    """Share of the contacts at which both components lie between the smallest and the largest of the walk, to rounding of the solver."""
    slack = ADMISSIBLE * networks[..., 0].mean()
    inside = (forces >= networks.min(axis=0) - slack) & (forces <= networks.max(axis=0) + slack)
    return float(inside.all(axis=1).mean())


def coverage(snapshot, load, normal):
    """Mean over PROBED contacts, evenly spaced in the list of those that carry: range of R in the walk over the range that statics admits."""
    carrying = np.flatnonzero((normal > 0).any(axis=0))
    chosen = carrying[np.linspace(0, len(carrying) - 1, PROBED).astype(int)]
    exact = np.array([np.subtract(*statics.force_range(snapshot, load, contact)[::-1]) for contact in chosen])
    open_ones = exact > ADMISSIBLE * normal.mean()  # the others are determinate
    return float((np.ptp(normal[:, chosen], axis=0)[open_ones] / exact[open_ones]).mean()) if open_ones.any() else np.nan


def medians(rows, packing, name):
    """(mu, median over the seeds) of a column for one kind of packing."""
    mine = [row for row in rows if row["packing"] == packing]
    frictions = sorted({row["mu"] for row in mine})
    return np.array(frictions), np.array([np.median([row[name] for row in mine if row["mu"] == mu]) for mu in frictions])


def draw(runs, rows, path):
    """eta, dimension and distances against mu; mu = 0 stands at the left edge of the logarithmic axis."""
    fig, axes = plt.subplots(1, 3, figsize=(10.5, 4.2))
    least = min((row["mu"] for row in rows if row["mu"] > 0), default=1.0) / 3
    looks = {OWN: dict(color=style.COLOUR["CD"], marker="o"), DENSE: dict(color=style.COLOUR["MD"], marker="s")}
    for packing, look in looks.items():
        mine = [row for row in rows if row["packing"] == packing]
        if not mine:
            continue
        at = [max(row["mu"], least) for row in mine]
        mu, eta = medians(rows, packing, "eta")
        axes[0].plot(at, [row["eta"] for row in mine], ls="", ms=4, alpha=0.5, **look)
        axes[0].plot(np.maximum(mu, least), eta, color=look["color"], label=packing)
        mu, share = medians(rows, packing, "dimension")
        axes[1].plot(np.maximum(mu, least), share, label=packing, **look)
        mu, away = medians(rows, packing, "springs from mean")
        axes[2].plot(np.maximum(mu, least), away, label=f"springs; {packing}", **look)
        mu, away = medians(rows, packing, "cold start from mean")
        axes[2].plot(np.maximum(mu, least), away, ls="--", mfc="none", label=f"solver from no forces; {packing}", **look)
    mu, eta = medians([row for row in rows if row["mu"] > 0], OWN, "eta")
    if len(mu):
        axes[0].plot([mu[0], 0.1], [eta[0], eta[0] * 0.1 / mu[0]], color="0.5", ls=":", label=r"$\propto\mu$")
    axes[2].axhline(1, color="0.5", ls=":")
    axes[2].text(0.99, 1.02, "samples (rms)", fontsize=7, color="0.4", ha="right", transform=axes[2].get_yaxis_transform())
    for axis, label in zip(axes, (r"ambiguity $\eta=\langle\delta F\rangle/\langle|F|\rangle$", "dimension of the set of forces",
                                  "distance from the ensemble's mean\n(1: rms of the samples)")):
        axis.set(xscale="log", xlabel=r"friction $\mu$ (left edge: 0)", ylabel=label)
        axis.legend(loc="best", fontsize=6.5)
    axes[0].set_yscale("log")
    axes[2].set_ylim(0, None)
    style.finish(fig, runs, path, "Points: packings; lines: medians over seeds. Only samples found admissible by an independent check.", foot=0.13)


def answer(rows):
    """What the walks say of the published curve, and of the springs."""
    mu, eta = medians(rows, OWN, "eta")
    text = []
    if len(mu) and mu[0] == 0:
        text.append(f"Without friction a packing near the rigid limit has a force set of dimension {_dimensions(rows, OWN, 0)} and eta = "
                    f"{eta[0]:.1e}, the solver's floor (published: 1e-7).")
    small = (mu > 0) & (mu <= 0.011)
    if small.sum() > 1:
        slope = np.polyfit(np.log(mu[small]), np.log(eta[small]), 1)[0]
        text.append(f"For small mu eta grows as mu^{slope:.2f} (published: proportional; packings of one mu differ by up to a factor "
                    f"{_scatter(rows, mu[small]):.1f} here).")
    if (mu > 0).sum() > 2:
        top = int(np.argmax(eta))
        broad = mu[eta > 0.7 * eta[top]]
        text.append(f"It is largest, {eta[top]:.3f}, at mu = {mu[top]:g} among those tried, above 70 % of that from {broad.min():g} to "
                    f"{broad.max():g}, and {eta[-1]:.3f} at mu = {mu[-1]:g} (published: a maximum near 0.1, then a fall).")
    mu, eta = medians(rows, DENSE, "eta")
    if len(mu):
        text.append(f"The dense packings of the other studies are pressed so far that they stay indeterminate without friction: dimension "
                    f"{_dimensions(rows, DENSE, mu[0])} and eta = {eta[0]:.2g} at mu = {mu[0]:g}, {eta[-1]:.2g} at mu = {mu[-1]:g}"
                    + (", rising all the way: with the contacts given, the widening cone only adds; the fall is the packings', which more friction "
                       "leaves with fewer contacts." if len(mu) > 2 and (np.diff(eta) > 0).all() else "."))
    for packing in (OWN, DENSE):
        mine = [row for row in rows if row["packing"] == packing and row["mu"] > 0 and row["dimension"] > 0]
        if mine:
            springs, cold = (np.median([row[f"{name} from mean"] for row in mine]) for name in ("springs", "cold start"))
            text.append(f"Packings {packing}: the springs' own network lies {springs:.2f} from the ensemble's mean (median; the samples' "
                        f"rms is 1) and at {100 * np.median([row['springs within range'] for row in mine]):.0f} % of the contacts within the "
                        f"walk's range; the network that the solver finds from no forces lies at {cold:.2f}.")
    refused = sum(row["samples"] - row["used"] for row in rows)
    text.append(f"Evidence: {len({row['seed'] for row in rows})} packings for each mu; the walk samples by its own measure, not uniformly, and "
                f"covers {_covered(rows)} of the range of single forces that linear programmes allow; "
                f"{sum(row['unconverged'] for row in rows)} of {sum(row['samples'] for row in rows)} samples missed the "
                f"solver's tolerance, {refused} were refused as not admissible to {ADMISSIBLE:g} of the mean force.")
    return " ".join(text)


def _scatter(rows, frictions):
    """Largest over smallest eta of the own packings of one mu, the most of any of these mu."""
    groups = [[row["eta"] for row in rows if row["packing"] == OWN and row["mu"] == mu] for mu in frictions]
    return max(max(group) / min(group) for group in groups)


def _covered(rows):
    shares = [row["walk's range over the exact"] for row in rows if np.isfinite(row["walk's range over the exact"])]
    return f"{100 * min(shares):.0f} to {100 * max(shares):.0f} %" if shares else "an unknown part"


def _dimensions(rows, packing, mu):
    found = sorted({row["dimension"] for row in rows if row["packing"] == packing and row["mu"] == mu})
    return str(found[0]) if len(found) == 1 else f"{found[0]} to {found[-1]}"
