"""The table of the first page: how much each cause parts springs (MD) from rigid contacts (CD), computed from the published tables."""

import numpy as np

from analysis import publish
from analysis.studies import collapse, ratcheting
from yade_scripts.results.reader import ResultError

PROCESSES = ("One cycle of 0.2 P0", "Strain a cycle (ratcheting)", "Collapse with the mean stress held")
NOT_RUN = "not run yet"


def table(folder):
    """Return {cause: one text for each of PROCESSES} from the tables of the studies in `folder`; a text says so whose runs are missing."""
    def text(name, cell):
        path = folder / f"{name}.csv"
        try:
            found = cell(publish.read_table(path)) if path.is_file() else NOT_RUN
        except (AttributeError, KeyError) as error:  # pandas' two ways to miss a column
            raise ResultError(path, f"is of another version of the study ({error})", f"make it again: make study STUDY={name}") from None
        return NOT_RUN if NOT_RUN in found else found

    return {cause: [text(*cell) for cell in cells] for cause, cells in CELLS.items()}


def _spread(values):
    """Return 'median (quartiles, number of cases)' of the values that are numbers. Infinite ones: it never ended."""
    values = np.array(values, float)
    values = np.minimum(values[~np.isnan(values)], 1e9)  # a quantile between two infinite ones is not defined
    if not len(values):
        return NOT_RUN
    low, middle, high = (f"{value:.2f}" if value < 1e6 else "more than was run" for value in np.quantile(values, (0.25, 0.5, 0.75)))
    return f"{middle} times (quartiles {low} and {high}; {len(values)} cases)"


def _over(rows, column, upper, lower):
    """Return column where upper, a mask of the rows, over column where lower, seed by seed."""
    one, other = (rows[mask].set_index("seed")[column] for mask in (upper, lower))
    return (one / other).abs()


def _stiffness_of_a_cycle(rows):
    springs = rows[(rows.medium == "MD") & rows.comparison.isna()].set_index("springs_over_kn").sort_index()
    power = np.polyfit(np.log(springs.index.astype(float)), np.log(springs.largest), 1)[0]
    first, last = springs.iloc[0], springs.iloc[-1]
    return (f"MD's largest strain goes as k_n to the power {power:.2f}: {first.largest:.1e} ({first.largest_low:.1e} to {first.largest_high:.1e}, {first.packings} packings) "
            f"with k_n, {last.largest:.1e} with {last.name:g} k_n")


def _tolerance_of_a_cycle(rows):
    rigid = rows[rows.effort == "tolerance"].sort_values("value")
    return f"CD's strain is its solver's error: {rigid.largest.iloc[-1]:.1e} at a tolerance of {rigid.value.iloc[-1]:.0e}, {rigid.largest.iloc[0]:.1e} at {rigid.value.iloc[0]:.0e}"


def _freedom_of_a_cycle(rows):
    load = rows.dSigma + 1
    carried = rows[rows["static limit"] > load]
    beyond = rows[(rows["static limit"] < load) & (rows["largest |gamma|, CD"] > 1e-7)]
    ratio = beyond["largest |gamma|, CD"] / beyond["largest |gamma|, MD"]
    return (f"decides whether rigid grains move: CD rests on {(carried['largest |gamma|, CD'] < 1e-7).sum()} of {len(carried)} packings that carry the load, and strains "
            f"{_spread(ratio)} as far as MD on those that do not")


def _law_of_a_cycle(rows):
    own = rows[(rows.law == "path_independent") & (rows.asked == 40)]
    return f"MD under the path-independent law: {_spread(own['first cycle over standard'])} its strain of the first cycle"


def _path_of_a_cycle(rows):
    springs = rows[rows.method == "MD"]
    return "MD with the mean stress held: " + _spread(_over(springs, "largest |gamma|", springs["stress path"] == "mean", springs["stress path"] == "constant")) + " its largest strain"


