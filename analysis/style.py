"""One look for all figures: colours and markers that tell methods apart without colour vision."""

import math
from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # after the backend is chosen
from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator

# Okabe and Ito's palette, distinct under the common colour-vision deficiencies.
COLOUR = {"MD": "#0072B2", "CD": "#D55E00"}
SLIDING, CHAIN, GRAIN, RATTLER = "#D55E00", "#1A1A1A", "#B8B8B8", "#E6E6E6"

plt.rcParams.update({
    "figure.dpi": 100, "savefig.dpi": 160, "font.size": 9, "font.family": "DejaVu Sans",
    "axes.titlesize": 10, "axes.labelsize": 9, "axes.linewidth": 0.7, "axes.spines.top": False,
    "axes.spines.right": False, "lines.linewidth": 1.2, "lines.markersize": 6, "legend.frameon": False,
    "legend.fontsize": 8, "xtick.labelsize": 8, "ytick.labelsize": 8, "axes.formatter.useoffset": False,
})


def finish(fig, runs, path, note="", foot=None):
    """Put the caption under the figure (`note`, then what was run) and write it; makes the folder if need be.

    Of several samples, loadings or settings the caption tells what they have in common. `foot`: share of the height that it needs,
    above which the panels are laid out tightly; without it they stay where they are.
    """
    _mend_logarithms(fig)
    if foot is not None:
        fig.tight_layout(rect=(0, foot, 1, 1))
    origin = "; ".join(filter(None, (missed(runs), provenance(*runs))))
    between = "; " if fig.get_figwidth() > 9 else "\n"
    lines = [note, ", ".join(_common(sample, runs)), between.join(_settings(runs)), origin]
    fig.text(0.5, 0.012, "\n".join(line for line in lines if line), ha="center", va="bottom", fontsize=7.5,
             linespacing=1.4)
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    description = f"{', '.join(run.path.name for run in runs)}; {origin}"
    # At most 2000 points wide: more is bytes that no screen shows.
    dpi = min(plt.rcParams["savefig.dpi"], 2000 / fig.get_figwidth())
    fig.savefig(path, dpi=dpi, metadata={"Description": description} if path.suffix == ".png" else None)
    plt.close(fig)


def _mend_logarithms(fig):
    """Linear axes where a logarithmic one has nothing positive to show, and few ticks where it spans less than a decade.

    Matplotlib finds no ticks for the one, and writes numbers over each other on the other.
    """
    for axes in fig.axes:
        for axis, scale in ((axes.xaxis, axes.set_xscale), (axes.yaxis, axes.set_yscale)):
            if axis.get_scale() != "log":
                continue
            low, high = sorted(axis.get_view_interval())
            if not math.isfinite(axis.get_minpos()):
                scale("linear")
            elif 0 < low and high < 10 * low:
                axis.set_major_locator(LogLocator(subs=(1, 2, 5)) if high > 4 * low else MaxNLocator(3))
                axis.set_major_formatter(lambda value, _: f"{value:g}")
                axis.set_minor_locator(NullLocator())


def _common(describe, runs):
    """The items of describe(run) that are the same for all runs."""
    described = [describe(run) for run in runs]
    return [item for item in described[0] if all(item in other for other in described)]


def _settings(runs, most=2):
    """method_settings of the different kinds of runs; where there are more than `most`, what each method's runs have in common."""
    kinds = list(dict.fromkeys((run.method, *method_settings(run)) for run in runs))
    if len(kinds) > most:
        kinds = [(method, *_common(method_settings, [run for run in runs if run.method == method]))
                 for method in dict.fromkeys(run.method for run in runs)]
    return [f"{method}: {', '.join(items)}" for method, *items in kinds]


def number(value, digits=3):
    """A number for a caption: 1.23, or 1.23 x 10^-4 in mathtext."""
    if not math.isfinite(value) or value == 0:
        return str(value)
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    if -2 <= int(exponent) < 4:
        return f"{float(f'{mantissa}e{exponent}'):g}"
    return rf"${mantissa}\times10^{{{int(exponent)}}}$"


def power_of_ten(values):
    """The exponent that brings the largest of `values` between 1 and 10; 0 if all vanish."""
    largest = max(abs(value) for value in values)
    return math.floor(math.log10(largest)) if largest else 0


def provenance(*runs):
    """What was run: the line that every figure carries at its foot."""
    commits = {run.attributes["git_commit"] for run in runs}
    text = f"commit {short(*commits)}" if len(commits) == 1 else f"{len(commits)} DIFFERENT COMMITS"
    code = f"{text}, YADE {runs[0].attributes['yade_version']}"
    states = sorted({run.attributes["state_sha256"][:12] for run in runs} - {""})
    if len(states) > 1:
        return f"{len(runs)} runs from {len(states)} prepared packings, {code}"
    if not states:
        return f"{len(runs)} runs, {code}"
    return f"prepared state {states[0]}, {code}, one sample (seed {runs[0].attributes['seed']})"


def missed(runs):
    """How many steps of how many runs missed the solver's tolerance; nothing where none did."""
    counts = [int(run.history["unconverged_steps"][-1]) for run in runs if "unconverged_steps" in run.history]
    if not any(counts):
        return ""
    return f"{np.count_nonzero(counts)} of {len(counts)} CD runs have steps that missed the tolerance, at most {max(counts)}"


def short(commit):
    """Twelve digits of a commit's hash, and what is appended to it."""
    digits, dash, suffix = commit.partition("-")
    return digits[:12] + dash + suffix


def sample(run):
    """The sample and its loading, item by item."""
    row = run.parameters
    pressure = f"$P_0$ = {number(run.pressure)} Pa = {number(row['pressure_ratio'])}$\\,k_n$"
    return [f"{row['disks']} disks", f"$\\mu$ = {row['friction']:g}", *([pressure] if run.attributes["state_sha256"] else []), *_loading(row)]


def _loading(row):
    if row["scene"] != "biaxial":
        return []
    if row["loading"] == "ramp":
        return [rf"ramp, $\alpha$ = {row['ramp_rate']:g}/s"]
    return [f"{row['loading']} loading", rf"$\Delta\sigma$ = {row['delta_sigma']:g}", f"$t_0$ = {row['period']:g} s"]


def method_settings(run):
    """What matters of the method's own parameters, item by item."""
    row = run.parameters
    if run.method == "MD":
        return [f"$k_n$ = {number(row['kn'] * row['stiffening'])} N/m", f"$k_t/k_n$ = {row['kt_over_kn']:g}",
                f"damping ratio {row['beta_n']:g}", f"walls by {row['md_walls']}"]
    effort = ([f"{row['fixed_iterations']} sweeps a step, no test"] if row["fixed_iterations"]
              else [f"tolerance {number(row['tolerance'])}", f"at most {row['max_iterations']} sweeps"])
    solver = "plain sweeps" if row["fixed_iterations"] else row["method_cd"]
    return [solver, *effort, f"step $\\leq$ {number(row['cd_dt'])} s", *(["walls by force"] if run.attributes["state_sha256"] else [])]


# Markers for up to eight kinds, told apart without colour.
MARKERS = "osD^vPX*"


def shades(values):
    """{value: (colour, marker)} for ordered values: viridis from dark to light, short of its yellow, which is faint on white."""
    ordered = sorted(set(values))
    colours = plt.get_cmap("viridis")([0.85 * k / max(1, len(ordered) - 1) for k in range(len(ordered))])
    return {value: (tuple(colour), MARKERS[k % len(MARKERS)]) for k, (value, colour) in enumerate(zip(ordered, colours))}
