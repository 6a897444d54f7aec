"""The goals set for the solvers, and what the rows of a benchmark say to each: computed, never written by hand."""
import inspect
import math
import statistics

from cd_engine import core
from yade_scripts.benchmark.solutions import PEER, SOLVED, STOPPED

REFERENCE = "nsgs"
ACCELERATED = "accelerated"
UNKNOWN = "not measured"


def default_method():
    """The method that core.solve takes unless told otherwise."""
    return inspect.signature(core.solve).parameters["method"].default


def power(target):
    """1e-4 for 0.0001."""
    return f"1e{round(math.log10(target))}"


class Solutions:
    """The rows of solutions.py by problem, method and target."""

    def __init__(self, rows):
        self.rows = rows
        self.of = {(row["problem"], row["method"], row["target"]): row for row in rows}

    def problems(self, **wanted):
        return list(dict.fromkeys(row["problem"] for row in self.rows if all(row[name] == value for name, value in wanted.items())))

    def time(self, problem, method, target):
        """Seconds; infinity where unsolved, None where not measured."""
        row = self.of.get((problem, method, target))
        return None if row is None else row["seconds"] if row["status"] == SOLVED else math.inf

    def over_peer(self, problem, target):
        """Siconos's time over that of the default method: (factor, whether Siconos was stopped and the factor is a bound from below)."""
        ours, row = self.time(problem, default_method(), target), self.of.get((problem, PEER, target))
        if ours is None or row is None:
            return None
        if row["status"] == SOLVED:
            return row["seconds"] / ours, False
        if not row["status"].startswith(STOPPED):
            return None
        return float(row["status"].split()[2]) / ours, True

    def sweeps_saved(self, problem, target):
        """Sweeps of plain Gauss-Seidel over those with momentum, Newton's steps being none; where plain ones did not arrive, those made in vain."""
        plain, ours = (self.of.get((problem, method, target)) for method in (REFERENCE, ACCELERATED))
        if plain is None or ours is None:
            return None
        return plain["sweeps"] / max(1, ours["sweeps"]) if ours["status"] == SOLVED else 0.0


def table(solutions, sweeps, engine):
    """[{goal, asked, measured, met}]; met: yes, no or not measured."""
    found = Solutions(solutions)
    return _of_sweeps(sweeps) + _beside_siconos(found) + _warm(found) + _saved(found) + _worst(found) + _of_engine(engine)


def _row(goal, asked, value, met, text=None):
    if value is None:
        return {"goal": goal, "asked": asked, "measured": UNKNOWN, "met": UNKNOWN}
    return {"goal": goal, "asked": asked, "measured": text or f"{value:.3g}", "met": "yes" if met else "no"}


def _of_sweeps(rows):
    in_cache = next((row for row in rows if row["problem"] == "packing of 4000"), None)
    largest = max((row for row in rows if row["contacts"] > 1e6), key=lambda row: row["contacts"], default=None)

    def goal(text, row, key, most):
        value = row.get(key) if row else None
        return _row(text, f"<= {most} ns a contact", value, value is not None and value <= most)

    return [goal("plain sweep in cache, AVX-512", in_cache, "plain_avx512_ns", 2.5), goal("plain sweep in cache, AVX2", in_cache, "plain_avx2_ns", 4),
            goal("accelerated sweep in cache, AVX-512", in_cache, "accelerated_ns", 4),
            goal("plain sweep at 1.5 million contacts", largest, "plain_avx512_ns", 4.5)]


def _factor(found, problems, target):
    """Median over problems of the factor to Siconos, as text with a sign where some are bounds from below."""
    factors = [factor for problem in problems if (factor := found.over_peer(problem, target))]
    if not factors:
        return None, ""
    value = statistics.median(factor for factor, _ in factors)
    unsolved = sum(factor == 0 for factor, _ in factors)
    return value, f"{'>= ' if value and any(bound for _, bound in factors) else ''}{value:.3g}x (median of {len(factors)}, {unsolved} unsolved)"


