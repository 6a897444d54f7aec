"""Fig. 3 under three tangential laws: what of the strain per cycle is the work that the standard spring makes along closed paths."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D

from analysis import cycles, style
from analysis.load import ResultError
from analysis.studies import summary

TITLE = "Fig. 3 under three tangential laws"
QUESTION = ("Does the strain per cycle survive a tangential spring that does no work along closed paths: the standard law, YADE's "
            "avoidGranularRatcheting, and the law of McNamara, Garcia-Rojo and Herrmann (2008) with its forces and arms?")
TABLES = {"quick": ("quick/laws.txt",), "full": ("laws.txt",)}
STANDARD = "standard"
# Ratios of two strains from chaotic motion scatter; within this factor the laws are said to agree.
ALIKE = 1.5


def summarize(runs):
    """One row a run, with its strain and late rate over those of the standard law on the same packing under the same load."""
    standard = {_case(run): run for run in runs if run.parameters["tangential_law"] == STANDARD}
    return [_row(run, standard.get(_case(run))) for run in sorted(runs, key=lambda run: (_case(run), _order(run)))]


def _case(run):
    row = run.parameters
    return row["pressure_ratio"], row["preparation_friction"], row["delta_sigma"], row["seed"]


def _order(run):
    return ("standard", "avoid_ratcheting", "path_independent").index(run.parameters["tangential_law"])


def _row(run, standard):
    pressure, friction, load, seed = _case(run)
    found, regime = _cycles(run), cycles.regime(run)
    row = {"law": run.parameters["tangential_law"], "P0/k_n": pressure, "preparation friction": friction, "dSigma": load, "seed": seed,
           "cycles": len(found.number) if found else 0, "regime": regime.name, "gamma at the end": float(run.values("gamma")[-1]),
           "late rate": float(regime.late_rate), "decay p": float(regime.decay), "noise of the rate": float(regime.noise),
           "last quarter's rate over the one before": cycles.last_quarter(run)}
    if standard is not None:
        row |= {"strain over standard": _ratio(found, _cycles(standard)),
                "late rate over standard": _over(regime.late_rate, cycles.regime(standard).late_rate)}
    return row | {"outcome": run.outcome}


def _cycles(run):
    try:
        return cycles.of(run)
    except ResultError:
        return None


def _ratio(found, standard):
    """|gamma| over the standard law's after the cycles that both have."""
    if not found or not standard:
        return float("nan")
    count = min(len(found.number), len(standard.number))
    return _over(found.permanent[count - 1], standard.permanent[count - 1])


def _over(value, reference):
    return float(abs(value / reference)) if reference else float("nan")


def draw(runs, rows, path):
    """Above, strain rate against strain, a panel for each pressure and load; below, strain over that of the standard law."""
    cases = summary.groups(runs, lambda run: _case(run)[:3])
    fig, axes = plt.subplots(2, len(cases), figsize=(max(6.4, 1.6 + 3.4 * len(cases)), 7.6), squeeze=False, sharey="row")
    look = {law: (colour, marker) for law, colour, marker in zip(
        ("standard", "avoid_ratcheting", "path_independent"), ("#1A1A1A", "#009E73", "#CC79A7"), "osD")}
    for column, ((pressure, friction, load), own) in enumerate(cases.items()):
        axes[0, column].set_title(rf"$\Delta\sigma$ = {load:g}, $P_0$ = {style.number(pressure)}$\,k_n$" + "\n" + rf"prepared with $\mu$ = {friction:g}")
        standard = {_case(run): _cycles(run) for run in own if run.parameters["tangential_law"] == STANDARD}
        for run in own:
            _curves(axes[:, column], _cycles(run), standard.get(_case(run)), *look[run.parameters["tangential_law"]])
    for axis in axes.flat:
        axis.grid(color="#DDDDDD", linewidth=0.5)
    for axis in axes[0]:
        axis.set(xscale="log", yscale="log", xlabel=r"accumulated strain $|\gamma|$")
    for axis in axes[1]:
        axis.axhline(1, color="#444444", linewidth=0.8, linestyle="--")
        axis.set(xscale="log", xlabel="cycle")
        # On a logarithmic scale where the laws differ much, else where a difference of per mille shows.
        low, high = axis.get_ylim()
        if high > 2 or low < 0.5:
            axis.set_yscale("log")
    axes[0, 0].set_ylabel(r"strain rate $|\Delta\gamma|$ a cycle")
    axes[1, 0].set_ylabel(r"$|\gamma|$ over that of the standard law")
    handles = [Line2D([], [], color=colour, marker=marker, markersize=4, label=law.replace("_", " ")) for law, (colour, marker) in look.items()]
    fig.legend(handles=handles, loc="upper center", ncol=3)
    fig.subplots_adjust(left=0.8 / fig.get_figwidth(), right=0.985, top=0.85, bottom=0.19, hspace=0.3, wspace=0.08)
    style.finish(fig, runs, path, "A line a packing; rates are means over windows that grow with the cycle's number")


