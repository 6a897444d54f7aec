"""The table of the first page: how much each cause parts springs (MD) from rigid contacts (CD), computed from the published tables."""

import numpy as np
import pandas

from analysis import publish
from analysis.studies import collapse, fig3, ratcheting
from yade_scripts.results.reader import ResultError

PROCESSES = ("One cycle", "Strain a cycle (ratcheting)", "Collapse")
NOT_RUN = "not run yet"
REFUSED_COUNT = ("collapse", "fig3")  # studies in which a run that only the check of the walls refuses has stood


def table(folder):
    """Return {cause: one text for each of PROCESSES} from the tables of the studies in `folder`; a text says so whose runs are missing."""
    def text(name, cell):
        path = folder / f"{name}.csv"
        if cell is None:
            return NOT_RUN if name else "not varied"
        try:
            table = publish.read_table(path) if path.is_file() else None
            found = NOT_RUN if table is None else cell(table if name in REFUSED_COUNT else publish.finished(table))
        except (AttributeError, KeyError, StopIteration) as error:  # the first two: pandas' two ways to miss a column
            if isinstance(error, AttributeError) and not isinstance(error.obj, pandas.DataFrame):
                raise
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


def _range(values, method):
    low, middle, high = np.quantile(values, (0.25, 0.5, 0.75))
    return f"{middle:.0e} in {method} (quartiles {low:.0e} and {high:.0e})"


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
    rigid, name = rows[rows.effort == "tolerance"].sort_values("value"), "largest, packing 1"
    first, last = rigid.iloc[0], rigid.iloc[-1]
    return (f"CD's strain is its solver's error: on one packing {last[name]:.1e} at a tolerance of {last.value:.0e}, "
            f"{first[name]:.1e} at {first.value:.0e}")


def _limit_of_a_cycle(rows):
    rows = rows[rows["stress path"] == "mean"]
    springs, rigid = (rows[rows.method == method].set_index("seed") for method in ("MD", "CD"))
    carried = rigid["static limit"] > 1.2
    rests = rigid["largest |gamma|"] < 1e-5  # at a tolerance of 1e-7
    ratio = (springs["largest |gamma|"] / rigid["largest |gamma|"])[~carried]
    return (f"with the mean stress held, sigma2/sigma1 up to 1.5: CD rests on {(rests & carried).sum()} of {carried.sum()} packings that carry it (|gamma| of "
            f"{rigid[carried]['largest |gamma|'].max():.1e} at most, the error of its solver) and strains by {rigid[~carried]['largest |gamma|'].min():.1e} to "
            f"{rigid[~carried]['largest |gamma|'].max():.1e} on {(~rests & ~carried).sum()} of {(~carried).sum()} that do not; there springs of k_n, whose walls "
            f"have a servo, strain {_spread(ratio)} as far")


def _network_of_a_cycle(rows):
    rigid = rows[rows.method == "CD"]
    several = rigid[rigid.groupby(["preparation mu", "seed"]).network.transform("count") > 1]
    most = several.groupby(["preparation mu", "seed"])["load at 0.0001"]
    return (f"CD yields at loads that differ by at most {100 * (most.max() / most.min() - 1).max():.1g} % between {most.size().sum()} networks of "
            f"{len(most)} packings, and rests below")


def _law_of_a_cycle(rows):
    own = rows[(rows.law == "path_independent") & (rows.asked == 40)]
    return f"MD under the path-independent law: {_spread(own['first cycle over standard'])} its strain of the first cycle"


def _limit_of_a_rate(rows):
    name = next(column for column in rows if column.startswith("rate of cycles"))
    springs, rigid = (rows[rows.method == method].set_index(["preparation friction", "stress path", "dSigma", "seed"]) for method in ("MD", "CD"))
    texts = []
    for words, mask in (("below", springs["load over limit"] < 1), ("above", springs["load over limit"] >= 1)):
        pairs = springs[mask][[name]].join(rigid[[name]], lsuffix=" MD", rsuffix=" CD", how="inner").dropna().abs()
        texts.append(f"{words} it " + " and ".join(_range(pairs[f"{name} {method}"], method) for method in ("MD", "CD"))
                     + f" ({len(pairs)} pairs from {len(pairs.groupby(level=['preparation friction', 'seed']))} packings)" if len(pairs) else NOT_RUN)
    return "of packings that stand " + ", ".join(texts)


def _stiffness_of_a_rate(rows):
    springs = ratcheting.slow(rows)
    far = springs["load over limit"] < ratcheting.NEAR
    texts, several = [], ratcheting.several(springs[far])
    for words, own in ((f"up to {ratcheting.NEAR} of the limit", springs[far]), ("above", springs[~far])):
        power, error = ratcheting.power(own, "rate")
        texts.append(f"{power:.2f} (standard error {error:.2f}; {len(own)} runs from {own.seed.nunique()} seeds) {words}")
    if len(several):
        power, error = ratcheting.power(several, "rate", within=True)
        texts[0] += f", {power:.2f} ({error:.2f}) within the {several.seed.nunique()} seeds that have several stiffnesses there"
    return "below the limit, at equal load over it, MD's strain of a late cycle goes as k_n to the power " + " and ".join(texts)


