"""The ensemble of contact forces that a packing at rest admits: how wide it is, and where the springs' own forces lie in it.

A walk over the ensemble (scene frozen_packing) gives forces F_c, two components a contact. Ambiguity of Unger, Kertesz and Wolf:
eta = <deltaF>/<|F|>, deltaF_c the standard deviation of F_c over the walk, means over contacts. Samples count when they are admissible
by an independent check (yade_scripts/theory/statics.py), whatever the solver reported.
"""
import numpy as np
import pandas

from analysis import style, summary
from analysis.style import plt
from yade_scripts.tables import product
from yade_scripts.theory import statics

TITLE = "Is the solver's choice of forces special?"
QUESTION = "The set of admissible forces, sampled by a random walk, against friction; after Unger, Kertesz and Wolf (2005)."
ORDER = 7  # in the report
# The protocol of Unger, Kertesz and Wolf: every mu with a packing of its own, compacted with it, stiffened to P0 = 6e-7 k_n. Then the dense
# packings of the other studies, where mu changes the cone and hardly the contacts.
FRICTIONS, SEEDS = (0.0, 0.001, 0.003, 0.01, 0.03, 0.1, 0.2, 0.3, 0.5, 1.0), range(1, 11)


def _rows(own, dense, samples):
    """Return the rows of the protocol, (mu, seeds), and of the dense packings, likewise."""
    walk = dict(scene="frozen_packing", records_per_cycle=samples)
    protocol = walk | dict(disks=200, radius_spread=0.3333, stiffening=1000.0, seed=own[1])
    return [row for mu in own[0] for row in product(**protocol, preparation_friction=mu, friction=mu)
            ] + product(disks=400, friction=dense[0], seed=dense[1], **walk)


ROWS = {"quick": _rows(((0.0, 0.01, 0.1, 0.3, 1.0), 1), ((0.0, 0.1), 1), 100), "full": _rows((FRICTIONS, SEEDS), (FRICTIONS, SEEDS[:3]), 200)}

# Largest resultant, excess over Coulomb's limit or pull, over the mean normal force, of a sample that counts. Converged samples reach
# 1e-6; it is a twentieth of the smallest ambiguity that friction gives here (2e-3 at mu = 0.001).
ADMISSIBLE = 1e-4
# Contacts at which the walk's range is compared with the exact one, by two linear programmes each; the first seed of the smaller packings.
PROBED = 8
OWN, DENSE = "near the rigid limit", "dense, P0 = 6e-4 k_n"
SHOWN = {OWN: OWN, DENSE: r"dense, $P_0=6\cdot10^{-4}k_n$"}  # their words in the figure


def kind(run):
    """Return which of the table's two kinds of packing a run has."""
    return OWN if run.parameters["stiffening"] > 1 else DENSE


def summarize(runs):
    """Return one row a walk."""
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
    half = len(networks) // 2
    return {
        "packing": kind(run), **summary.columns(run, "mu", "seed"), "disks held": disks,
        "contacts": contacts, "dimension": dimension, "2M-3N counted": counted, "samples": len(use), "used": use.sum(),
        "unconverged": (~run.extra["converged"]).sum(), "largest violation used": worst[use].max(),
        "eta": ambiguity(networks), "eta first half": ambiguity(networks[:half]), "eta second half": ambiguity(networks[half:]),
        "samples nearer than springs": nearer(networks, springs) if dimension else np.nan,
        "samples nearer than cold start": nearer(networks, cold) if dimension else np.nan, "springs within range": within(networks, springs),
        "walk's range over the exact": coverage(snapshot, load, normal[use]) if probed and dimension else np.nan}


def ambiguity(networks):
    """Return eta of networks (samples, contacts, 2) [1]."""
    return _spread(networks).mean() / np.linalg.norm(networks, axis=2).mean()


def _spread(networks):
    """Return deltaF of each contact [N]."""
    return np.sqrt(networks.var(axis=0).sum(axis=1))


def nearer(networks, forces):
    """Return the share of the networks of one half of the walk that lie nearer to the mean of the other half than forces do, averaged over both
    halves: half of them, on average, if forces are like any network of the walk. The halves keep apart what a network adds to its own mean."""
    half = len(networks) // 2
    shares = []
    for one, other in ((networks[:half], networks[half:]), (networks[half:], networks[:half])):
        middle = one.mean(axis=0)
        shares.append((((other - middle)**2).sum(axis=(1, 2)) < ((forces - middle)**2).sum()).mean())
    return np.mean(shares)


