"""The studies: each is one file in this folder. A study has

    TITLE, QUESTION    heading, which is the question in short, and what was compared
    ROWS               {"quick": rows, "full": rows}: lists of dictionaries of parameters (yade_scripts.tables.product makes them)
    summarize(runs)    returns the rows of the summary table, a list of {heading: number or text}
    draw(runs, rows, path)     draws the figure and writes it to path, by style.finish

and, before it is published,

    ORDER              its place in the report, by default 100
    PART               "page", the default; "appendix": at its end; "engine": in cd_engine/FLOWS.md instead
    ANSWER             the findings of the published run in plain words, the conclusion first: a template (analysis/texts.py), by default the file
                       NAME.md.j2 beside it. The report typesets P0, gamma, mu and 1e-3
    quantities(table)  returns {name: value} of what the template needs beside `table`, the published summary table (pandas)
    POINTS             statements of the paper: (place, quotation, where, verdict); the template has a macro point_PLACE with what was measured

`runs` are the finished runs of ROWS in their order, also those in which the sample collapsed. A study does not see rows that failed or were not run;
`collect` returns them separately, with the reasons.
"""
import functools
from dataclasses import dataclass, field
from pathlib import Path

from yade_scripts import declared, parameters, results
from yade_scripts.results import reader

NOT_RUN = "not run yet"


@dataclass
class Collection:
    """The runs of a study. runs: those that have finished. missing: (result file, full row, reason) of all other rows."""
    name: str
    full: bool
    runs: list = field(default_factory=list)
    missing: list = field(default_factory=list)


def names(broken=None):
    """Return the names of all studies, in the order of the report. broken: as of declared.readable."""
    return sorted(declared.readable(declared.names(__name__), module, broken), key=lambda name: (module(name).ORDER, name))


@functools.cache
def module(name):
    """Return the module of a study, with defaults for what it does not declare. Raise ParameterError if there is none or if it lacks something, and
    ImportError for any other fault of its file."""
    if name not in declared.names(__name__):
        raise parameters.ParameterError(f"there is no study {name!r}; there are {', '.join(names())}")
    text = Path(__file__).with_name(f"{name}.md.j2")
    found = declared.load(__name__, name, ("TITLE", "QUESTION", "ROWS", "summarize", "draw"),
                          {"ORDER": 100, "PART": "page", "ANSWER": text.read_text(encoding="utf-8") if text.is_file() else "", "POINTS": (),
                           "quantities": lambda table: {}})
    with declared.located(found.__file__):
        extents = {f"ROWS[{extent!r}]": rows or None for extent, rows in found.ROWS.items()}
        declared.demand(__name__, found, extents, ("ROWS['quick']", "ROWS['full']"))
        for name, own in extents.items():
            if not isinstance(own, list):
                raise TypeError(f"{name} is a {type(own).__name__}; it must be a list of rows, which are dictionaries")
    return found


def rows(name, full):
    """Return the rows of a study, full rows, each once. Raise ImportError, with the file, if one cannot be run."""
    found, file = {}, module(name)
    with declared.located(file.__file__, parameters.ParameterError):
        for row in file.ROWS["full" if full else "quick"]:
            row = parameters.complete(row)
            found.setdefault(parameters.result_name(row), row)
    return list(found.values())


def collect(name, folder=reader.RESULTS, full=False):
    """Return the Collection of a study from the result files in `folder`."""
    found = Collection(name, full)
    for row in rows(name, full):
        path = results.path_of(row, folder)
        try:
            run = reader.load_row(row, folder)
            reason = "" if run.finished else str(run.attributes["status"])
        except reader.ResultError as error:
            partial = path.with_suffix(reader.PARTIAL_SUFFIX)
            reason = error.what if path.exists() else "under way or interrupted" if partial.exists() else NOT_RUN
        if reason:
            found.missing.append((path, row, reason))
        else:
            found.runs.append(run)
    return found
