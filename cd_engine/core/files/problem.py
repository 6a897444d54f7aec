"""A contact problem given by its Delassus matrix, and the checks of its input."""
import contextlib
import os
from numbers import Real

import numpy as np
from scipy import sparse

MOST_FRICTION = 1e6  # with far larger coefficients rounding hides that a contact closes: in u_n + mu |u_t| nothing of u_n is left
LARGEST = 1e140  # the squares of numbers up to this have finite sums, and those of numbers down to one over this are not rounded to 0


class Problem:
    """n contacts of one time step, each with one row for its normal and one for each tangential direction: two in the plane, three in space.

    W   Delassus matrix [1/kg], a SciPy sparse matrix of 2n x 2n or 3n x 3n with a positive diagonal. It is symmetric and positive semidefinite in
        mechanics; neither is checked, since files with few digits satisfy both only approximately, and some codes make W unsymmetric
    q   relative velocities without contact impulses [m/s], 2n or 3n; the gap or the restitution of a contact is part of its normal component
    mu  Coulomb's friction coefficient of each contact, n, from 0 to 1e6
    dimension  2 or 3; by default the one that the sizes of W and mu tell

    Any other input raises ValueError with the place of the error.
    """

    def __init__(self, W, q, mu, dimension=None):
        rows = _matrix(W)
        self.dimension = _dimension(rows.shape[0], mu) if dimension is None else dimension
        self.W = _of_contacts(rows, self.dimension)
        self.q = vector("q", q, self.W.shape[0])
        self.mu = vector("mu", mu, self.W.shape[0] // self.dimension)
        refuse_friction(self.mu)
        refuse_sizes(self.q, self.W.diagonal())

    @property
    def contacts(self):
        return len(self.mu)

    def velocities(self, impulses):
        """Return the relative velocities u = W p + q [m/s] for impulses p [N s], each as long as q."""
        return self.W @ vector("impulses", impulses, len(self.q)) + self.q

    def __repr__(self):
        return f"<Problem of {self.contacts} contacts{' in space' if self.dimension == 3 else ''}, {self.W.nnz} numbers in W>"


def _dimension(rows, mu):
    """Return 3 if a W of so many rows has three for each number in mu, else 2."""
    try:
        return 3 if rows == 3 * len(mu) > 0 else 2
    except TypeError:
        return 2


def _matrix(W):
    """Return W in SciPy's row format with sorted columns and no entry twice. The given matrix is not changed."""
    try:
        if sparse.issparse(W):
            if hasattr(W, "check_format"):
                W.check_format(full_check=True)
        else:
            W = real(W)
            if W.ndim != 2:
                raise ValueError(f"it has {W.ndim} dimensions, not 2")
        if np.iscomplexobj(W):
            raise ValueError("its numbers are complex")
        rows = sparse.csr_matrix(W.astype(float))
    except (TypeError, ValueError, OverflowError) as error:
        raise ValueError(f"W is not a matrix of numbers: {error}") from None
    if rows.shape[0] != rows.shape[1]:
        raise ValueError(f"W is {rows.shape[0]} x {rows.shape[1]}; it must be square")
    if not rows.has_canonical_format:
        rows = rows.copy()
        rows.sum_duplicates()
    if (wrong := np.flatnonzero(~np.isfinite(rows.data))).size:
        row = np.searchsorted(rows.indptr, wrong[0], side="right") - 1
        raise ValueError(f"W[{row}, {rows.indices[wrong[0]]}] is {rows.data[wrong[0]]:g}, not a finite number")
    return rows


def _of_contacts(rows, dimension):
    """Return this W unless its rows or its diagonal cannot be those of contacts."""
    if rows.shape[0] % dimension:
        what = "two, so their number must be even" if dimension == 2 else "three in space, so their number must be a multiple of it"
        raise ValueError(f"W has {rows.shape[0]} rows; a contact has {what}")
    own = rows.diagonal()
    if (wrong := np.flatnonzero(own <= 0)).size:
        raise ValueError(f"W[{wrong[0]}, {wrong[0]}] = {own[wrong[0]]:g}, the {'tangential' if wrong[0] % dimension else 'normal'} inverse "
                         f"effective mass of contact {wrong[0] // dimension}, must be positive")
    return rows


def real(values):
    """Return `values` as a NumPy array. Raise ValueError, with what they are, unless they are real numbers and none is masked."""
    if np.ma.is_masked(values):
        raise ValueError("some of its numbers are masked")
    numbers = np.asarray(values)
    if numbers.dtype == object:
        if wrong := [value for value in numbers.flat if not isinstance(value, Real)]:
            raise ValueError(f"it holds {str(wrong[0])[:40]!r}")
    elif numbers.dtype.kind not in "biuf":
        raise ValueError("its numbers are complex" if numbers.dtype.kind == "c" else f"it holds values of the type {numbers.dtype}")
    return numbers


def array(name, values, shape, expected=None):
    """Return `values` as an array of finite numbers of this shape, or raise ValueError; `expected`: text for a wrong shape."""
    try:
        numbers = np.ascontiguousarray(real(values), dtype=float).reshape(np.shape(values))
    except (TypeError, ValueError, OverflowError) as error:
        raise ValueError(f"{name} is not an array of numbers: {error}") from None
    if numbers.shape != shape:
        raise ValueError(f"{name} has the shape {numbers.shape}; {expected or f'{shape} is expected'}")
    if (wrong := np.argwhere(~np.isfinite(numbers))).size:
        raise ValueError(f"{place(name, wrong[0])} is {numbers[tuple(wrong[0])]:g}, not a finite number")
    return numbers


def made(path, kind, *arrays, **fields):
    """Return the problem of this kind that a file holds. Raise its ValueError with the path."""
    try:
        return kind(*arrays, **fields)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


@contextlib.contextmanager
def replaced(path):
    """Give the name of a file to be written beside `path`, which it replaces once it is complete."""
    aside = f"{os.fsdecode(path)}.{os.getpid()}.part"
    try:
        yield aside
        os.replace(aside, path)
    finally:
        if os.path.exists(aside):
            os.remove(aside)


def vector(name, values, length):
    """Return `values` as an array of `length` finite numbers, or raise ValueError."""
    return array(name, values, (length,), f"a W of this size asks for {length} numbers in one row")


def whole_pairs(name, values, n):
    """Return n pairs of whole numbers, two for each contact, as 32-bit integers, or raise ValueError."""
    if np.ma.is_masked(values):
        raise ValueError(f"{name} is not an array of whole numbers: some of them are masked")
    pairs = np.asarray(values)
    if pairs.shape == (0,):
        pairs = pairs.reshape(0, 2).astype(int)
    if pairs.dtype.kind not in "iu":
        raise ValueError(f"{name} is not an array of whole numbers")
    if pairs.shape != (n, 2):
        raise ValueError(f"{name} has the shape {pairs.shape}; {(n, 2)} is expected")
    if (wrong := np.argwhere((pairs < -2**31) | (pairs >= 2**31))).size:
        raise ValueError(f"{place(name, wrong[0])} = {pairs[tuple(wrong[0])]} does not fit into 32 bits")
    return np.ascontiguousarray(pairs, dtype=np.int32)


def refuse_negative(name, numbers):
    """Raise ValueError with the first number below 0, if there is one."""
    if (wrong := np.argwhere(numbers < 0)).size:
        raise ValueError(f"{place(name, wrong[0])} = {numbers[tuple(wrong[0])]:g} is negative")


def refuse_friction(mu):
    """Raise ValueError with the first coefficient that is negative or larger than MOST_FRICTION, if there is one."""
    refuse_negative("mu", mu)
    if (wrong := np.flatnonzero(mu > MOST_FRICTION)).size:
        raise ValueError(f"mu[{wrong[0]}] = {mu[wrong[0]]:g} is larger than {MOST_FRICTION:g}; mu = 100 already keeps most contacts from sliding")


def refuse_sizes(q, own):
    """Raise ValueError if the squares of velocities q [m/s], or of the impulses q/own that they need, overflow or round to 0. own: the diagonal of
    W [1/kg]."""
    with np.errstate(over="ignore", under="ignore"):
        sizes = {"velocities q": np.abs(q), "impulses q/W": np.abs(q) / own}
    for what, size in sizes.items():
        if q.any() and not 1 / LARGEST <= size.max() <= LARGEST:
            raise ValueError(f"its {what} are up to {size.max():g}, while squares can be computed of numbers from {1 / LARGEST:g} to {LARGEST:g}: "
                             "take other units")


def place(name, index):
    """Return the name of an entry for a message, such as mu[3] or normals[3, 1]."""
    return f"{name}[{', '.join(map(str, index))}]"
