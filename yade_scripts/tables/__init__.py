"""Tables of runs, as products of values or from files in the format of yade-batch: a line of names, then one line for each run. Needs no YADE.

Words are separated by blanks. `#` starts a comment. `=` repeats the value above. `-` stands for the default, also where
the row's scene has no such parameter. The columns `description` and `!NAME` (environment variables) are for yade-batch only.
"""
import itertools
import os
import pathlib

from yade_scripts import parameters
from yade_scripts.errors import ParameterError


NO_VALUE = "-"


class TableError(ParameterError):
    """A table cannot be read; the message names file and line."""


def product(**values):
    """Return the rows of all combinations; the last name varies fastest, and a single value is the same in all rows."""
    several = {name: value if isinstance(value, (list, tuple, range)) else (value,) for name, value in values.items()}
    return [dict(zip(several, combination)) for combination in itertools.product(*several.values())]


def text(rows):
    """Return the rows as a table that yade-batch runs; values that a row does not set are written as its defaults."""
    names = list(dict.fromkeys(name for row in rows for name in row))
    full = [parameters.complete(row) for row in rows]
    lines = [names] + [[str(row.get(name, NO_VALUE)) for name in names] for row in full]
    widths = [max(map(len, column)) for column in zip(*lines)]
    return "\n".join("  ".join(word.ljust(width) for word, width in zip(line, widths)).rstrip() for line in lines) + "\n"


def read(path):
    """Return the rows of a table, {line number: row}. Raise TableError if one of them cannot be run."""
    path = pathlib.Path(path)
    try:
        lines = path.read_text(encoding="utf-8-sig").split("\n")  # counted as YADE does, which knows no other ends of lines
    except OSError as error:
        raise TableError(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError as error:
        raise TableError(f"{path}: is no text in UTF-8 (byte {error.start}): a table is plain text") from None
    words = {number: found for number, line in enumerate(lines, 1) if (found := line.split("#")[0].split())}
    if len(words) < 2:
        raise TableError(f"{path}: a table is a line of parameter names and at least one line of values")
    (_, heads), *rest = words.items()
    heads = [head.rstrip("!") for head in heads]
    if any("," in head for head in heads):
        raise TableError(f"{path}: its columns have to be separated by spaces, not by commas")
    if twice := sorted({head for head in heads if heads.count(head) > 1}):
        raise TableError(f"{path}: column {' and '.join(twice)} is there more than once: keep one")
    rows, above = {}, None
    for number, values in rest:
        if len(values) != len(heads):
            raise TableError(f"{path}:{number}: {len(values)} values for {len(heads)} columns ({' '.join(heads)})")
        if "=" in values and above is None:
            raise TableError(f"{path}:{number}: '=' repeats the value above, but this is the first line")
        above = [old if value == "=" else value for value, old in zip(values, above or values)]
        rows[number] = {head: parameters.from_text(head, text) for head, text in zip(heads, above)
                        if head != "description" and not head.startswith("!") and text != NO_VALUE}
        try:
            parameters.complete(rows[number])
        except ParameterError as error:
            raise TableError(f"{path}:{number}: {error}") from None
    return rows


def given(arguments):
    """Return the row of a command: that of yade-batch's table if there is one, otherwise of name=value arguments."""
    place = os.environ.get("YADE_BATCH")  # empty where yade-batch has no table
    return batch_row(place) if place else parameters.from_arguments(arguments)


def batch_row(place):
    """Return the row at 'table:line', the value that yade-batch gives YADE_BATCH."""
    path, _, line = place.rpartition(":")
    rows = read(path)
    if not line.isdecimal() or int(line) not in rows:
        raise TableError(f"{path}: no run on line {line}; lines with runs: {', '.join(map(str, rows))}")
    return rows[int(line)]