def _curves(axes, found, standard, colour, marker):
    if not found:
        return
    windows = cycles.windows(len(found.number))
    thin = dict(color=colour, marker=marker, markersize=2.5, linewidth=0.8, alpha=0.8)
    axes[0].plot(np.abs(found.permanent[[last - 1 for _, last in windows]]), np.abs(found.rates(windows)), **thin)
    if standard:
        count = min(len(found.number), len(standard.number))
        axes[1].plot(found.number[:count], np.abs(found.permanent[:count] / standard.permanent[:count]), **thin, markevery=max(1, count // 8))


def steady(rows):
    """What the other laws make of the samples that ratchet at a constant rate under the standard one."""
    cases = [(row["P0/k_n"], row["preparation friction"], row["dSigma"], row["seed"]) for row in rows
             if row["law"] == STANDARD and row["regime"] == cycles.RATCHETING and cycles.is_constant(row["last quarter's rate over the one before"])]
    found = []
    for law in dict.fromkeys(row["law"] for row in rows if row["law"] != STANDARD):
        same = [row for row in rows if row["law"] == law and (row["P0/k_n"], row["preparation friction"], row["dSigma"], row["seed"]) in cases]
        if same:
            found.append(f"under {law} {sum(row['regime'] == cycles.RATCHETING for row in same)} of {len(same)} still ratchet, at "
                         f"{summary.spread((row['late rate over standard'] for row in same), 3)} times the rate")
    if not found:
        return "No sample ratchets at a constant rate under the standard law."
    return f"Of {summary.count(len(cases), 'sample')} that ratchet{'s' if len(cases) == 1 else ''} at a constant rate under the standard law, {'; '.join(found)}."


def answer(rows):
    """Strains and late rates under the other laws over those under the standard one, by pressure."""
    others = [row for row in rows if row["law"] != STANDARD and "strain over standard" in row]
    if not others:
        return "No law but the standard one has been run on the same packing yet."
    parts = []
    for (pressure, law), same in summary.groups(others, lambda row: (row["P0/k_n"], row["law"])).items():
        ratios = summary.finite(row["strain over standard"] for row in same)
        parts.append(f"at P0 = {summary.number(pressure)} k_n {law} gives {summary.spread(ratios, 3)} times the strain and "
                     f"{summary.spread((row['late rate over standard'] for row in same), 3)} times the late rate of the standard law "
                     f"({summary.count(len(same), 'run')})")
    ratios = summary.finite(row["strain over standard"] for row in others)
    alike = int(np.sum((ratios < ALIKE) & (ratios > 1 / ALIKE)))
    regimes = {law: [row["regime"] for row in rows if row["law"] == law] for law in dict.fromkeys(row["law"] for row in rows)}
    named = "; ".join(f"{law} {names.count(cycles.RATCHETING)} of {len(names)}" for law, names in regimes.items())
    return (f"{'; '.join(parts)[:1].upper()}{'; '.join(parts)[1:]}. In {alike} of {len(ratios)} comparisons the strain agrees within a factor of "
            f"{ALIKE:g}. Runs that ratchet: {named}. {steady(rows)} A strain that remains under the path-independent law is no artefact of the spring; a "
            "difference between single runs may be chance, since small changes grow in such packings.")