def _beside_siconos(found):
    rows = []
    for problem in found.problems(kind="file"):
        value, text = _factor(found, [problem], 1e-8)
        rows.append(_row(f"{problem} by its matrix to 1e-8, beside Siconos", ">= 250x for the largest granular ones", value,
                         value and value >= 250, text))
    if not rows:
        rows.append(_row("granular problems by their matrix to 1e-8, beside Siconos", ">= 250x for the largest granular ones", None, False))
    for mu, target, least in ((0.1, 1e-4, 250), (0.5, 1e-4, 130), (0.1, 1e-6, 450), (0.5, 1e-6, 350)):
        value, text = _factor(found, found.problems(kind="packing", disks=4000, mu=mu, start="cold"), target)
        rows.append(_row(f"packing of 4000, mu {mu:g}, cold to {power(target)}, beside Siconos", f">= {least}x", value,
                         value and value >= least, text))
    return rows


def _warm(found):
    rows = []
    for mu, most in ((0.1, 0.03), (0.5, 0.25)):
        problem = next(iter(found.problems(kind="packing", disks=40000, mu=mu, start="warm")), None)
        value, further = (found.time(problem, default_method(), target) for target in (1e-4, 1e-6))
        text = None
        if value is not None:
            row = found.of[problem, default_method(), 1e-4]
            # How little is asked of a step shows in its first guess.
            text = f"{value:.3g} s, {row['sweeps']:.0f} sweeps (begins at {row['residual_at_start']:.2g}; to 1e-6: {further or math.nan:.3g} s)"
        rows.append(_row(f"warm step of 40000, mu {mu:g}, to 1e-4", f"<= {most} s", value, value is not None and value <= most, text))
    return rows


def _saved(found):
    rows = []
    for target, least in ((1e-4, 6), (1e-6, 12), (1e-8, 25)):
        factors = [saved for problem in found.problems(kind="packing", start="cold")
                   if (saved := found.sweeps_saved(problem, target)) is not None]
        value = statistics.median(factors) if factors else None
        rows.append(_row(f"sweeps saved against plain ones, packings, to {power(target)}", f">= {least}x", value,
                         value is not None and value >= least,
                         value is not None and f"{value:.3g}x (median of {len(factors)}, {sum(f == 0 for f in factors)} unsolved)"))
    return rows


def _worst(found):
    """The largest time over that of plain sweeps, over all targets that plain sweeps reach."""
    worst, where = None, ""
    for problem in [p for kind in ("crystal", "masses", "pile") for p in found.problems(kind=kind)]:
        for target in sorted({row["target"] for row in found.rows if row["problem"] == problem}):
            plain, ours = (found.time(problem, method, target) for method in (REFERENCE, default_method()))
            if plain is None or ours is None or not 0 < plain < math.inf:
                continue
            if worst is None or ours / plain > worst:
                worst, where = ours / plain, f"{problem} to {power(target)}"
    return [_row("worst case beside plain sweeps", "<= 1.1x the time", worst, worst is not None and worst <= 1.1,
                 worst and f"{worst:.3g}x ({where})")]


def _of_engine(rows):
    found = []
    if not any(row["disks"] >= 4000 and row["tolerance"] <= 1e-8 for row in rows):
        found.append(_row("quasi-static steps to 1e-8", ">= 95 % within 10000 sweeps", None, False))
    if not any(row["disks"] >= 40000 and row["tolerance"] > 1e-8 for row in rows):
        found.append(_row("whole step in YADE, 40000 disks", "< 1.3x the bare solution", None, False))
    for row in rows:
        if row["disks"] >= 4000 and row["tolerance"] <= 1e-8:
            share = row["steps_solved"] / row["steps"]
            found.append(_row(f"quasi-static steps to 1e-8, {row['packing']}", f">= 95 % within {row['most_sweeps']} sweeps", share, share >= 0.95,
                              f"{100 * share:.3g} % of {row['steps']} (median {row['median_sweeps']:.0f} sweeps)"))
        elif row["disks"] >= 40000:
            value = row["step_over_solver"]
            found.append(_row(f"whole step in YADE to {power(row['tolerance'])}, {row['packing']}", "< 1.3x the bare solution", value, value < 1.3,
                              f"{value:.3g}x (median {row['median_sweeps']:.0f} sweeps; {row['outside_ns_per_contact']:.0f} ns a contact outside the solver)"))
            found.append(_row(f"memory to {power(row['tolerance'])}, {row['packing']}", "stated", 1.0, True,
                              f"{row['bytes_a_disk_in_yade']:.0f} bytes a disk in YADE, "
                              f"{row['bytes_a_contact_of_engine']:.0f} a contact of the engine"))
    return found
