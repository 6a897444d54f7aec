"""MD's springs against the effective stiffness of Contact Dynamics with few sweeps: one curve?"""

import numpy as np

from analysis import loops, observables, style
from yade_scripts import effective_medium, parameters

TITLE = "Is the difference between MD and CD only stiffness?"
QUESTION = ("Contact Dynamics with N_I sweeps a step has the contact stiffness kappa = q m N_I/dt^2. Where kappa is made equal to the stiffness of MD's "
            "springs, k_n to 100 k_n at one pressure, do the loops of both methods fall on one curve?")
TABLES = {"quick": ("quick/stiffness.txt",), "full": ("stiffness.txt",)}

# Contacts of CD part where the springs' would (gaps count from touching) or at once (from the overlaps the springs left).
MD, AS_SPRINGS, AS_RIGID = "MD", "CD, parting as springs", "CD, parting as rigid"
COLOUR = {MD: style.COLOUR["MD"], AS_SPRINGS: style.COLOUR["CD"], AS_RIGID: "#009E73"}
MARKER = {MD: "o", AS_SPRINGS: "s", AS_RIGID: "^"}


def kind(run):
    """Which of the three media a run is."""
    if run.method == "MD":
        return MD
    return AS_RIGID if run.parameters["reference_overlaps"] else AS_SPRINGS


def stiffness_ratio(run):
    """Stiffness of the contacts over the k_n of the table: MD's springs, or kappa."""
    row = run.parameters
    return (parameters.stiffness(row) if run.method == "MD" else effective_medium.stiffness(row)) / row["kn"]


def _key(run):
    row = run.parameters
    sweeps = (row["fixed_iterations"], effective_medium.step(row)) if run.method == "CD" else (0, 0.0)
    return kind(run), row["stiffening"], *sweeps, row["kt_over_kn"], row["period"]


def summarize(runs):
    """One row a medium and setting, over the packings. Strains times stiffness, `scaled_`, are equal on one curve.

    `comparison` is empty for the rows to be compared, "check" for those whose k_t/k_n or period differs from the others'.
    """
    usual = [_key(run)[4:] for run in runs]
    plain = max(set(usual), key=usual.count)
    groups = loops.grouped(runs, _key)
    return [_row(*key, group, None if key[4:] == plain else _same_packings(groups.get(key[:4] + plain, ()), group)) for key, group in groups.items()]


def _same_packings(others, group):
    """Those of `others` whose packings have the seeds of the group."""
    seeds = {run.attributes["seed"] for run in group}
    return [run for run in others if run.attributes["seed"] in seeds]


def _row(medium, stiffening, sweeps, step, kt_over_kn, period, group, compared):
    """compared: None for a row of the comparison, for a check the runs that it varies."""
    ratio = stiffness_ratio(group[0])
    modulus = [observables.stiffness(run.values("gamma"), run.values("sigma2")) for run in group]
    return {
        "medium": medium, "stiffness_over_kn": ratio, "springs_over_kn": stiffening, "sweeps": sweeps, "step_s": step, "kt_over_kn": kt_over_kn,
        "period_s": period, "comparison": "" if compared is None else "check", "packings": len(group), **loops.spread(group),
        **{f"scaled_{name}": value for name, value in loops.spread(group, ratio).items()},
        "modulus_over_stiffness_per_m": float(np.mean(modulus)) * group[0].parameters["depth"] / (ratio * group[0].parameters["kn"]),
        "sliding_most": max(int(run.values("sliding_contacts").max()) for run in group),
        "stress_error": max(observables.stress_error(run) for run in group),
        **({f"compared_{name}": value for name, value in loops.spread(compared).items() if name in loops.QUANTITIES} if compared else {})}


def draw(runs, rows, path):
    """Left: the loop's numbers against the stiffness. Right: loops of one packing, strains times stiffness."""
    fig, (left, middle, right) = style.plt.subplots(1, 3, figsize=(12, 4.4))
    for axes, name in ((left, "largest"), (middle, "remanent")):
        for medium, marker in MARKER.items():
            part = [row for row in rows if row["medium"] == medium and not row["comparison"]]
            if part:
                loops.draw_spread(axes, [row["stiffness_over_kn"] for row in part], part, name, fmt=marker, color=COLOUR[medium], mfc="none",
                                  label=medium)
        first = next((row for row in rows if row["medium"] == MD), None)
        if first:
            x = np.array(sorted({row["stiffness_over_kn"] for row in rows}))
            axes.plot(x, first[name] * first["stiffness_over_kn"] / x, ":", color="k", lw=0.8, label="inverse to the stiffness")
        axes.set(xscale="log", yscale="log", xlabel=r"stiffness of a contact: $k_n$ or $\kappa$, over the softest $k_n$",
                 title=loops.QUANTITIES[name])
        axes.legend()
    left.set_ylabel(r"strain $\gamma$")
    _draw_loops(right, runs)
    style.finish(fig, runs, path, r"$\kappa = q m N_I/\Delta t^2$, nothing fitted; bars: smallest and largest of the packings", foot=0.13)


