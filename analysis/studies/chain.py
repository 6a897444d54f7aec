"""Too few sweeps make a row of rigid disks swing like a soft one: the textbook case of under-converged Contact Dynamics."""

import numpy as np

from analysis import loops, style
from yade_scripts import effective_medium

TITLE = "A row of 50 rigid disks under too few sweeps"
QUESTION = ("With N_I Gauss-Seidel sweeps a step Contact Dynamics behaves as an elastic medium of stiffness kappa = q m N_I/dt^2, dashpots "
            "q m N_I/dt beside the springs (Unger, Brendel, Wolf and Kertesz 2002). Does this engine show the period and the decay that follow?")
TABLES = {"quick": ("quick/chain.txt",), "full": ("chain.txt",)}

# What a row does, by (warm start, gap correction, a fixed number of sweeps); see effective_medium.py.
MEMORY, OVERLAP, CREEPS, OVERSHOOTS, SOLVED = "elastic by memory", "elastic by overlap", "creeps", "overshoots", "solved"
COLOUR = {MEMORY: "#0072B2", OVERLAP: "#D55E00", CREEPS: "#009E73", OVERSHOOTS: "#CC79A7", SOLVED: "#1A1A1A"}
MARKER = {MEMORY: "o", OVERLAP: "s"}
SIZE = {MEMORY: 8, OVERLAP: 4}  # they lie on each other


def kind(run):
    """What the row is expected to do."""
    row = run.parameters
    if not row["fixed_iterations"]:
        return SOLVED
    return {(True, True): OVERSHOOTS, (True, False): MEMORY, (False, True): OVERLAP, (False, False): CREEPS}[
        row["warm_start"], row["gap_correction"] > 0]


def summarize(runs):
    """One row a kind and number of sweeps, over the orders of the sweeps: measured against the theory, in steps."""
    return [_row(*key, group) for key, group in loops.grouped(runs, lambda run: (kind(run), run.parameters["fixed_iterations"])).items()]


def _row(what, sweeps, group):
    full = group[0].parameters
    row = {"row": what, "sweeps": sweeps, "orders_of_sweeps": len(group), "end_over_rest": _mean(_way(run)[-1] for run in group),
           "furthest_over_rest": _mean(np.abs(_way(run)).max() for run in group)}
    if not sweeps:
        return row
    row["kappa_N_per_m"] = effective_medium.stiffness(full)
    for name in ("swing_period", "swing_decay"):
        measured = np.array([run.known[name].measured for run in group if name in run.known])
        if len(measured):
            row |= {f"{name}_theory": group[0].known[name].exact, f"{name}_measured": float(np.mean(measured)),
                    f"{name}_low": float(measured.min()), f"{name}_high": float(measured.max())}
    return row


def _mean(values):
    return float(np.mean(list(values)))


def _way(run):
    """Way of the free end over that at rest, after every step."""
    return run.extra["end_displacement"] / float(run.extra["end_at_rest"])


def draw(runs, rows, path):
    """Left: the end of the row after the push. Right: period and decay against the sweeps, where there are several."""
    plt = style.plt
    fig, (left, right) = plt.subplots(1, 2, figsize=(9.5, 4.2))
    _draw_way(left, runs)
    _draw_theory(right, rows)
    note = ("A constant force pushes the last disk from step 0 on. Memory: warm start, no gap correction; overlap: cold start, gap correction 1; "
            "theory: damped elastic rod, nothing fitted")
    style.finish(fig, runs, path, note, foot=0.13)


def _draw_way(axes, runs):
    shown = {}
    for run in runs:
        if run.parameters["fixed_iterations"] in (0, 40):
            shown.setdefault(kind(run), run)
    for what, run in shown.items():
        way = _way(run)
        axes.plot(np.arange(len(way)), way, color=COLOUR[what], label=what)
    elastic = next((run for what, run in shown.items() if what in MARKER), None)
    if elastic:
        steps = np.arange(len(_way(elastic)))
        axes.plot(steps, effective_medium.chain_response(elastic.parameters, steps * effective_medium.step(elastic.parameters)), "k--", lw=0.9,
                  label="theory")
    axes.set(xlabel="step", ylabel="way of the free end / way at rest", ylim=(-0.5, 3), title="50 disks, 40 sweeps a step")
    axes.legend(ncol=2)


def _draw_theory(axes, rows):
    for what, marker in MARKER.items():
        for name, filled in (("swing_period", True), ("swing_decay", False)):
            part = [row for row in rows if row["row"] == what and f"{name}_measured" in row]
            if part:
                loops.draw_spread(axes, [row["sweeps"] for row in part], [row | {name: row[f"{name}_measured"]} for row in part], name,
                                  fmt=marker, color=COLOUR[what], ms=SIZE[what],
                                  mfc=COLOUR[what] if filled else "none", label=f"{'period' if filled else 'decay time'}, {what}")
    for name, words, line in (("swing_period", "period", "-"), ("swing_decay", "decay time", "--")):
        part = sorted({(row["sweeps"], row[f"{name}_theory"]) for row in rows if f"{name}_theory" in row})
        axes.plot(*zip(*part), line, color="k", lw=0.9, marker="" if len(part) > 1 else "_", label=f"{words}, theory")
    axes.set(xscale="log", yscale="log", xlabel="sweeps a step $N_I$", ylabel="steps", title="period and decay time")
    axes.legend()


def answer(rows):
    """What was found, by the numbers of the rows."""
    found = {(row["row"], row["sweeps"]): row for row in rows}
    parts = []
    for what in (MEMORY, OVERLAP):
        row = found.get((what, 40))
        if row and "swing_period_measured" in row:
            parts.append(f"{what}: period {row['swing_period_measured']:.1f} steps (theory {row['swing_period_theory']:.1f}), decay "
                         f"{row['swing_decay_measured']:.1f} ({row['swing_decay_theory']:.1f}; "
                         f"{row['swing_decay_low']:.1f} to {row['swing_decay_high']:.1f}, orders of the sweeps tried: {row['orders_of_sweeps']})")
    text = "Yes. With 40 sweeps, " + "; ".join(parts) + "." if parts else "No elastic row has finished."
    others = [row for row in rows if row["row"] in (MEMORY, OVERLAP) and row["sweeps"] != 40 and "swing_period_measured" in row]
    if others:
        worst = max(abs(row["swing_period_measured"] / row["swing_period_theory"] - 1) for row in others)
        text += (f" From {min(row['sweeps'] for row in others)} to {max(row['sweeps'] for row in others)} sweeps the period is within "
                 f"{100 * worst:.1f} % of 4 L/c.")
    if (CREEPS, 40) in found:
        text += (" Springs need either the forces of the step before or the overlaps: with neither the row creeps, to "
                 f"{found[CREEPS, 40]['furthest_over_rest']:.0f} times the way at rest")
        if (OVERSHOOTS, 40) in found:
            text += f"; with both it overshoots by more and more, to {found[OVERSHOOTS, 40]['furthest_over_rest']:.0f} times"
        text += "."
    if (SOLVED, 0) in found:
        text += f" Solved to the tolerance it moves {found[SOLVED, 0]['furthest_over_rest']:.1e} of that way: it is rigid."
    return text + (" The theory is one of long waves; it leaves out half a diameter of length, sweeps that do not quite add up, the scatter of the "
                   "random orders and, by overlap, the ends of the row.")
