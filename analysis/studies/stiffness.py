"""Compares MD's springs with Contact Dynamics of few sweeps, which has an effective stiffness."""
import numpy as np
import pandas

from analysis import loops, observables, style, summary
from analysis.style import plt
from yade_scripts import parameters
from yade_scripts.tables import product
from yade_scripts.theory import effective_medium

TITLE = "Is the strain of springs only their softness?"
QUESTION = "Springs of k_n to 100 k_n; and CD with so few sweeps a step that its contacts are as soft as springs: kappa = q m N_I/dt^2."
ORDER = 1.4  # in the report
LOADING = dict(loading="cosine", period=1.0)
# For each stiffness of the springs the pairs (sweeps a step, step) whose kappa = q m N_I/dt^2 is the same.
PAIRS = {1: ((75, 5e-3), (19, 2.5e-3), (5, 1.25e-3)), 3: ((56, 2.5e-3), (14, 1.25e-3)), 10: ((47, 1.25e-3), (12, 6.25e-4)),
         30: ((35, 6.25e-4), (9, 3.125e-4)), 100: ((116, 6.25e-4), (29, 3.125e-4))}
SPRINGS = dict(method="MD", md_walls="force", **LOADING)


def _rigid(pairs, seed=1, **more):
    base = dict(method="CD", solver_seed=1, seed=seed) | LOADING | more
    return [row for stiffening, several in pairs.items() for sweeps, step in several
            for row in product(stiffening=stiffening, fixed_iterations=sweeps, cd_dt=step, **base)]


BOTH = dict(reference_overlaps=(False, True))
SLOW = dict(period=2.0, records_per_cycle=400)
ROWS = {"quick": product(stiffening=(1, 10), **SPRINGS) + _rigid({1: PAIRS[1][1:2], 10: PAIRS[10][:1]}, **BOTH),
        "full": product(stiffening=tuple(PAIRS), seed=range(1, 6), **SPRINGS) + _rigid(PAIRS, range(1, 6), **BOTH)
        # Checks: k_t = k_n/3, the ratio of a contact that a sweep solves by itself, and twice the period.
        + product(stiffening=(1, 10), kt_over_kn=0.3333, **SPRINGS) + product(stiffening=(1, 10), **SPRINGS | SLOW)
        + _rigid({1: PAIRS[1][1:2], 10: PAIRS[10][:1]}, reference_overlaps=False, **SLOW)}

# Contacts of CD open where those of springs would (gaps are measured from touching) or at once (gaps are measured from the springs' overlaps).
MD, AS_SPRINGS, AS_RIGID = "MD", "CD, parting as springs", "CD, parting as rigid"
COLOUR = {MD: style.COLOUR["MD"], AS_SPRINGS: style.COLOUR["CD"], AS_RIGID: style.GREEN}
MARKER = {MD: "o", AS_SPRINGS: "s", AS_RIGID: "^"}


def kind(run):
    """Return which of the three media a run is."""
    if run.method == "MD":
        return MD
    return AS_RIGID if run.parameters["reference_overlaps"] else AS_SPRINGS


def stiffness_ratio(run):
    """Return the stiffness of the contacts over the k_n of the table: MD's springs, or kappa."""
    row = run.parameters
    return (parameters.stiffness(row) if run.method == "MD" else effective_medium.stiffness(row)) / row["kn"]


def _key(run):
    row = run.parameters
    sweeps = (row["fixed_iterations"], effective_medium.step(row)) if run.method == "CD" else (0, 0.0)
    return kind(run), row["stiffening"], *sweeps, row["kt_over_kn"], row["period"]


