"""Reads and writes FCLIB files: frictional contact problems in HDF5, the exchange format of the field.

V. Acary, M. Brémond, T. Koziara, F. Pérignon: FCLIB, a collection of discrete 3D frictional contact problems (INRIA RT-444, 2014); the
names and shapes are those of fclib.h. Its u = W r + q is this package's u = W p + q with the same signs and the same order (normal, tangential).
A global problem, M v = H r + f and u = H^T v + w, is condensed: W = H^T M^-1 H, q = H^T M^-1 f + w.
"""
import h5py
import numpy as np
from scipy import sparse
from scipy.sparse import linalg

from ... import guarded
from .problem import Problem, made, replaced, whole_pairs

SIGNATURE = b"\x89HDF\r\n\x1a\n"  # start of an HDF5 file
WIDTH = 256                       # columns of W that are condensed at a time
COLUMNS, ROWS = -1, -2            # FCLIB's `nz` of a matrix compressed by columns, by rows; >= 0: so many triplets


def write_problem(path, problem, title="", description="", contact_ids=None):
    """Write `problem` as an FCLIB file. An existing file of that name is replaced only once the new one is complete.

    contact_ids: the two bodies of each contact, stored in a data set of that name beside FCLIB's own, which other readers ignore.
    """
    problem = Problem(problem.W, problem.q, problem.mu, problem.dimension)
    W = problem.W.tocsc()
    if W.nnz >= 2**31:
        raise ValueError(f"W has {W.nnz} numbers; FCLIB counts them in 31 bits")
    for name, text in (("title", title), ("description", description)):
        if not isinstance(text, str):
            raise ValueError(f"{name}={text!r} is not a text")
    ids = None if contact_ids is None else whole_pairs("contact_ids", contact_ids, problem.contacts)
    integers = {"spacedim": [problem.dimension], "W/nzmax": [W.nnz], "W/m": [W.shape[0]], "W/n": [W.shape[1]], "W/nz": [COLUMNS], "W/p": W.indptr,
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
    """Return W, q, mu and the dimension of the problem in the file."""
    reader = _Reader(path)
    try:
        with h5py.File(path, "r") as reader.file:
            for reader.group, read_group in (("fclib_local", _local), ("fclib_global", _global)):
                if reader.has(""):
                    return read_group(reader, _dimension(reader))
            raise _Refused(f"{path}: there is no /fclib_local or /fclib_global in it, so it holds no contact problem")
    except _Refused:
        raise
    except Exception as error:  # h5py raises exceptions of many types where a file is damaged
        place = f"{path}, /{reader.group}/{reader.name}" if reader.name else path
        raise ValueError(f"{place}: the file is damaged or cut short ({error})") from None


def _dimension(reader):
    if (dimension := reader.integer("spacedim")) not in (2, 3):
        raise reader.error("spacedim", f"the problem has {dimension} dimensions; only 2 and 3 are supported")
    for name in ("V", "R", "G", "b"):
        if reader.has(name) or reader.has(f"vectors/{name}"):
            raise reader.error(name, "bilateral constraints are not supported, only contacts")
    return dimension


def _local(reader, dimension):
    W = _matrix(reader, "W", dimension, square=True)
    return W, reader.array("vectors/q", float, W.shape[0]), reader.array("vectors/mu", float, W.shape[0] // dimension), dimension


def _global(reader, dimension):
    M, H = _matrix(reader, "M", 1, square=True).tocsc(), _matrix(reader, "H", dimension).tocsc()
    if M.shape[0] != H.shape[0]:
        raise reader.error("H", f"has {H.shape[0]} rows, but M has {M.shape[0]}")
    f, w = reader.array("vectors/f", float, H.shape[0]), reader.array("vectors/w", float, H.shape[1])
    mu = reader.array("vectors/mu", float, H.shape[1] // dimension)
    try:
        mass = linalg.splu(M)
    except RuntimeError as error:
        raise reader.error("M", f"cannot be inverted ({error})") from None
    HT = H.T.tocsr()
    W = sparse.hstack([sparse.csc_matrix(HT @ mass.solve(H[:, i:i + WIDTH].toarray())) for i in range(0, H.shape[1], WIDTH)] or [HT @ H])
    return W, HT @ mass.solve(f) + w, mu, dimension


class _Refused(ValueError):
    """The message states what is wrong with the file and where."""


class _Reader:
    """Data sets below a group of the file. file: the open file. name: the data set that was asked for last."""

    def __init__(self, path):
        self.path, self.file, self.group, self.name = path, None, "", ""

    def error(self, name, what):
        return _Refused(f"{self.path}, /{self.group}/{name}: {what}")

    def has(self, name):
        self.name = name
        return f"{self.group}/{name}" in self.file

    def array(self, name, kind, length):
        """Return a data set of `length` numbers; `kind`: int or float."""
        if not self.has(name):
            raise self.error(name, "is missing")
        data = self.file[f"{self.group}/{name}"]
        shape, dtype = data.shape, data.dtype
        # Checked before the numbers are read: a damaged size may ask for any amount of memory.
        if shape != (length,):
            raise self.error(name, f"has the shape {shape}; {length} numbers in one row are expected")
        if dtype.kind not in ("iu" if kind is int else "iuf"):
            raise self.error(name, f"holds {dtype}, not numbers of the kind expected")
        return np.asarray(data[()], dtype=np.int64 if kind is int else float)

    def integer(self, name):
        return int(self.array(name, int, 1)[0])


def _matrix(reader, name, columns, square=False):
    """Return a matrix with so many columns for each contact, or 1 for each freedom. A square one has a full diagonal."""
    high, wide, kept, nz = (reader.integer(f"{name}/{size}") for size in ("m", "n", "nzmax", "nz"))
    if square and high != wide:
        raise reader.error(name, f"is {high} x {wide}; it must be square")
    if high < 0 or wide < 0 or wide % columns:
        what = {1: "which is no size", 2: "a contact has two rows, so their number must be even"}.get(
            columns, "a contact has three rows, so their number must be a multiple of it")
        raise reader.error(f"{name}/{'m' if square else 'n'}", f"is {wide}; {what}")
    count = nz if nz >= 0 else kept
    if nz < ROWS or count < 0:
        raise reader.error(f"{name}/nz", f"is {nz} with nzmax {kept}, which is not a valid matrix storage")
    # Checked before arrays of the claimed size are made.
    if count < wide:
        raise reader.error(name, f"has {count} numbers, fewer than its {wide} {'rows; its diagonal must be positive' if square else 'columns'}")
    index, value = reader.array(f"{name}/i", int, count), reader.array(f"{name}/x", float, count)
    outer = {COLUMNS: wide + 1, ROWS: high + 1}.get(nz, count)
    pointer = reader.array(f"{name}/p", int, outer)
    if nz >= 0:
        return _triplets(reader, name, (high, wide), index, pointer, value)
    _refuse_outside(reader, f"{name}/i", index, high if nz == COLUMNS else wide, (high, wide))
    if pointer[0] != 0 or pointer[-1] != count or np.any(np.diff(pointer) < 0):
        raise reader.error(f"{name}/p", f"does not ascend from 0 to {count}")
    return (sparse.csc_matrix if nz == COLUMNS else sparse.csr_matrix)((value, index, pointer), shape=(high, wide))


def _triplets(reader, name, shape, i, p, value):
    """fclib.h calls p the rows and i the columns, but FCLIB's own functions hand the matrix to CSparse, for which i are the rows, and Siconos, which
    writes most of these files, does so, too. For a W of the plane, which is symmetric, both are the same. H has something in every column; only this
    order is possible if that is p."""
    siconos = reader.integer("spacedim") == 3 or (name == "H" and len(np.unique(p)) == shape[1])
    row, column = (i, p) if siconos else (p, i)
    for letter, entries, size in (("p" if siconos else "i", column, shape[1]), ("i" if siconos else "p", row, shape[0])):
        _refuse_outside(reader, f"{name}/{letter}", entries, size, shape)
    return sparse.coo_matrix((value, (row, column)), shape=shape)


def _refuse_outside(reader, name, numbers, size, shape):
    if numbers.size and not (0 <= numbers.min() and numbers.max() < size):
        raise reader.error(name, f"points outside a matrix of {shape[0]} rows" + (f" and {shape[1]} columns" if shape[0] != shape[1] else ""))
