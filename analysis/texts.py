"""Renders the texts about the published run: Jinja2 templates whose numbers are expressions of the published tables.

In a template stand {{ expression | filter }}: a whole number as it is, any other by `fixed`, `percent` or `sci`. The expressions use the published
table as `table`, and what `quantities(table)` of the study returns. Those of any study, or of charts/<chart>, are published("fig4"), as README's
templates and the table of causes need them.
"""
import contextlib
import functools
import re
import textwrap
from pathlib import Path

import jinja2
import pandas

from analysis import charts, publish, studies
from yade_scripts.measuring import maps
from yade_scripts.results import sealed
from yade_scripts.errors import ResultError

FOLDER = Path(__file__).parent
PUBLISHED = FOLDER / "published"
README = FOLDER.parent / "README.md"
ENGINE = FOLDER.parent / "cd_engine" / "FLOWS.md"


def _each(written):
    """Let a filter of one number accept the two ends of a range, too."""
    @functools.wraps(written)
    def filtered(value, *digits):
        return " to ".join(written(float(one), *digits) for one in (value if isinstance(value, tuple) else (value,)))
    return filtered


@_each
def fixed(value, decimals=0):
    return f"{value:.{decimals}f}"


@_each
def percent(value, decimals=0):
    """Return 100 times the value; the sign stands in the text."""
    return f"{100 * value:.{decimals}f}"


@_each
def sci(value, digits=2):
    """Return a number as 4.3e-4."""
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def ends(values):
    """Return the smallest and the largest value; runs without one do not count."""
    return pandas.Series(values).min(), pandas.Series(values).max()


def _whole(value):
    if isinstance(value, float):
        raise TypeError(f"{value} needs a filter: fixed, percent or sci")
    return value


ENVIRONMENT = jinja2.Environment(loader=jinja2.FileSystemLoader(FOLDER), undefined=jinja2.StrictUndefined, finalize=_whole, trim_blocks=True)
ENVIRONMENT.filters |= {"fixed": fixed, "percent": percent, "sci": sci, "range": ends}


@functools.cache
def quantities(name):
    """Return {name: value} for the text of a study, or of charts/<chart>; nothing where no table is published."""
    folder, _, own = name.rpartition("/")
    if not (file := PUBLISHED / f"{name}.csv").is_file():
        return {}
    table = publish.read_table(file)
    if folder:
        return {"table": table} | charts.module(own).quantities(table)
    table = publish.finished(table)
    return {"table": table} | studies.module(name).quantities(table)


ENVIRONMENT.globals["published"] = quantities


@contextlib.contextmanager
def _named(name):
    """Turn any error into a ResultError with this name: no text may cost the page the others."""
    try:
        yield
    except Exception as error:
        raise ResultError(name, f"its text cannot be written ({type(error).__name__}: {error})", "correct it, or its table") from None


@functools.cache
def _text(name):
    """Return the template of a study, or of charts/<chart>, as a module: its text and its macros."""
    folder, _, own = name.rpartition("/")
    return ENVIRONMENT.from_string((charts if folder else studies).module(own).ANSWER).make_module(quantities(name))


def answer(name):
    """Return the findings of a study, or of charts/<chart>."""
    with _named(name):
        return str(_text(name)).strip()


def points(name):
    """Return the statements of the paper that a study speaks of, with what was measured."""
    with _named(name):
        return [(*point, getattr(_text(name), f"point_{point[0]}")().strip()) for point in studies.module(name).POINTS]


def remedy(name):
    """Return what can be done about the failures that a map shows; its template has the cells of the published map."""
    file = PUBLISHED / charts.FOLDER / f"map_{name}.csv"
    with _named(name):
        return ENVIRONMENT.from_string(maps.get(name).remedy).render({"cells": publish.read_table(file)} if file.is_file() else {})


def causes():
    """Return the table of causes, as stored, since a fault in one study must not cost it all: (what it is about, [headings of the columns],
    {cause: [cells]})."""
    note, *lines = (PUBLISHED / "findings.md").read_text(encoding="utf-8").strip().split("\n# Causes\n\n")[1].split("\n|")
    (_, *headings), _, *rows = ([cell.strip() for cell in line.strip("|").split("|")] for line in lines)
    return " ".join(note.split()), headings, {cause: cells for cause, *cells in rows}


def findings():
    """Return what README's findings say, as stored: the definitions before them, and [(text, [(words, study whose figure they link to)])]."""
    stored = README.read_text(encoding="utf-8").split("<!-- findings: begin -->")[1].split("<!-- findings: end -->")[0]
    words, items = (" ".join(part.split()) for part in stored.split("\n\n"))
    link = r"\[([^]]+)\]\(\S+?(\w+)\.png\)"
    return words, [(re.sub(rf" {link}", "", item), re.findall(link, item)) for item in re.split(r"(?:^| )- (?=\*\*)", items)[1:]]


def committed():
    """Return {file: text} of the texts that are stored: all findings of the page, those on the engine, and README with its findings and advice
    between marks."""
    found = [(name, studies.module(name), answer(name), points(name)) for name in studies.names() if answer(name)]
    engine = ENVIRONMENT.get_template("engine.md.j2").render(studies=[one for one in found if one[1].PART == "engine"])
    every = ENVIRONMENT.get_template("findings.md.j2").render(
        studies=[one for one in found if one[1].PART != "engine"],
        charts=[(charts.module(name), answer(f"{charts.FOLDER}/{name}")) for name in charts.ORDER],
        maps=[(maps.get(name).title, remedy(name)) for name in maps.names()])
    readme = re.sub(r"(<!-- (\w+): begin -->\n).*?(?=<!-- \2: end -->)",
                    lambda found: found[1] + wrap(ENVIRONMENT.get_template(f"readme_{found[2]}.md.j2").render()) + "\n",
                    README.read_text(encoding="utf-8"), flags=re.S)
    return {PUBLISHED / "findings.md": wrap(every) + "\n", ENGINE: wrap(engine) + "\n", README: readme}


def wrap(text):
    """Return Markdown in lines of at most 150 columns; rows of tables stay as they are."""
    fill = lambda found: textwrap.fill(" ".join(found[0].split()), 150, subsequent_indent="  " * bool(found[1]), break_long_words=False,
                                       break_on_hyphens=False)
    return re.sub(r"^(- )?(?!\| ).+(?:\n(?!- |\| )(?!\s*$).+)*", fill, text.strip(), flags=re.M)


def write():
    """Write the stored texts anew. Return their files."""
    for file, text in (found := committed()).items():
        sealed.replace(file, text.encode())
    return list(found)
