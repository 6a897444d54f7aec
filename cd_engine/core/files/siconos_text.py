"""Reads the text in which Siconos writes a FrictionContactProblem of two or three dimensions (frictionContact_printInFile).

    dimension, contacts, storage of the matrix (0 dense, 1 blocks, 2 sparse), rows, columns, the matrix, q, mu

The three storages are those of Siconos's NM_write_in_file: dense by columns; blocks by rows with each block by columns; sparse as CSparse
prints a matrix, by columns, rows or triplets. Text after mu is ignored, as in Siconos: old files end with a flag.
"""
import pathlib
import re

import numpy as np
from scipy import sparse

from .problem import Problem, made

DENSE, BLOCKS, SPARSE = 0, 1, 2

_SIZES = re.compile(r"(csr: |triplet: |)(\d+)-by-(\d+), nzmax: \d+ nnz: (\d{1,18})(, 1-norm: \S+)?")
_INTEGER = re.compile(r"-?\d{1,18}")
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")


class _Text:
    """Gives the words of a file one after the other, and for messages the line in which each stands."""

    def __init__(self, path):
        self.path, content = path, pathlib.Path(path).read_bytes()
        try:
            text = content.decode("ascii")
        except UnicodeDecodeError as error:
            self.line = content.count(b"\n", 0, error.start) + 1
            raise self.error("is not text of a FrictionContactProblem") from None
        self.lines, self.words = self._lines(text), iter(())

    def error(self, what):
        return ValueError(f"{self.path}, line {self.line}: {what}")

    def _lines(self, text):
        for self.line, line in enumerate(text.split("\n"), 1):
            if line := line.strip():
                yield line
        raise self.error("the file ends too early")

    def next_line(self):
        """Return the next line that is not blank, stripped of surrounding blanks. The rest of the present line is skipped."""
        self.words = iter(())
        return next(self.lines)

    def word(self):
        for word in self.words:
            return word
        self.words = iter(self.next_line().split())
        return next(self.words)

    def expect(self, *words):
        for word in map(str, words):
            if (found := self.word()) != word:
                raise self.error(f"expected {word!r}, not {found[:40]!r}")

    def integer(self, what, low=0, high=2**31 - 1):
        word = self.word()
        if not _INTEGER.fullmatch(word):
            raise self.error(f"{what} should be a whole number, not {word[:40]!r}")
        if not low <= int(word) <= high:
            raise self.error(f"{what} is {int(word)}; it must lie between {low} and {high}")
        return int(word)

    def number(self, what):
        word = self.word()
        number = float(word) if _NUMBER.fullmatch(word) else np.nan
        if not np.isfinite(number):
            raise self.error(f"{what} should be a finite number, not {word[:40]!r}")
        return number

    def numbers(self, count, what):
        # One at a time, so that a count far too large fails at the end of the file and does not exhaust the memory.
        return np.array([self.number(f"{what}[{i}]") for i in range(count)])

    def entry(self, size, *places):
        """Return an entry of a matrix as cs_print writes it: its places, each below `size`, a colon and its value."""
        found = [self.integer(what, 0, size - 1) for what in places]
        self.expect(":")
        return *found, self.number("an entry")


def read(path):
    """Return the `Problem` in the file. Raise ValueError with the line if the file is damaged."""
    text = _Text(path)
    if (dimension := text.integer("the dimension")) not in (2, 3):
        raise text.error(f"the problem has {dimension} dimensions; only 2 and 3 are supported")
    contacts, storage, rows, columns = (text.integer(f"the {what}") for what in (
        "number of contacts", "storage of the matrix", "number of rows", "number of columns"))
    if rows != dimension * contacts or columns != dimension * contacts:
        raise text.error(f"the matrix is {rows} x {columns}, which does not fit {contacts} contacts with {('two', 'three')[dimension - 2]} rows each")
    if storage not in (DENSE, BLOCKS, SPARSE):
        raise text.error(f"unknown matrix storage {storage}: it must be 0 (dense), 1 (blocks) or 2 (sparse)")
    row, column, value = {DENSE: _dense, BLOCKS: _blocks, SPARSE: _sparse}[storage](text, rows)
    # Checked before arrays of the claimed size are made: a matrix that can be solved has its whole diagonal.
    if len(value) < rows:
        raise text.error(f"W has {len(value)} numbers, fewer than its {rows} rows; its diagonal must be positive")
    W = sparse.coo_matrix((value, (row, column)), shape=(rows, rows))
    return made(path, Problem, W, text.numbers(rows, "q"), text.numbers(contacts, "mu"), dimension)