def _tolerance_of_a_rate(rows):
    rows = rows[(rows["load over limit"] < 1) & (rows["k_n over the usual"] == 1) & rows.tolerance.isin((ratcheting.RIGID["tolerance"], ratcheting.LOOSER))]
    rates = rows.groupby("tolerance")["rate"].median().sort_index(ascending=False)
    return (f"below the limit CD's strain of a late cycle is its solver's error in the median of {rows.seed.nunique()} packings: "
            + ", ".join(f"{rate:.0e} at a tolerance of {tolerance:.0e}" for tolerance, rate in rates.items())
            + f"; {(rows[rows.tolerance < ratcheting.LOOSER].rate > 1e-7).sum()} of them yields")


def _law_of_a_rate(rows):
    texts = [f"{_spread(own['late rate over standard'])} the late rate under dSigma = {load}"
             for load, own in rows[(rows.law == "path_independent") & (rows.asked == 40)].groupby("dSigma")]
    return "MD under the path-independent law: " + " and ".join(texts)


def _same_ratio(rows, name):
    """Return `name` of dense packings of MD with the mean stress held at 0.2 over that with sigma1 held at 0.5: sigma2/sigma1 goes to 1.5 in both."""
    springs = rows[(rows.method == "MD") & (rows["preparation friction"] == 0)]
    return _spread(_over(springs, name, (springs["stress path"] == "mean") & (springs.dSigma == 0.2), (springs["stress path"] == "constant") & (springs.dSigma == 0.5)))


def _path_of_a_cycle(rows):
    return "at equal sigma2/sigma1 (1.5) MD strains with the mean stress held " + _same_ratio(rows, "first cycle") + " as far in the first cycle as with sigma1 held"


def _path_of_a_rate(rows):
    name = next(column for column in rows if column.startswith("gamma after"))
    return f"at equal sigma2/sigma1 (1.5) MD's {name} cycles with the mean stress held is {_same_ratio(rows, name)} that with sigma1 held"


def _lives(rows, case, base):
    """Return the spread of the quotients, under each load."""
    return " and ".join(f"{_spread(times)} under dSigma = {load:g}" for load, times in collapse.times(rows, case, base).groupby(level="dSigma")) or NOT_RUN


def _stiffness_of_collapse(rows):
    return (f"cycles that CD stands, over those of springs of k_n: {_lives(rows, 'rigid', 'springs')}; over those of springs of 10 k_n: "
            f"{_lives(rows, 'rigid, packing of 10 k_n', 'springs, 10 k_n')} (cycles of 0.5 s)")


def _limit_of_collapse(rows):
    rows = fig3.standing(rows)
    texts = [f"{method} collapses above {own[own['collapses after'].notna()]['load over limit'].min():.2f} of its limit and stands up to {own[own['collapses after'].isna()]['load over limit'].max():.2f}"
             for method, own in rows.groupby("method")]
    return "sigma2/sigma1 over that of the static limit: " + ", ".join(texts)


def _path_of_collapse(rows):
    springs = rows[(rows.method == "MD") & (rows["preparation friction"] == 0)]
    texts = [f"{own['collapses after'].notna().sum()} of {len(own)} with {held} held (sigma2/sigma1 = {ratio})"
             for path, load, held, ratio in (("mean", 0.3, "the mean stress", 1.86), ("constant", 0.8, "sigma1", 1.8), ("constant", 0.3, "sigma1", 1.3))
             for own in [springs[(springs["stress path"] == path) & (springs.dSigma == load)]] if len(own)]
    return "MD collapses in " + (", ".join(texts) or NOT_RUN)


def _life(words, case, base):
    return "collapse", lambda rows: f"cycles until collapse, {words}: {_lives(rows, case, base)}"


CELLS = {
    "Stiffness of the springs": (("stiffness", _stiffness_of_a_cycle), ("ratcheting", _stiffness_of_a_rate), ("collapse", _stiffness_of_collapse)),
    "Tolerance of the solver": (("tolerance", _tolerance_of_a_cycle), ("ratcheting", _tolerance_of_a_rate),
                                _life("CD at 1e-6 instead of 1e-8", "rigid, tolerance 1e-6", "rigid")),
    "Indeterminacy: from which forces it starts": (("critical_load", _network_of_a_cycle), ("", None), _life("CD from another force network", "rigid, other forces", "rigid")),
    "Indeterminacy: what the forces can carry": (("fig4", _limit_of_a_cycle), ("fig3", _limit_of_a_rate), ("fig3", _limit_of_collapse)),
    "Tangential law": (("laws", _law_of_a_cycle), ("laws", _law_of_a_rate), _life("MD under the path-independent law", "springs, path-independent law", "springs")),
    "Stress path": (("fig3", _path_of_a_cycle), ("fig3", _path_of_a_rate), ("fig3", _path_of_collapse))}