def summarize(runs):
    """Return one row a medium and setting, over the packings. Strains times stiffness are equal on one curve: `scaled_` of the
    mean, and of single packings ("scaled_largest, packing 1").

    `comparison` is empty for the rows to be compared, "check" for those whose k_t/k_n or period differs from the others'.
    """
    usual = [_key(run)[4:] for run in runs]
    plain = max(set(usual), key=usual.count)
    groups, rows = summary.groups(runs, _key, ordered=False), []
    for key, group in groups.items():
        medium, stiffening, sweeps, step, kt_over_kn, period = key
        ratio, seeds, check = stiffness_ratio(group[0]), {run.attributes["seed"] for run in group}, key[4:] != plain
        modulus = [observables.stiffness(run.values("gamma"), run.values("sigma2")) for run in group]
        rows.append({
            "medium": medium, "stiffness_over_kn": ratio, "springs_over_kn": stiffening, "sweeps": sweeps, "step_s": step, "kt_over_kn": kt_over_kn,
            "period_s": period, "comparison": "check" if check else "", "packings": len(group), **loops.spread(group),
            **{f"scaled_{name}": value for name, value in loops.spread(group, ratio).items()},
            "modulus_over_stiffness_per_m": np.mean(modulus) * group[0].parameters["depth"] / (ratio * group[0].parameters["kn"]),
            **{f"scaled_{name}, packing {run.attributes['seed']}": ratio * loops.of(run)[name] for run in group for name in ("largest", "remanent")},
            "sliding_most": max(int(run.values("sliding_contacts").max()) for run in group),
            "stress_error": max(observables.stress_error(run) for run in group)})
        # A check is compared with the runs of the usual settings, of the same seeds.
        if check and (same := [run for run in groups.get(key[:4] + plain, ()) if run.attributes["seed"] in seeds]):
            rows[-1] |= {f"compared_{name}": value for name, value in loops.spread(same).items() if name in loops.QUANTITIES}
    return rows


def draw(runs, rows, path):
    """Draw the loop's numbers against the stiffness on the left, on the right loops of one packing, strains times stiffness."""
    fig, (left, middle, right) = plt.subplots(1, 3, figsize=(12, 4.4))
    table = pandas.DataFrame(rows)
    for axes, name in ((left, "largest"), (middle, "remanent")):
        for medium, marker in MARKER.items():
            if len(part := table[(table.medium == medium) & (table.comparison == "")]):
                loops.draw_spread(axes, part, "stiffness_over_kn", name, fmt=marker, color=COLOUR[medium], mfc="none", label=medium)
        for _, first in table[table.medium == MD].head(1).iterrows():
            x = np.unique(table.stiffness_over_kn)
            axes.plot(x, first[name] * first.stiffness_over_kn / x, ":", color="k", lw=0.8, label="inverse to the stiffness")
        axes.set(xscale="log", yscale="log", xlabel=r"stiffness of a contact: $k_n$ or $\kappa$, over the softest $k_n$",
                 title=loops.QUANTITIES[name])
        axes.legend()
    left.set_ylabel(r"strain $\gamma$")
    _draw_loops(right, runs)
    style.finish(fig, path, "kappa = q m N_I/dt^2, nothing fitted; bars: smallest and largest of the packings", runs)


def _draw_loops(axes, runs):
    """Draw the loops of the first packing at the softest and at ten times the stiffness."""
    seed = runs[0].attributes["seed"]
    shown = [run for run in runs if run.attributes["seed"] == seed and run.parameters["stiffening"] in (1, 10)]
    for (medium, stiffening), (run, *_) in summary.groups(shown, lambda run: (kind(run), run.parameters["stiffening"]), ordered=False).items():
        axes.plot(-run.values("gamma") * stiffness_ratio(run), run.values("sigma2") / run.pressure, "-" if stiffening == 1 else "--",
                  color=COLOUR[medium], lw=1, label=f"{medium}, {stiffening:g} $k_n$")
    axes.set(xlabel=r"$-\gamma$ times stiffness over $k_n$", ylabel=r"$\sigma_2/P_0$", title=f"loops of packing {seed}")
    axes.set_xlim(right=1.8 * axes.get_xlim()[1])  # room for the legend
    axes.ticklabel_format(axis="x", style="sci", scilimits=(0, 0))
    axes.legend(loc="lower right")


def quantities(table):
    main = table[table.comparison.isna() | (table.comparison == "")]
    md = main[main.medium == MD].set_index("springs_over_kn").sort_index()
    seeds = range(1, md.packings.min() + 1)

    def powers(name):
        """Return the exponents of k_n, packing by packing."""
        return [np.polyfit(np.log(md.index.astype(float)), np.log(md[f"scaled_{name}, packing {seed}"] / md.index), 1)[0] for seed in seeds]

    def over_springs(medium, name):
        """Return each value over that of MD for the same packing and stiffness."""
        own, columns = main[main.medium == medium], [f"scaled_{name}, packing {seed}" for seed in seeds]
        return pandas.Series((own[columns].to_numpy() / md.loc[own.springs_over_kn, columns].to_numpy()).ravel())

    checks = table[(table.comparison == "check") & (table.medium == MD) & (table.kt_over_kn < 0.5)]
    return {"md": md, "powers": powers, "softer": checks.largest / checks.compared_largest,
            "springs": {name: over_springs(AS_SPRINGS, name) for name in ("largest", "remanent")},
            "rigid": {name: over_springs(AS_RIGID, name) for name in ("largest", "remanent")}}