def _stiffness_of_a_rate(rows):
    powers = ratcheting.exponents(rows, "rate", 0.5)
    if not len(powers):
        return NOT_RUN
    low, middle, high = np.quantile(powers, (0, 0.5, 1))
    return f"MD's rate under 0.5 P0 goes as k_n to the power {middle:.2f} ({low:.2f} to {high:.2f}, {len(powers)} packings)"


def _tolerance_of_a_rate(rows):
    same = rows[(rows.dSigma == 0.3) & (rows.stiffening == 1)]
    springs = same[same.method == "MD"].set_index("seed").rate.abs()
    shares = [f"{(part.set_index('seed').rate.abs() / springs).median():.0e} at {float(tolerance):.0e}"
              for tolerance, part in sorted(same[same.method == "CD"].groupby("tolerance"), reverse=True)]
    return "CD's rate under 0.3 P0 over MD's, by tolerance: " + (", ".join(shares) or NOT_RUN)


def _freedom_of_a_rate(rows):
    dense = rows[(rows["preparation friction"] == 0) & (rows["load over limit"] < 1)]
    name = next(column for column in rows if column.startswith("rate of cycles"))
    springs, rigid = (dense[dense.method == method][name].abs() for method in ("MD", "CD"))
    if not (springs.count() and rigid.count()):
        return NOT_RUN
    return f"below the static limit CD strains by {rigid.median():.0e} a cycle, MD by {springs.median():.0e} (medians of {rigid.count()} and {springs.count()} runs)"


def _law_of_a_rate(rows):
    own = rows[(rows.law == "path_independent") & (rows.asked == 40)]
    return f"MD under the path-independent law: {_spread(own['late rate over standard'])} the late rate"


def _path_of_a_rate(rows):
    name = next(column for column in rows if column.startswith("rate of cycles"))
    springs = rows[(rows.method == "MD") & (rows["preparation friction"] == 0) & (rows.dSigma == 0.2)]
    return "MD with the mean stress held, 0.2 P0: " + _spread(_over(springs, name, springs["stress path"] == "mean", springs["stress path"] == "constant")) + " the rate"


def _lives(rows, case, base):
    return _spread(collapse.times(rows, case, base))


def _stiffness_of_collapse(rows):
    return (f"CD stands {_lives(rows, 'rigid', 'springs')} as many cycles as springs of k_n, "
            f"{_lives(rows, 'rigid, packing of 10 k_n', 'springs, 10 k_n')} as many as springs of 10 k_n")


def _path_of_collapse(rows):
    springs = rows[(rows.method == "MD") & (rows["preparation friction"] == 0) & rows.dSigma.between(0.3, 0.5)]
    counts = {path: f"{own['collapses after'].notna().sum()} of {len(own)}" for path, own in springs.groupby("stress path")}
    return f"under 0.3 to 0.5 P0 {counts.get('mean', '0')} runs of MD collapse with the mean stress held, {counts.get('constant', '0')} with sigma1 held"


def _life(words, case, base):
    return "collapse", lambda rows: f"{words}: {_lives(rows, case, base)} as many cycles"


CELLS = {
    "Stiffness of the springs": (("stiffness", _stiffness_of_a_cycle), ("ratcheting", _stiffness_of_a_rate), ("collapse", _stiffness_of_collapse)),
    "Tolerance of the solver": (("tolerance", _tolerance_of_a_cycle), ("ratcheting", _tolerance_of_a_rate),
                                _life("CD at 1e-6 instead of 1e-8", "rigid, tolerance 1e-6", "rigid")),
    "Freedom of the forces": (("isostatic", _freedom_of_a_cycle), ("fig3", _freedom_of_a_rate), _life("CD from another force network", "rigid, other forces", "rigid")),
    "Tangential law": (("laws", _law_of_a_cycle), ("laws", _law_of_a_rate), _life("MD under the path-independent law", "springs, path-independent law", "springs")),
    "Stress path": (("fig4", _path_of_a_cycle), ("fig3", _path_of_a_rate), ("fig3", _path_of_collapse))}