def within(networks, forces):
    """Return the share of the contacts at which both components lie between the smallest and the largest of the walk, to rounding of the solver."""
    slack = ADMISSIBLE * networks[..., 0].mean()
    inside = (forces >= networks.min(axis=0) - slack) & (forces <= networks.max(axis=0) + slack)
    return inside.all(axis=1).mean()


def coverage(snapshot, load, normal):
    """Return the range of R in the walk over the range that statics admits: mean over PROBED contacts, evenly spaced among those that carry."""
    carrying = np.flatnonzero((normal > 0).any(axis=0))
    chosen = carrying[np.linspace(0, len(carrying) - 1, PROBED).astype(int)]
    exact = np.array([np.subtract(*statics.force_range(snapshot, load, contact)[::-1]) for contact in chosen])
    open_ones = exact > ADMISSIBLE * normal.mean()  # the others are determinate
    return (np.ptp(normal[:, chosen], axis=0)[open_ones] / exact[open_ones]).mean() if open_ones.any() else np.nan


def draw(runs, rows, path):
    """Draw eta, dimension and shares of nearer samples against mu; mu = 0 stands at the left edge of the logarithmic axis, without a line to it."""
    fig, axes = plt.subplots(1, 3, figsize=(10.5, 4.2))
    table = pandas.DataFrame(rows)
    least = table.mu[table.mu > 0].min() / 3 if table.mu.any() else 1 / 3
    table["at"] = table.mu.clip(lower=least)
    for packing, look in ((OWN, dict(color=style.COLOUR["CD"], marker="o")), (DENSE, dict(color=style.COLOUR["MD"], marker="s"))):
        mine = table[table.packing == packing]
        if mine.empty:
            continue
        medians = mine.groupby("at")[["eta", "dimension", "samples nearer than springs", "samples nearer than cold start"]].agg(
            lambda values: np.median(values))  # none where one packing has no value
        axes[0].plot(mine["at"], mine.eta, ls="", ms=4, alpha=0.5, **look)
        _line(axes[0], medians.eta, least, color=look["color"], label=SHOWN[packing])
        _line(axes[1], medians.dimension, least, label=SHOWN[packing], **look)
        _line(axes[2], medians["samples nearer than springs"], least, **look)
        _line(axes[2], medians["samples nearer than cold start"], least, ls="--", mfc="none", **look)
    axes[2].plot([], color="0.3", marker="o", label="springs")
    axes[2].plot([], color="0.3", marker="o", ls="--", mfc="none", label="solver from no forces")
    axes[2].axhline(0.5, color="0.5", ls=":", label="an ordinary sample")
    for axis, label in zip(axes, (r"ambiguity $\eta=\langle\delta F\rangle/\langle|F|\rangle$", "dimension of the set of forces",
                                  "share of the samples that lie nearer\nto their mean than these forces")):
        axis.set(xscale="log", xlabel=r"friction $\mu$  (left edge: $\mu$ = 0)", ylabel=label)
        axis.legend(loc="best", fontsize=6.5)
    axes[0].set_yscale("log")
    axes[2].set_ylim(-0.03, 1.03)
    style.finish(fig, path, "Left: each point is a packing. Lines: medians over the packings. mu = 0 stands at the left edge. All sampled "
                 "networks of forces were found admissible by an independent check.", runs)


def _line(axis, medians, edge, **look):
    """Draw medians against mu; that of mu = 0, at the edge, stands alone."""
    axis.plot(medians[medians.index > edge], **look)
    axis.plot(medians[medians.index == edge], **look | dict(label=None, ls="", marker=look.get("marker", "_")))


POINTS = (
    (1, "is the selected solution somehow special among the other admissible, or are they all equivalent", "section 2.3", "answered in part"),
)


def quantities(table):
    counted = table[table.used >= 100]
    own, dense = (counted[counted.packing == kind] for kind in (OWN, DENSE))
    choice, springs = "samples nearer than cold start", "samples nearer than springs"
    assert table[table.used < table.samples].mu.min() >= 0.2 and (dense[dense.mu >= 0.5][choice] == 0).all()
    return locals()
