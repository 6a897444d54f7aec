"""Reads and writes FCLIB files: local frictional contact problems in HDF5, the exchange format of the field.

V. Acary, M. Brémond, T. Koziara, F. Pérignon: FCLIB, a collection of discrete 3D frictional contact problems (INRIA RT-444, 2014); the
names and shapes are those of fclib.h. Its u = W r + q is this package's u = W p + q with the same signs and the same order (normal, tangential).
"""
import h5py
import numpy as np
from scipy import sparse

from ... import guarded
from .problem import Problem, made, replaced, whole_pairs

SIGNATURE = b"\x89HDF\r\n\x1a\n"  # start of an HDF5 file
COLUMNS, ROWS = -1, -2            # FCLIB's `nz` of a matrix compressed by columns, by rows; >= 0: so many triplets


def write_problem(path, problem, title="", description="", contact_ids=None):
    """Write `problem` as an FCLIB file. An existing file of that name is replaced only once the new one is complete.

    contact_ids: the two bodies of each contact, stored in a data set of that name beside FCLIB's own, which other readers ignore.
    """
    problem = Problem(problem.W, problem.q, problem.mu)
    W = problem.W.tocsc()
    if W.nnz >= 2**31:
        raise ValueError(f"W has {W.nnz} numbers; FCLIB counts them in 31 bits")
    for name, text in (("title", title), ("description", description)):
        if not isinstance(text, str):
            raise ValueError(f"{name}={text!r} is not a text")
    ids = None if contact_ids is None else whole_pairs("contact_ids", contact_ids, problem.contacts)
    integers = {"spacedim": [2], "W/nzmax": [W.nnz], "W/m": [W.shape[0]], "W/n": [W.shape[1]], "W/nz": [COLUMNS], "W/p": W.indptr,
                "W/i": W.indices}
    with replaced(path) as aside, h5py.File(aside, "w") as file:
        for name, value in integers.items():
            file[f"fclib_local/{name}"] = np.asarray(value, dtype=np.int32)
        for name, value in (("W/x", W.data), ("vectors/q", problem.q), ("vectors/mu", problem.mu)):
            file[f"fclib_local/{name}"] = value
        for name, value in (("title", title.encode()), ("description", description.encode())):
            # libfclib reads strings of fixed length and needs the zero at the end.
            file.create_dataset(f"fclib_local/info/{name}", data=np.bytes_(value), dtype=f"S{len(value) + 1}")
        if ids is not None:
            file["contact_ids"] = ids


def read(path):
    """Return the `Problem` in the file. Raise ValueError with the data set's name if the file is damaged or of another kind."""
    return made(path, Problem, *guarded.call(_arrays, path))


def _arrays(path):
    """Return W, q, mu as they stand in the file."""
    reader = _Reader(path)
    try:
        with h5py.File(path, "r") as reader.file:
            if not reader.has(""):
                raise _Refused(f"{path}: there is no /fclib_local in it; only FCLIB's local problems are read")
            if (dimension := reader.integer("spacedim")) != 2:
                raise reader.error("spacedim", f"the problem has {dimension} dimensions; only 2 are supported")
            for name in ("V", "R"):
                if reader.has(name):
                    raise reader.error(name, "bilateral constraints are not supported, only contacts")
            W = _matrix(reader)
            return W, reader.array("vectors/q", float, W.shape[0]), reader.array("vectors/mu", float, W.shape[0] // 2)
    except _Refused:
        raise
    except Exception as error:  # h5py raises exceptions of many types where a file is damaged
        place = f"{path}, /fclib_local/{reader.name}" if reader.name else path
        raise ValueError(f"{place}: the file is damaged or cut short ({error})") from None


class _Refused(ValueError):
    """The message states what is wrong with the file and where."""


class _Reader:
    """Data sets below /fclib_local. file: the open file. name: the data set that was asked for last."""

    def __init__(self, path):
        self.path, self.file, self.name = path, None, ""

    def error(self, name, what):
        return _Refused(f"{self.path}, /fclib_local/{name}: {what}")

    def has(self, name):
        self.name = name
        return f"fclib_local/{name}" in self.file

    def array(self, name, kind, length):
        """Return a data set of `length` numbers; `kind`: int or float."""
        if not self.has(name):
            raise self.error(name, "is missing")
        data = self.file[f"fclib_local/{name}"]
        shape, dtype = data.shape, data.dtype
        # Checked before the numbers are read: a damaged size may ask for any amount of memory.
        if shape != (length,):
            raise self.error(name, f"has the shape {shape}; {length} numbers in one row are expected")
        if dtype.kind not in ("iu" if kind is int else "iuf"):
            raise self.error(name, f"holds {dtype}, not numbers of the kind expected")
        return np.asarray(data[()], dtype=np.int64 if kind is int else float)

    def integer(self, name):
        return int(self.array(name, int, 1)[0])


def _matrix(reader):
    size, columns, kept, nz = (reader.integer(f"W/{name}") for name in ("m", "n", "nzmax", "nz"))
    if size != columns:
        raise reader.error("W", f"is {size} x {columns}; it must be square")
    if size < 0 or size % 2:
        raise reader.error("W/m", f"is {size}; a contact has two rows, so their number must be even")
    count = nz if nz >= 0 else kept
    if nz < ROWS or count < 0:
        raise reader.error("W/nz", f"is {nz} with nzmax {kept}, which is not a valid matrix storage")
    # Checked before arrays of the claimed size are made.
    if count < size:
        raise reader.error("W", f"has {count} numbers, fewer than its {size} rows; its diagonal must be positive")
    index = reader.array("W/i", int, count)
    value = reader.array("W/x", float, count)
    if index.size and not (0 <= index.min() and index.max() < size):
        raise reader.error("W/i", f"points outside a matrix of {size} rows")
    if nz >= 0:
        # fclib.h: p the rows, i the columns. Siconos writes them the other way round, which is the same for a symmetric W.
        row = reader.array("W/p", int, count)
        if row.size and not (0 <= row.min() and row.max() < size):
            raise reader.error("W/p", f"points outside a matrix of {size} rows")
        return sparse.coo_matrix((value, (row, index)), shape=(size, size))
    pointer = reader.array("W/p", int, size + 1)
    if pointer[0] != 0 or pointer[-1] != count or np.any(np.diff(pointer) < 0):
        raise reader.error("W/p", f"does not ascend from 0 to {count}")
    return (sparse.csc_matrix if nz == COLUMNS else sparse.csr_matrix)((value, index, pointer), shape=(size, size))
