"""Draws the figures of `make bench`: error against time, cost of a sweep and of a step against size, number of sweeps against size."""
import math
from pathlib import Path

import pandas

from analysis import publish, style
from analysis.style import plt
from yade_scripts.measuring.benchmark.solutions import PEER, SOLVED
from yade_scripts.measuring.benchmark.space import PEERS
from yade_scripts.results import provenance

REFERENCE = "nsgs"
# Okabe and Ito's palette, with a marker of its own for each method.
LOOK = {**{name: (style.GREY["77"], marker) for name, marker in zip(PEERS, "v<>P*h")}, PEER: (style.BLACK, "X"), REFERENCE: (style.VERMILION, "s"),
        "accelerated": (style.BLUE, "o"), "newton": (style.GREEN, "^"),
        "auto": (style.PINK, "D")}
TARGET_LOOK = {1e-4: (style.BLUE, "o"), 1e-6: (style.GREEN, "s"), 1e-8: (style.VERMILION, "^")}
PANELS = 6
LEGEND = 6  # entries in a line
LEAST = 1e-17  # error that is drawn where it is 0
VALUES = {"silo": "share of the spheres that have left", "drum": "share of M1 at the lower right", "penetration": "depth over the sphere's diameter"}
# What the figures need.
ORIGIN = {"commit": str, "processor": str, "processes_running_before": (int, float), "instruction_sets": list, "default_method": str}
OF_SOLUTIONS = dict(texts=("status", "problem", "kind", "start", "method"),
                    numbers=("disks", "contacts", "mu", "target", "sweeps", "seconds", "residual"))
COLUMNS = {"solutions": OF_SOLUTIONS, "space": OF_SOLUTIONS, "spheres": OF_SOLUTIONS,
           "sweeps": dict(numbers=("disks", "contacts", "accelerated_ns", "bound_plain_ns", "bound_accelerated_ns", "bytes_plain",
                                   "bytes_accelerated", "bandwidth_gb_per_s")),
           "step": dict(texts=("order",), numbers=("disks", "contacts", "tolerance", "ns_a_contact", "seconds_of_springs")),
           "community": dict(texts=("case", "method"), numbers=("seed", "larger", "softer", "t", "value"))}


def draw(folder):
    """Draw the figures for which the tables in `folder` have rows. Return the paths of the figures."""
    folder, drawn = Path(folder), []
    origin = publish.read_json(folder / "provenance.json", ORIGIN)
    tables = {name: publish.read_table(path, **columns) if (path := folder / f"{name}.csv").exists() else pandas.DataFrame()
              for name, columns in COLUMNS.items()}
    time = "Processor time of one core"
    for figure, name, note in (
            (error_against_time, "solutions", f"{time}; the error is computed anew from the impulses."),
            (error_in_space, "space", f"{time}; contact problems in space; the error is computed anew from the impulses; 0 is drawn at {LEAST:g}."),
            (error_of_spheres, "spheres", f"{time}; packings of spheres from zero impulses; the error is computed anew from the impulses."),
            (sweep_cost, "sweeps", f"{time}."), (sweeps_against_size, "solutions", "Medians over the seeds; bars: their range."),
            (step_cost, "step", f"{time}."),
            (community, "community", "Lines: runs from the same initial states, one a seed. Fewer and larger grains than in the benchmark; in silo "
             "and drum springs a hundredth as stiff.")):
        of_table = origin.get("tables", {}).get(name, origin)  # a table that was measured by itself
        if len(tables[name]) and (fig := figure(tables[name], of_table)):
            for axis in fig.axes:
                axis.grid(True, which="major", linewidth=0.3)
            drawn.append(folder / f"{figure.__name__}.png")
            source = f"commit {provenance.short(of_table['commit'])}, {of_table['processor']}"
            if (busy := of_table["processes_running_before"]) > 0.5:
                source += f"; {busy:.1f} other processes were running"
            style.finish(fig, drawn[-1], note, source)
    return drawn


def chosen(rows):
    """Return the problems of the panels: of each kind, size, friction and start the first seed; large packings first."""
    first = rows.drop_duplicates(["kind", "disks", "mu", "start"])
    order = first.assign(warm=first.start != "cold", smaller=-first.disks).sort_values(["warm", "smaller", "mu"])
    packings, others = (list(order.problem[(order.kind == "packing") == packing]) for packing in (True, False))
    return (packings[:PANELS - min(2, len(others))] + others)[:PANELS]


