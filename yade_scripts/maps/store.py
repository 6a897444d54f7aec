"""The rows of a map: a CSV file that grows by a line a case, so that what was probed is never probed again. Needs no YADE."""
import csv
import math
import pathlib

from yade_scripts.maps import Outcome, get

FOLDER = "results/maps"
PROVENANCE = ("commit", "yade", "seconds")  # seconds: what the case took
FOUND = ("verdict", "reason", "told")


class StoreError(RuntimeError):
    """A file of rows cannot be used; the message says why and what to do."""


class Store:
    """The cases of one map that have an outcome."""

    def __init__(self, name, folder=FOLDER):
        self.map = get(name)
        self.path = pathlib.Path(folder) / f"{name}.csv"
        self.headings = [*PROVENANCE, *self.map.parameters, *FOUND, *self.map.measures]
        self.rows = []
        if self.path.is_file():
            self._read()

    def _read(self):
        with open(self.path, newline="", errors="replace") as file:
            # A line cut short by a crash is probed again.
            reader = csv.reader(line for line in file if line.endswith("\n"))
            headings = self._line(reader)
            if headings != self.headings:
                raise StoreError(f"{self.path}: its columns are not those of this map ({', '.join(headings or ['none'])}); "
                                 "an older version wrote it: move it away")
            words = {"commit", "yade", *FOUND, *(name for name, value in self.map.grid(False)[0].items() if isinstance(value, str))}
            while (cells := self._line(reader)) is not None:
                self.rows.append(self._typed(cells, words, reader.line_num))

    def _line(self, reader):
        """The next line's cells, None at the end."""
        try:
            return next(reader, None)
        except csv.Error as error:
            raise StoreError(f"{self.path}:{reader.line_num}: {error}; delete the line, it is probed again") from None

    def _typed(self, cells, words, line):
        """{heading: value} of a line."""
        try:
            row = {name: text if name in words else number(text) for name, text in zip(self.headings, cells, strict=True)}
            Outcome(*(row[name] for name in FOUND))
        except ValueError as error:
            raise StoreError(f"{self.path}:{line}: {error}; delete the line, it is probed again") from None
        return row

    def find(self, case):
        """The row of a case, or None."""
        return next((row for row in self.rows if all(row[name] == value for name, value in case.items())), None)

    def outcome(self, case):
        """The Outcome of a case that was probed, or None."""
        row = self.find(case)
        return None if row is None else Outcome(*(row[name] for name in FOUND), {name: row[name] for name in self.map.measures})

    def add(self, case, outcome, **provenance):
        """Append the row of a case to the file at once."""
        row = provenance | case | {name: getattr(outcome, name) for name in FOUND} | {
            name: float(outcome.measures.get(name, math.nan)) for name in self.map.measures}
        self.path.parent.mkdir(parents=True, exist_ok=True)
        new = not self.path.is_file()
        with open(self.path, "a+b") as file:
            drop_torn_line(file)
        with open(self.path, "a", newline="") as file:
            writer = csv.DictWriter(file, self.headings, lineterminator="\n")
            if new:
                writer.writeheader()
            writer.writerow(row)
        self.rows.append(row)


def drop_torn_line(file):
    """Cut a file, open for bytes, behind its last end of line, so that the next line does not continue one cut short by a crash."""
    file.seek(0)
    content = file.read()
    file.truncate(content.rfind(b"\n") + 1)


def number(text):
    """A cell as a number: an integer where it is one."""
    try:
        return int(text)
    except ValueError:
        return float(text)
