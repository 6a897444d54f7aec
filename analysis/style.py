"""One look for all figures: colours and markers that tell methods apart without colour vision."""

import math
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # after the backend is chosen

# Okabe and Ito's palette, distinct under the common colour-vision deficiencies.
COLOUR = {"MD": "#0072B2", "CD": "#D55E00"}
SLIDING, CHAIN, GRAIN, RATTLER = "#D55E00", "#1A1A1A", "#B8B8B8", "#E6E6E6"

plt.rcParams.update({
    "figure.dpi": 100, "savefig.dpi": 160, "font.size": 9, "font.family": "DejaVu Sans",
    "axes.titlesize": 10, "axes.labelsize": 9, "axes.linewidth": 0.7, "axes.spines.top": False,
    "axes.spines.right": False, "lines.linewidth": 1.2, "lines.markersize": 6, "legend.frameon": False,
    "legend.fontsize": 8, "xtick.labelsize": 8, "ytick.labelsize": 8, "axes.formatter.useoffset": False,
})


def finish(fig, runs, path, note=""):
    """Put the caption under the figure (`note`, then what was run) and write it; makes the folder if need be."""
    origin = provenance(*runs)
    lines = [note, sample(runs[0]), "; ".join(method_settings(run) for run in runs), origin]
    fig.text(0.5, 0.012, "\n".join(line for line in lines if line), ha="center", va="bottom", fontsize=7.5,
             linespacing=1.4)
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    description = f"{', '.join(run.path.name for run in runs)}; {origin}"
    fig.savefig(path, metadata={"Description": description} if path.suffix == ".png" else None)
    plt.close(fig)


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
    text = ", ".join(sorted(short(commit) for commit in commits))
    note = " (DIFFERENT COMMITS)" if len(commits) > 1 else ""
    states = ", ".join(sorted({run.attributes["state_sha256"][:12] for run in runs}))
    return (f"prepared state {states}, commit {text}{note}, YADE {runs[0].attributes['yade_version']}, "
            f"one sample (seed {runs[0].attributes['seed']})")


def short(commit):
    """Twelve digits of a commit's hash, and what is appended to it."""
    digits, dash, suffix = commit.partition("-")
    return digits[:12] + dash + suffix


def sample(run):
    """The sample and its loading in one line."""
    row = run.parameters
    return (f"{row['disks']} disks, $\\mu$ = {row['friction']:g}, $P_0$ = {number(run.pressure)} Pa"
            f" = {number(row['pressure_ratio'])}$\\,k_n$, {row['loading']} loading, "
            f"$\\Delta\\sigma$ = {row['delta_sigma']:g}, $t_0$ = {row['period']:g} s")


def method_settings(run):
    """What matters of the method's own parameters, in one line."""
    row = run.parameters
    if run.method == "MD":
        return (f"MD: $k_n$ = {number(row['kn'])} N/m, $k_t/k_n$ = {row['kt_over_kn']:g}, damping ratio "
                f"{row['beta_n']:g}, walls by {row['md_walls']}")
    effort = (f"{row['fixed_iterations']} sweeps a step, no test" if row["fixed_iterations"]
              else f"tolerance {number(row['tolerance'])}, at most {row['max_iterations']} sweeps")
    return f"CD: {row['method_cd']}, {effort}, step $\\leq$ {number(row['cd_dt'])} s, walls by force"