def error_against_time(rows, origin, problems=None):
    """Draw a panel for each problem and a line for each method: the error reached against the time. Failures stand at the right edge, open."""
    problems = problems or chosen(rows)
    rows = rows[rows.problem.isin(problems) & ((rows.status != SOLVED) | (rows.sweeps > 0))]
    names = rows.method.unique()
    wide = min(3, len(problems))
    high = -(-len(problems) // wide)
    fig, axes = plt.subplots(high, wide, figsize=(3.6 * wide + 0.4, 3.1 * high + 0.8), squeeze=False)
    for axis, problem in zip(axes.flat, problems):
        of_problem = rows[rows.problem == problem]
        edge = 3 * (of_problem.seconds.fillna(0).max() or 1)
        for method in names:
            (colour, marker), own = LOOK[method], of_problem[of_problem.method == method]
            met, missed = own[own.status == SOLVED], own[own.status != SOLVED][:1]
            axis.loglog(met.seconds, met.residual.clip(lower=LEAST), marker=marker, color=colour, markersize=5)
            axis.loglog([edge] * len(missed), missed.residual, marker=marker, color=colour, mfc="none", ls="none", ms=7)
        axis.set_title(f"{problem}\n{of_problem.contacts.iloc[0]:.0f} contacts", fontsize=9)
        axis.set_xlabel("processor time [s]")
    plt.setp(axes[:, 0], ylabel="error $e$")
    for axis in axes.flat[len(problems):]:
        axis.axis("off")
    entries = [dict(color=LOOK[name][0], marker=LOOK[name][1], label=name) for name in names]
    entries.append(dict(color=style.GREY["77"], marker="o", mfc="none", ls="none", label="given up at this error"))
    lines = -(-len(entries) // LEGEND)
    fig.suptitle("\n".join(lines * " "))  # keeps room for the legend
    style.legend(fig, entries, loc="upper center", ncol=-(-len(entries) // lines))
    return fig


def error_in_space(rows, origin):
    """The same for problems in space, with several of Siconos's solvers."""
    return error_against_time(rows, origin, list(rows.problem.unique())[-PANELS:])


def error_of_spheres(rows, origin):
    """The same for packings of spheres, each with several frictions."""
    rows = rows[rows.start == "cold"]
    return error_against_time(rows, origin, list(rows.problem.unique())[:PANELS])


def sweep_cost(rows, origin):
    """Draw ns per contact against contacts, with what memory allows."""
    rows = rows.sort_values("contacts")
    sets = [name for name in origin["instruction_sets"] if f"plain_{name}_ns" in rows]
    fig, axis = plt.subplots(figsize=(6.4, 4.4))
    for name, marker, colour in zip(sets, "osD", (style.BLUE, style.SKY, style.GREEN)):
        axis.loglog(rows.contacts, rows[f"plain_{name}_ns"], marker=marker, color=colour, label=f"plain sweep, {name}")
    axis.loglog(rows.contacts, rows.accelerated_ns, marker="^", color=style.VERMILION, label=f"accelerated sweep, {sets[0]}")
    beside = rows.reindex(columns=["contacts", "siconos_ns"]).dropna()
    axis.loglog(beside.contacts, beside.siconos_ns, marker="X", color=style.BLACK, label="Siconos fc2d_nsgs")
    largest = rows.iloc[-1]
    for kind, dashes in (("plain", ":"), ("accelerated", "--")):
        axis.loglog(rows.contacts, rows[f"bound_{kind}_ns"], linestyle=dashes, color=style.GREY["77"],
                    label=f"memory's bound, {kind} ({largest[f'bytes_{kind}']:.0f} bytes, {largest.bandwidth_gb_per_s:.0f} GB/s)")
    axis.set(xlabel="contacts", ylabel="ns per contact and sweep",
             title="One sweep; below the bound: what fits a cache is not read from memory")
    axis.legend(fontsize=7)
    return fig


def step_cost(rows, origin):
    """Draw ns per contact of a whole warm step against the number of disks, for Contact Dynamics and for the springs of the same packing."""
    built = rows[rows.order == "built"].sort_values("disks", kind="stable")
    fig, axis = plt.subplots(figsize=(6.4, 4.4))
    for tolerance, ours in built.groupby("tolerance", sort=False):
        axis.loglog(ours.disks, ours.ns_a_contact, marker=style.MARKER["CD"], color=style.COLOUR["CD"], label=f"Contact Dynamics to {tolerance:.0e}",
                    **{} if tolerance == built.tolerance.max() else dict(linestyle="--", mfc="none"))
    springs = built[built.tolerance == built.tolerance.iloc[0]]
    axis.loglog(springs.disks, 1e9 * springs.seconds_of_springs / springs.contacts, marker=style.MARKER["MD"], color=style.COLOUR["MD"],
                label="YADE's springs")
    axis.set(xlabel="disks", ylabel="ns per contact and step", yticks=(100, 200, 500, 1000), yticklabels=("100", "200", "500", "1000"),
             title="A whole step of a packing at rest, one thread")
    axis.legend(fontsize=7)
    return fig


def community(rows, origin):
    """Draw the community's benchmark: what both methods make of the same initial states."""
    curves = rows[rows.t.notna()].fillna({"orifice": "", "material": ""})
    groups = list(curves.groupby(["case", "material"], sort=False))
    fig, axes = plt.subplots(1, len(groups), figsize=(3.3 * len(groups) + 0.4, 3.9), squeeze=False)
    for axis, ((case, material), group) in zip(axes[0], groups):
        for keys, run in group.groupby(["method", "orifice", "seed", "softer"], sort=False):
            axis.plot(run.t, run.value, color=style.COLOUR[keys[0]], lw=0.9, ls="--" if keys[1] == "small" else "-")
        axis.set(xlabel="time [s]", ylabel=VALUES[case], title=f"{case} {material}".strip())
    small = [dict(color=style.GREY["77"], ls="--", label="small orifice")] if "small" in set(curves.orifice) else []
    methods = [dict(color=style.COLOUR[method], label=label) for method, label in (("CD", "Contact Dynamics"), ("MD", "YADE's springs"))]
    style.legend(axes[0, 0], methods + small, fontsize=7)
    return fig


def sweeps_against_size(rows, origin):
    """Draw the sweeps of plain Gauss-Seidel and of the default method to three errors, cold packings: medians, and the range of the seeds."""
    rows, ours = rows[(rows.kind == "packing") & (rows.start == "cold")], origin["default_method"]
    rows = rows.assign(sweeps=rows.sweeps.clip(lower=1))
    if rows.disks.nunique() < 2:
        return None  # one size makes no curve
    frictions = rows.groupby("mu")
    fig, axes = plt.subplots(1, len(frictions), figsize=(3.9 * len(frictions) + 0.6, 4.1), squeeze=False, sharey=True)
    for axis, (mu, of_friction) in zip(axes[0], frictions):
        for target, (colour, marker) in TARGET_LOOK.items():
            for method, line, face in ((REFERENCE, "--", "none"), (ours, "-", colour)):
                own = of_friction[(of_friction.target == target) & (of_friction.method == method)]
                # A size where a seed was not solved has no median to show.
                sizes = own[~own.disks.isin(own.disks[own.status != SOLVED])].groupby("disks").sweeps
                middle = sizes.median()
                axis.errorbar(middle.index, middle, [middle - sizes.min(), sizes.max() - middle], color=colour, marker=marker,
                              markerfacecolor=face, linestyle=line, linewidth=1, elinewidth=0.6, capsize=2)
        axis.set(xscale="log", yscale="log", title=rf"$\mu$ = {mu:g}", xlabel="disks")
    axes[0, 0].set_ylabel("sweeps")
    entries = [dict(color=colour, marker=marker, ls="none", label=f"to 1e{round(math.log10(target))}")
               for target, (colour, marker) in TARGET_LOOK.items()]
    entries += [dict(color=style.GREY["77"], label=ours), dict(color=style.GREY["77"], ls="--", marker="o", mfc="none", label="plain Gauss-Seidel")]
    style.legend(axes[0, -1], entries, fontsize=7)
    fig.suptitle("Sweeps against size, cold start; a point is missing where a seed did not reach the error", fontsize=10)
    return fig
