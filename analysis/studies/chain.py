"""With too few sweeps a row of rigid disks oscillates like a soft one: the textbook case of Contact Dynamics that is not converged."""
import numpy as np
import pandas

from analysis import loops, style, summary
from analysis.style import plt
from yade_scripts.tables import product
from yade_scripts.theory import effective_medium

TITLE = "Are rigid contacts elastic if the solver stops early?"
QUESTION = "A row of 50 rigid disks, pushed at its end, with too few sweeps a step, against the theory of a damped elastic rod."
ORDER = 22  # in the report
PART = "appendix"
ELASTIC = (dict(warm_start=True, gap_correction=0.0), dict(warm_start=False, gap_correction=1.0))
OTHERS = (dict(warm_start=False, gap_correction=0.0), dict(warm_start=True, gap_correction=1.0))
FIRST = [dict(scene="chain") | way for way in (*ELASTIC, *OTHERS)] + [dict(scene="chain", fixed_iterations=0, solver_seed=0)]
# Sweeps a step, steps (about five periods each, at most ten decay times), and orders of the sweeps.
SERIES = ((40, 200, range(2, 6)), *((sweeps, steps, range(1, 4)) for sweeps, steps in ((5, 500), (10, 400), (20, 300), (80, 140), (160, 100))))
ROWS = {"quick": FIRST,
        "full": FIRST + [row for sweeps, steps, orders in SERIES for way in ELASTIC for row in product(
            scene="chain", fixed_iterations=sweeps, period=steps / 1000, records_per_cycle=steps, solver_seed=orders, **way)]}

# What a row does, by (warm start, gap correction, a fixed number of sweeps); see effective_medium.py.
MEMORY, OVERLAP, CREEPS, OVERSHOOTS, SOLVED = "elastic by memory", "elastic by overlap", "creeps", "overshoots", "solved"
COLOUR = {MEMORY: style.BLUE, OVERLAP: style.VERMILION, CREEPS: style.GREEN, OVERSHOOTS: style.PINK, SOLVED: style.INK}
MARKER = {MEMORY: "o", OVERLAP: "s"}
SIZE = {MEMORY: 8, OVERLAP: 4}  # they lie on each other


def kind(run):
    """Return what the row is expected to do."""
    row = run.parameters
    if not row["fixed_iterations"]:
        return SOLVED
    if row["warm_start"]:
        return OVERSHOOTS if row["gap_correction"] else MEMORY
    return OVERLAP if row["gap_correction"] else CREEPS


def summarize(runs):
    """Return one row a kind and number of sweeps, over the orders of the sweeps: measured against the theory, in steps."""
    rows = []
    for (what, sweeps), group in summary.groups(runs, lambda run: (kind(run), run.parameters["fixed_iterations"]), ordered=False).items():
        rows.append({"row": what, "sweeps": sweeps, "orders_of_sweeps": len(group), "end_over_rest": np.mean([_way(run)[-1] for run in group]),
                     "furthest_over_rest": np.mean([np.abs(_way(run)).max() for run in group])})
        if sweeps:
            rows[-1]["kappa_N_per_m"] = effective_medium.stiffness(group[0].parameters)
        for name in ("swing_period", "swing_decay") if sweeps else ():
            if len(measured := np.array([run.known[name].measured for run in group if name in run.known])):
                rows[-1] |= {f"{name}_theory": group[0].known[name].exact, f"{name}_measured": measured.mean(),
                             f"{name}_low": measured.min(), f"{name}_high": measured.max()}
    return rows


def _way(run):
    """Return the path of the free end over that at rest, after every step."""
    return run.extra["end_displacement"] / float(run.extra["end_at_rest"])


def draw(runs, rows, path):
    """Draw the end of the row after the push on the left, on the right period and decay against the sweeps, where there are several."""
    fig, (left, right) = plt.subplots(1, 2, figsize=(9.5, 4.2))
    shown = {kind(run): run for run in reversed(runs) if run.parameters["fixed_iterations"] in (0, 40)}  # the first run of each kind
    for what, run in reversed(shown.items()):
        left.plot(_way(run), color=COLOUR[what], label=what)
    if elastic := next((run for what, run in shown.items() if what in MARKER), None):
        times = np.arange(len(_way(elastic))) * effective_medium.step(elastic.parameters)
        left.plot(effective_medium.chain_response(elastic.parameters, times), "k--", lw=0.9, label="theory")
    left.set(xlabel="step", ylabel="displacement of the free end / that at rest", ylim=(-0.5, 3), title="50 disks, 40 sweeps a step")
    left.legend(ncol=2)
    _draw_theory(right, pandas.DataFrame(rows))
    style.finish(fig, path, "A constant force pushes the last disk. Memory: warm start, no gap correction; overlap: the reverse. "
                 "Theory: damped elastic rod, nothing fitted.", runs)


def _draw_theory(axes, table):
    for what, marker in MARKER.items():
        for name, words, face in (("swing_period", "period", None), ("swing_decay", "decay time", "none")):
            part = table[table["row"] == what].rename(columns={f"{name}_measured": name})
            if name in part:
                loops.draw_spread(axes, part.dropna(subset=name), "sweeps", name, fmt=marker, color=COLOUR[what], ms=SIZE[what], mfc=face,
                                  label=f"{words}, {what}")
    for name, words, line in (("swing_period", "period", "-"), ("swing_decay", "decay time", "--")):
        part = table.reindex(columns=["sweeps", f"{name}_theory"]).dropna().drop_duplicates().sort_values("sweeps")
        axes.plot(part.sweeps, part[f"{name}_theory"], line, color="k", lw=0.9, marker="" if len(part) > 1 else "_", label=f"{words}, theory")
    axes.set(xscale="log", yscale="log", xlabel="sweeps a step $N_I$", ylabel="steps", title="period and decay time")
    axes.legend()


def quantities(table):
    row = table.set_index(["row", "sweeps"]).sort_index()
    off = pandas.DataFrame({name: row[f"swing_{name}_measured"] / row[f"swing_{name}_theory"] - 1 for name in ("period", "decay")})
    return {"row": row, "memory": row.loc[MEMORY, 40], "overlap": row.loc[OVERLAP, 40], "off": off.loc[[MEMORY, OVERLAP]]}