def _dense(text, size):
    for what in ("rows", "columns"):
        text.integer(f"the number of {what}, given again,", size, size)
    values = text.numbers(size * size, "W")
    column, row = np.divmod(np.arange(size * size), max(size, 1))
    kept = values != 0
    return row[kept], column[kept], values[kept]


def _blocks(text, size):
    """Read Siconos's SparseBlockStructuredMatrix: the ends of the block rows and columns, the blocks of each row, their numbers."""
    count = text.integer("the number of blocks")
    of_rows = text.integer("the number of block rows", 0, size)
    of_columns = text.integer("the number of block columns", 0, size)
    ends = [_ends(text, number, size, what) for number, what in ((of_rows, "rows"), (of_columns, "columns"))]
    filled = text.integer("the number of row pointers", 1, of_rows + 1)
    text.integer("the number of blocks, given again,", count, count)
    pointers = [text.integer("a row pointer", 0, count) for _ in range(filled)]
    if pointers[0] != 0 or pointers[-1] != count or any(a > b for a, b in zip(pointers, pointers[1:])):
        raise text.error(f"the row pointers do not ascend from 0 to {count}")
    of_block = [text.integer("the column of a block", 0, of_columns - 1) for _ in range(count)]
    found = []
    for i in range(filled - 1):
        for k in range(pointers[i], pointers[i + 1]):
            text.integer("the number of a block", k, k)
            (top, bottom), (left, right) = (ends[0][i:i + 2], ends[1][of_block[k]:of_block[k] + 2])
            found += [(m, j, text.number(f"W[{m}, {j}]")) for j in range(left, right) for m in range(top, bottom)]
    return tuple(zip(*found)) or ((), (), ())


def _ends(text, number, size, what):
    ends = [0]
    for _ in range(number):
        ends.append(text.integer(f"the end of a block's {what}", ends[-1], size))
    if ends[-1] != size:
        raise text.error(f"the blocks end at {what} {ends[-1]}, not {size}")
    return ends


def _sparse(text, size):
    """Read a matrix as CSparse's cs_print prints it, with six digits a number."""
    text.integer("the origin of the sparse matrix")
    if not text.next_line().startswith("CSparse Version"):
        raise text.error("a sparse matrix should begin with 'CSparse Version'")
    sizes = _SIZES.fullmatch(text.next_line())
    if not sizes or not sizes[2] == sizes[3] == str(size):
        raise text.error(f"expected the sizes of the matrix, such as '{size}-by-{size}, nzmax: 8 nnz: 8, 1-norm: 2.5'")
    order, entries = sizes[1], int(sizes[4])
    if order == "triplet: ":
        found = [text.entry(size, "a row", "a column") for _ in range(entries)]
    else:
        found = _compressed(text, size, entries, "row" if order else "col")
    outer, inner, value = zip(*found) if found else ((), (), ())
    return (outer, inner, value) if order else (inner, outer, value)


def _compressed(text, size, entries, line):
    """Return the entries (number of the row or column, index in it, value) of a matrix by rows or columns; `line`: "row" or "col"."""
    found = []
    for number in range(size):
        text.expect(line, number, ":", "locations", len(found), "to")
        last = text.integer("the last location", len(found) - 1, entries - 1)
        found += [(number, *text.entry(size, "an index")) for _ in range(len(found), last + 1)]
    if len(found) != entries:
        raise text.error(f"the matrix has {len(found)} entries, {entries} were announced")
    return found
