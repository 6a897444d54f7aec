"""Figures of `make bench`: error against time, cost of a sweep against size, sweeps against N."""
import math
import statistics
from pathlib import Path

import pandas

from analysis import publish, style
from analysis.style import plt
from yade_scripts.results import provenance
from yade_scripts.results.reader import ResultError

PEER, REFERENCE, SOLVED = "siconos nsgs", "nsgs", "solved"
# Okabe and Ito's palette, with a marker of its own for each method.
LOOK = {PEER: ("#000000", "X"), REFERENCE: ("#D55E00", "s"), "accelerated": ("#0072B2", "o"), "newton": ("#009E73", "^"), "auto": ("#CC79A7", "D")}
TARGET_LOOK = {1e-4: ("#0072B2", "o"), 1e-6: ("#009E73", "s"), 1e-8: ("#D55E00", "^")}
PANELS = 6
# What the figures need.
ORIGIN = {"commit": str, "processor": str, "processes_running_before": (int, float), "instruction_sets": list, "default_method": str}
TEXTS = "status", "problem", "kind", "start", "method", "order"
COLUMNS = {"solutions": ("status", "problem", "kind", "start", "method", "disks", "contacts", "mu", "target", "sweeps", "seconds", "residual"),
           "sweeps": ("contacts", "accelerated_ns", "bound_plain_ns", "bound_accelerated_ns", "bytes_plain", "bytes_accelerated", "bandwidth_gb_per_s"),
           "step": ("order", "disks", "contacts", "tolerance", "ns_a_contact", "seconds_of_springs", "over_springs")}


def draw(folder):
    """Draw all that the tables in `folder` have rows for; the paths of the figures."""
    folder = Path(folder)
    origin = publish.read_json(folder / "provenance.json", ORIGIN)
    solutions, sweeps, steps = (_rows(folder / f"{name}.csv", columns) for name, columns in COLUMNS.items())
    drawn = []
    for name, table, rows, figure in (("error_against_time", "solutions", solutions, error_against_time), ("sweep_cost", "sweeps", sweeps, sweep_cost),
                                      ("sweeps_against_size", "solutions", solutions, sweeps_against_size), ("step_cost", "step", steps, step_cost)):
        of_table = origin.get("tables", {}).get(table, origin)  # a table that was measured by itself
        if rows and (fig := figure(rows, of_table)):
            drawn.append(_save(fig, of_table, folder / f"{name}.png"))
    return drawn


def _rows(path, columns):
    """Return the rows of a table; empty cells are None. ResultError where it lacks a column or one that must hold numbers does not."""
    if not path.exists():
        return []
    table = publish.read_table(path)
    missing = [name for name in columns if name not in table]
    if missing:
        raise ResultError(path, f"has no column {', '.join(missing)}", "make the tables: make bench")
    wrong = [name for name in columns if name not in TEXTS and not pandas.api.types.is_numeric_dtype(table[name])]
    if wrong:
        raise ResultError(path, f"holds no numbers in {', '.join(wrong)}", "make the tables: make bench")
    return table.astype(object).where(table.notna(), None).to_dict("records")


def _save(fig, origin, path):
    busy = origin["processes_running_before"]
    style.finish(fig, path, "Processor time of one core; the error is found by code that shares nothing with the solvers.",
                 f"commit {provenance.short(origin['commit'])}, {origin['processor']}" + (f"; {busy:.1f} other processes were running" if busy > 0.5 else ""))
    return path


def _look(method, known={}):
    """Return colour and marker; of a method that is not in the list, one of those left."""
    return LOOK.get(method) or known.setdefault(method, ("#E69F00", "v^<>ph*"[len(known) % 7]))


def chosen(rows):
    """Return the problems of the panels: of each kind, size, friction and start the first seed; large packings first."""
    first = {}
    for row in rows:
        first.setdefault((row["kind"], row["disks"], row["mu"], row["start"]), row["problem"])
    order = sorted(first, key=lambda key: (key[0] != "packing", key[3] != "cold", -(key[1] or 0), str(key[2])))
    packings = [key for key in order if key[0] == "packing"][:PANELS - min(2, sum(key[0] != "packing" for key in order))]
    others = [key for key in order if key[0] != "packing"]
    return [first[key] for key in (packings + others)[:PANELS]]


