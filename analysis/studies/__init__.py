"""The studies: what is asked, by which tables it is answered, and which runs of them are there.

A study is a module of this package with

    TITLE, QUESTION    heading and one or two sentences: what is asked, of which paper or figure
    TABLES             {"quick": (file, ...), "full": (file, ...)}, below yade_scripts/tables/
    summarize(runs)    the rows of its summary table, a list of {heading: number or text}
    draw(runs, rows, path)     its figure
    answer(rows)       the answer in plain sentences, every number taken from the rows

`runs` are the finished runs of the tables (analysis.load.Run) in their order; a sample that collapsed has finished too.
Rows that failed or were not run are no matter of a study: `collect` keeps them, with their reasons.
"""

import importlib
import importlib.util
from dataclasses import dataclass, field
from pathlib import Path

from analysis import load
from yade_scripts import parameters, results, tables

# Of the report: the paper's figures, then the questions it leaves open.
ORDER = ("fig4", "fig3", "fig5", "influence", "tolerance", "chain", "stiffness", "closed_path", "laws", "indeterminacy",
         "critical_load")
TABLES = Path(tables.__file__).resolve().parent
NOT_RUN = "not run yet"


@dataclass
class Collection:
    """A study's runs: those that finished, and the rows that have none.

    missing: [(result file, full row, reason)] of the rows that failed, are unfinished or were not run.
    """

    name: str
    full: bool
    tables: tuple
    runs: list = field(default_factory=list)
    missing: list = field(default_factory=list)

    @property
    def module(self):
        """The study's module."""
        return module(self.name)

    @property
    def extent(self):
        """'full' or 'quick'."""
        return "full" if self.full else "quick"

    @property
    def commits(self):
        """Commits that made the runs, sorted."""
        return sorted({run.attributes["git_commit"] for run in self.runs})


def names():
    """The studies there are, in the order of the report."""
    return [name for name in ORDER if importlib.util.find_spec(f"{__name__}.{name}")]


def module(name):
    """The module of a study; ResultError for a name that is none."""
    if name not in names():
        raise load.ResultError(name, "no such study", f"there are {', '.join(names())}")
    return importlib.import_module(f"{__name__}.{name}")


def collect(name, folder=load.RESULTS, full=False):
    """The Collection of a study from the result files in `folder`, each row once though several tables name it."""
    found = Collection(name, full, tuple(module(name).TABLES["full" if full else "quick"]))
    for path, row in _rows(found.tables, folder).items():
        run, reason = _run(path)
        if run:
            found.runs.append(run)
        else:
            found.missing.append((path, row, reason))
    return found


def _rows(names_of_tables, folder):
    """{result file: full row} in the order of the tables."""
    rows = {}
    for name in names_of_tables:
        table = TABLES / name
        try:
            completed = [parameters.complete(row) for row in tables.read(table).values()]
        except (tables.TableError, parameters.ParameterError) as error:
            raise load.ResultError(table, str(error), "mend the table") from None
        rows |= {results.path_of(row, folder): row for row in completed}
    return rows


def _run(path):
    """(run, '') or (None, why there is none)."""
    if not path.is_file():
        partial = path.with_suffix("").with_name(path.stem + load.PARTIAL_SUFFIX)
        return None, "under way or interrupted" if partial.is_file() else NOT_RUN
    try:
        run = load.load(path, finished=False)
    except load.ResultError as error:
        return None, error.what
    return (run, "") if run.finished else (None, str(run.attributes["status"]))