def _draw_loops(axes, runs):
    """The loops of the first packing at the softest and at ten times the stiffness."""
    seed = runs[0].attributes["seed"]
    shown = {}
    for run in runs:
        if run.attributes["seed"] == seed and run.parameters["stiffening"] in (1, 10):
            shown.setdefault((kind(run), run.parameters["stiffening"]), run)
    for (medium, stiffening), run in shown.items():
        gamma = run.values("gamma") * stiffness_ratio(run)
        axes.plot(-gamma, run.values("sigma2") / run.pressure, "-" if stiffening == 1 else "--", color=COLOUR[medium], lw=1,
                  label=f"{medium}, {stiffening:g} $k_n$")
    axes.set(xlabel=r"$-\gamma$ times stiffness over $k_n$", ylabel=r"$\sigma_2/P_0$", title=f"loops of packing {seed}")
    axes.set_xlim(right=1.8 * axes.get_xlim()[1])  # room for the legend
    axes.ticklabel_format(axis="x", style="sci", scilimits=(0, 0))
    axes.legend(loc="lower right")


def answer(rows):
    """What was found, by the numbers of the rows."""
    springs = {row["springs_over_kn"]: row for row in rows if row["medium"] == MD and not row["comparison"]}
    texts = []
    for medium in (AS_SPRINGS, AS_RIGID):
        pairs = [(row, springs[row["springs_over_kn"]]) for row in rows
                 if row["medium"] == medium and not row["comparison"] and row["springs_over_kn"] in springs]
        if pairs:
            texts.append(f"{medium}: " + ", ".join(f"{words} {_range(pairs, name)}" for name, words in (
                ("largest", "largest |gamma|"), ("width", "width of the loop"), ("remanent", "remanent strain"))) + " times MD's")
    if not texts:
        return "No pair of an MD and a CD run of one stiffness has finished."
    stiff = [row["springs_over_kn"] for row in springs.values()]
    text = (f"Means over the packings, at {min(stiff):g} to {max(stiff):g} k_n, with strains times stiffness so that kappa need not match exactly. "
            + "; ".join(texts) + ".")
    text += (f" MD's own strains times stiffness stay within {_own(springs, 'largest')} (largest) and {_own(springs, 'remanent')} (remanent) of "
             "their values at the softest, the packings being prepared anew for each stiffness. So yes, where the contacts of CD also part where the "
             "springs' would: few sweeps a step make of it what MD is. Contacts that part as rigid ones, as soon as they reopen at all, leave a "
             "narrower loop and less remanent strain than springs of the same stiffness.")
    checks = [row for row in rows if row["comparison"]]
    if checks:
        text += " Checks: " + "; ".join(_check(row) for row in checks) + "."
    return text + (" The theory's kappa is that of a chain in the limit of long waves and few sweeps; in two dimensions it is a guess that is tested "
                   "here, at one load below yield. Along the contact the sweeps are W_nn/W_tt = 1/3 as stiff, whatever MD's k_t/k_n.")


def _range(pairs, name):
    """Smallest and largest ratio of CD to MD, strains scaled by their stiffness."""
    ratios = [cd[f"scaled_{name}"] / md[f"scaled_{name}"] for cd, md in pairs]
    return f"{min(ratios):.2f} to {max(ratios):.2f}"


def _own(springs, name):
    """Smallest and largest scaled strain of MD over that at the softest springs."""
    first = springs[min(springs)][f"scaled_{name}"]
    ratios = [row[f"scaled_{name}"] / first for row in springs.values()]
    return f"{min(ratios):.2f} to {max(ratios):.2f}"


def _check(row):
    """A check's row against the runs of the same packings that it varies."""
    what = f"{row['medium']} at {row['springs_over_kn']:g} k_n with k_t/k_n = {row['kt_over_kn']:.2g} and a period of {row['period_s']:g} s"
    if "compared_largest" not in row:
        return f"{what}: largest |gamma| {row['largest']:.2e}, remanent {row['remanent']:.2e}"
    return (f"{what}: largest |gamma| {row['largest'] / row['compared_largest']:.2f}, remanent {row['remanent'] / row['compared_remanent']:.2f} times "
            "those of the comparison")