def error_against_time(rows, origin):
    """Return a panel a problem, a line a method: time to get there, and the error found there. Failures stand at the right edge, open."""
    problems = chosen(rows)
    wide = min(3, len(problems))
    high = -(-len(problems) // wide)
    fig, axes = plt.subplots(high, wide, figsize=(3.6 * wide + 0.4, 3.1 * high + 0.8), squeeze=False)
    names = list(dict.fromkeys(row["method"] for row in rows))
    for axis, problem in zip(axes.flat, problems):
        of_problem = [row for row in rows if row["problem"] == problem]
        times = [row["seconds"] for row in of_problem if row["seconds"]]
        edge = 3 * max(times, default=1)
        for method in names:
            colour, marker = _look(method)
            met = [row for row in of_problem if row["method"] == method and row["status"] == SOLVED and row["sweeps"]]
            axis.loglog([row["seconds"] for row in met], [row["residual"] for row in met], marker=marker, color=colour, markersize=5)
            missed = [row["residual"] for row in of_problem if row["method"] == method and row["status"] != SOLVED][:1]
            axis.loglog([edge] * len(missed), missed, marker=marker, color=colour, markerfacecolor="none", linestyle="none", markersize=7)
        axis.set_title(f"{problem}\n{of_problem[0]['contacts']:.0f} contacts", fontsize=9)
        axis.set_xlabel("processor time [s]")
        axis.grid(True, which="major", linewidth=0.3)
    for axis in axes[:, 0]:
        axis.set_ylabel("error $e$")
    for axis in list(axes.flat)[len(problems):]:
        axis.set_visible(False)
    handles = [plt.Line2D([], [], color=_look(name)[0], marker=_look(name)[1], label=name) for name in names]
    handles.append(plt.Line2D([], [], color="#777777", marker="o", markerfacecolor="none", linestyle="none", label="given up at this error"))
    spare = [axis for axis in axes.flat if not axis.get_visible()]
    (spare or list(axes.flat))[0].legend(handles=handles, fontsize=8 if spare else 7, loc="upper left" if spare else "best")
    for axis in spare[:1]:
        axis.set_visible(True)
        axis.axis("off")
    fig.suptitle("Error, found by code that shares nothing with the solvers, against time", fontsize=10)
    return fig


def sweep_cost(rows, origin):
    """Draw ns per contact against contacts, with what memory allows."""
    rows = sorted(rows, key=lambda row: row["contacts"])
    contacts = [row["contacts"] for row in rows]
    sets = [name for name in origin["instruction_sets"] if rows[0].get(f"plain_{name}_ns")]
    fig, axis = plt.subplots(figsize=(6.4, 4.4))
    for name, marker, colour in zip(sets, "osD", ("#0072B2", "#56B4E9", "#009E73")):
        axis.loglog(contacts, [row[f"plain_{name}_ns"] for row in rows], marker=marker, color=colour, label=f"plain sweep, {name}")
    axis.loglog(contacts, [row["accelerated_ns"] for row in rows], marker="^", color="#D55E00", label=f"accelerated sweep, {sets[0]}")
    beside = [row for row in rows if row.get("siconos_ns")]
    axis.loglog([row["contacts"] for row in beside], [row["siconos_ns"] for row in beside], marker="X", color="#000000", label="Siconos fc2d_nsgs")
    for kind, style_of_line in (("plain", ":"), ("accelerated", "--")):
        axis.loglog(contacts, [row[f"bound_{kind}_ns"] for row in rows], linestyle=style_of_line, color="#777777",
                    label=f"memory's bound, {kind} ({rows[-1][f'bytes_{kind}']:.0f} bytes, {rows[-1]['bandwidth_gb_per_s']:.0f} GB/s)")
    axis.set_xlabel("contacts")
    axis.set_ylabel("ns per contact and sweep")
    axis.grid(True, which="major", linewidth=0.3)
    axis.legend(fontsize=7)
    axis.set_title("One sweep; below the bound: what fits a cache is not read from memory")
    return fig


def step_cost(rows, origin):
    """Draw ns per contact of a whole warm step against the number of disks, for Contact Dynamics and for the springs of the same packing."""
    built = sorted((row for row in rows if row["order"] == "built"), key=lambda row: row["disks"])
    fig, axis = plt.subplots(figsize=(6.4, 4.4))
    for tolerance, (colour, marker) in TARGET_LOOK.items():
        ours = [row for row in built if row["tolerance"] == tolerance]
        if ours:
            axis.loglog([row["disks"] for row in ours], [row["ns_a_contact"] for row in ours], marker=marker, color=colour,
                        label=f"Contact Dynamics to {tolerance:.0e}")
    springs = [row for row in built if row["tolerance"] == built[0]["tolerance"]]
    axis.loglog([row["disks"] for row in springs], [1e9 * row["seconds_of_springs"] / row["contacts"] for row in springs], marker="X", color="#000000",
                label="YADE's springs")
    axis.set(xlabel="disks", ylabel="ns per contact and step", yticks=(100, 200, 500, 1000), yticklabels=("100", "200", "500", "1000"))
    axis.grid(True, which="major", linewidth=0.3)
    axis.legend(fontsize=7)
    axis.set_title("A whole step of a packing at rest, one thread")
    return fig


def sweeps_against_size(rows, origin):
    """Draw the sweeps of plain Gauss-Seidel and of the default method to three errors, cold packings: medians, and the range of the seeds."""
    rows = [row for row in rows if row["kind"] == "packing" and row["start"] == "cold"]
    frictions, ours = sorted({row["mu"] for row in rows}), origin["default_method"]
    if len({row["disks"] for row in rows}) < 2:
        return None  # one size makes no curve
    fig, axes = plt.subplots(1, len(frictions), figsize=(3.9 * len(frictions) + 0.6, 4.1), squeeze=False, sharey=True)
    for axis, mu in zip(axes[0], frictions):
        for target, (colour, marker) in TARGET_LOOK.items():
            for method, line, face in ((REFERENCE, "--", "none"), (ours, "-", colour)):
                of_method = [row for row in rows if (row["mu"], row["target"], row["method"]) == (mu, target, method)]
                # A size where a seed was not solved has no median to show.
                sizes = sorted({row["disks"] for row in of_method} - {row["disks"] for row in of_method if row["status"] != SOLVED})
                made = [[max(1, row["sweeps"]) for row in of_method if row["disks"] == size] for size in sizes]
                middle = [statistics.median(values) for values in made]
                below, above = zip(*((m - min(v), max(v) - m) for m, v in zip(middle, made))) if made else ((), ())
                axis.errorbar(sizes, middle, [below, above], color=colour, marker=marker, markerfacecolor=face, linestyle=line, linewidth=1,
                              elinewidth=0.6, capsize=2)
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.set_title(rf"$\mu$ = {mu:g}")
        axis.set_xlabel("disks")
        axis.grid(True, which="major", linewidth=0.3)
    axes[0, 0].set_ylabel("sweeps")
    handles = [plt.Line2D([], [], color=colour, marker=marker, linestyle="none", label=f"to 1e{round(math.log10(target))}")
               for target, (colour, marker) in TARGET_LOOK.items()]
    handles += [plt.Line2D([], [], color="#777777", linestyle="-", label=ours),
                plt.Line2D([], [], color="#777777", linestyle="--", marker="o", markerfacecolor="none", label="plain Gauss-Seidel")]
    axes[0, -1].legend(handles=handles, fontsize=7)
    fig.suptitle("Sweeps against size, cold start; points that are missing were not reached from every seed", fontsize=10)
    return fig
