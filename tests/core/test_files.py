"""Problems are read and written: each kind of file, how other codes read ours, and what happens with damaged ones."""
import ctypes
import multiprocessing
import os
import signal

import h5py
import numpy as np
import pytest
from scipy import sparse

from cd_engine import core
from tests import needs

from .test_problem import packed

# Siconos's matrices in text, 3 contacts: the middle one couples to both others.
W = np.array([
    [2, 0.5, -1, 0.25, 0, 0], [0.5, 3, 0.125, 1, 0, 0],
    [-1, 0.125, 4, 0, 1.5, -0.5], [0.25, 1, 0, 5, 0.75, 1],
    [0, 0, 1.5, 0.75, 2, -0.25], [0, 0, -0.5, 1, -0.25, 3]])
Q, MU = np.array([-1, 0.5, -2, 0, 0.25, -1e-3]), np.array([0, 0.5, 1])


def lines(*rows):
    return "\n".join(" ".join(map(str, np.atleast_1d(row))) for row in rows) + "\n"


def siconos_text(storage):
    """What frictionContact_printInFile of Siconos 4 writes for this problem, by storage of the matrix."""
    head = lines(2, 3, {"dense": 0, "blocks": 1}.get(storage, 2), 6, 6)
    if storage == "dense":
        matrix = lines([6, 6], *W.T.reshape(-1, 1))
    elif storage == "blocks":
        places = [(0, 0), (0, 1), (1, 0), (1, 1), (1, 2), (2, 1), (2, 2)]
        matrix = lines(7, 3, 3, [2, 4, 6], [2, 4, 6], 4, 7, [0, 2, 5, 7], [j for _, j in places])
        for number, (i, j) in enumerate(places):
            matrix += lines(number, *W[2 * i:2 * i + 2, 2 * j:2 * j + 2].T.reshape(-1, 1))
    else:
        matrix = "2\nCSparse Version 3.1.9, May 4, 2016.  Copyright (c) Timothy A. Davis, 2006-2016\n"
        if storage == "triplets":
            entries = np.argwhere(W)
            matrix += f"triplet: 6-by-6, nzmax: {len(entries)} nnz: {len(entries)}\n" + "".join(f"    {i} {j} : {W[i, j]:g}\n" for i, j in entries)
        else:
            A, prefix, line = (sparse.csc_matrix(W), "", "col") if storage == "columns" else (sparse.csr_matrix(W), "csr: ", "row")
            matrix += f"{prefix}6-by-6, nzmax: {A.nnz} nnz: {A.nnz}, 1-norm: 8\n"
            for k in range(6):
                matrix += f"    {line} {k} : locations {A.indptr[k]} to {A.indptr[k + 1] - 1}\n"
                matrix += "".join(f"      {A.indices[m]} : {A.data[m]:g}\n" for m in range(A.indptr[k], A.indptr[k + 1]))
    return head + matrix + lines(*Q) + lines(*MU)


STORAGES = "dense", "blocks", "columns", "rows", "triplets"


@pytest.fixture
def written(tmp_path):
    path = tmp_path / "problem.hdf5"
    core.write_problem(path, core.Problem(W, Q, MU), title="three contacts")
    return path


def same(problem):
    return np.array_equal(problem.W.toarray(), W) and np.array_equal(problem.q, Q) and np.array_equal(problem.mu, MU)


@pytest.mark.parametrize("storage", STORAGES)
def test_siconos_text(tmp_path, storage):
    path = tmp_path / "problem.dat"
    path.write_text(siconos_text(storage))
    assert same(core.read_problem(path))
    path.write_text(siconos_text(storage) + "0\n")  # the flag at the end of old files
    assert same(core.read_problem(str(path)))


@pytest.mark.parametrize("storage", ["dense", "blocks"])
def test_siconos_reads_the_same(tmp_path, storage):
    """The texts of this file are Siconos's: it reads them, and writes a problem that reads as the same."""
    numerics = needs.siconos()
    path, again = tmp_path / "problem.dat", tmp_path / "again.dat"
    path.write_text(siconos_text(storage))
    theirs = numerics.frictionContact_new_from_filename(str(path))
    numerics.frictionContact_printInFilename(theirs, str(again))
    ours = core.read_problem(again)
    assert np.allclose(ours.W.toarray(), W, atol=1e-15) and np.allclose(ours.q, Q) and np.allclose(ours.mu, MU)


def test_fclib_there_and_back(tmp_path, written):
    assert same(core.read_problem(written))
    problem = packed(50, 3)
    core.write_problem(written, problem)  # takes the place of the other
    back = core.read_problem(written)
    assert (back.W != problem.W).nnz == 0 and np.array_equal(back.q, problem.q) and np.array_equal(back.mu, problem.mu)
    assert list(tmp_path.iterdir()) == [written]


@pytest.mark.parametrize("kind", ["rows", "triplets"])
def test_fclib_other_storages(written, kind):
    A = sparse.csr_matrix(W)
    with h5py.File(written, "a") as file:
        group = file["fclib_local/W"]
        for name in ("p", "i", "x"):
            del group[name]
        group["nz"][0] = -2 if kind == "rows" else A.nnz
        group["p"] = A.indptr if kind == "rows" else A.tocoo().row
        group["i"], group["x"] = A.indices, A.data
    assert same(core.read_problem(written))


class FclibMatrix(ctypes.Structure):
    """struct fclib_matrix of fclib.h."""
    _fields_ = [(name, ctypes.c_int) for name in ("nzmax", "m", "n")] + [(name, ctypes.POINTER(ctypes.c_int)) for name in ("p", "i")] \
        + [("x", ctypes.POINTER(ctypes.c_double)), ("nz", ctypes.c_int), ("info", ctypes.c_void_p)]


class FclibLocal(ctypes.Structure):
    """struct fclib_local."""
    _fields_ = [(name, ctypes.POINTER(FclibMatrix)) for name in ("W", "V", "R")] \
        + [(name, ctypes.POINTER(ctypes.c_double)) for name in ("mu", "q", "s")] + [("spacedim", ctypes.c_int), ("info", ctypes.c_void_p)]


def test_libfclib_reads_it(written):
    library = needs.libfclib()
    library.fclib_read_local.restype = ctypes.POINTER(FclibLocal)
    read = library.fclib_read_local(str(written).encode())
    assert read
    theirs = read.contents
    m = theirs.W.contents
    assert (theirs.spacedim, m.m, m.n, m.nz) == (2, 6, 6, -1) and not theirs.V
    matrix = sparse.csc_matrix((m.x[:m.nzmax], m.i[:m.nzmax], m.p[:7]), shape=(6, 6))
    assert np.array_equal(matrix.toarray(), W) and theirs.q[:6] == list(Q) and theirs.mu[:3] == list(MU)


@pytest.mark.parametrize("old, new, words", [
    ("2\n3\n", "4\n3\n", "line 1.*4 dimensions"),
    ("2\n3\n", "2\n4\n", "line 5.*6 x 6.*4 contacts"),
    ("2\n3\n0\n", "2\n3\n7\n", "storage 7"),
    ("2\n3\n0\n6\n", "2\n3\n0\nsix\n", "line 4.*'six'"),
    ("2\n3\n0\n6\n", "2\n3\n0\n999999999999\n", "line 4"),
    ("2.0\n0.5\n", "2.0\nnan\n", r"line 8: W\[1\].*'nan'"),
    ("2.0\n0.5\n", "2.0\n1e999\n", "line 8.*finite"),
    ("2.0\n0.5", "0.0\n0.5", r"W\[0, 0\] = 0"),
    ("\n0.5\n1.0\n", "\n-0.5\n1.0\n", r"mu\[1\] = -0.5 is negative"),
    ("\n0.5\n1.0\n", "\n", "too early"),
    ("2\n3\n", "2\n\xff3\n", "line 2.*not text"),
])
def test_damaged_text(tmp_path, old, new, words):
    text = siconos_text("dense")
    assert old in text
    path = tmp_path / "problem.dat"
    # mu stands at the end; all else that is damaged, before a number like it.
    head, _, tail = text.rpartition(old) if "mu" in words or "early" in words else text.partition(old)
    path.write_bytes((head + new + tail).encode("latin-1"))
    with pytest.raises(ValueError, match=words) as raised:
        core.read_problem(path)
    assert str(path) in str(raised.value)


def replaced(name, value):
    def damage(file):
        del file[f"fclib_local/{name}"]
        if value is not None:
            file[f"fclib_local/{name}"] = value
    return damage


@pytest.mark.parametrize("damage, words", [
    (lambda file: file.move("fclib_local", "fclib_other"), "no /fclib_local"),
    (replaced("spacedim", [4]), "spacedim.*4 dimensions"),
    (replaced("spacedim", None), "spacedim.*missing"),
    (replaced("W", None), "W/m: is missing"),
    (replaced("W/m", [8]), "W: is 8 x 6"),
    (replaced("W/nz", [-5]), "W/nz"),
    (replaced("W/i", np.full(26, 17)), "W/i"),
    (replaced("W/p", [0, 9, 3, 9, 13, 20, 26]), "W/p: does not ascend"),
    (replaced("W/x", np.full(26, np.nan)), r"W\[0, 0\] is nan"),
    (replaced("W/x", ["a"] * 26), "W/x"),
    (replaced("vectors/q", np.zeros(5)), r"vectors/q: has the shape \(5,\)"),
    (replaced("vectors/q", np.full(6, np.inf)), r"q\[0\] is inf"),
    (replaced("vectors/mu", [0.1, -0.2, 0.3]), r"mu\[1\] = -0.2 is negative"),
    (lambda file: file.create_group("fclib_local/V"), "bilateral"),
])
def test_damaged_fclib(written, damage, words):
    with h5py.File(written, "a") as file:
        assert file["fclib_local/W/x"].shape == (26,)
        damage(file)
    with pytest.raises(ValueError, match=words) as raised:
        core.read_problem(written)
    assert str(written) in str(raised.value)


def test_cut_short_and_strange(tmp_path, written):
    whole = written.read_bytes()
    for size in (8, 100, len(whole) // 2, len(whole) - 1):
        written.write_bytes(whole[:size])
        with pytest.raises(ValueError, match="problem.hdf5"):
            core.read_problem(written)
    for content in (b"", b"\x00\x01\x02" * 100, b"\n" * 1000):
        written.write_bytes(content)
        with pytest.raises(ValueError, match="line"):
            core.read_problem(written)
    with pytest.raises(FileNotFoundError):
        core.read_problem(tmp_path / "none.hdf5")


def test_files_are_read_in_a_pool_of_processes_too(tmp_path):
    """Its processes may not have any of multiprocessing's own. The name is one of bytes."""
    path = os.fsencode(tmp_path / "problem.hdf5")
    core.write_problem(path, core.Problem(np.eye(2), [-1, 0], [0.5]))
    with multiprocessing.get_context("fork").Pool(1) as pool:
        assert pool.map(core.read_problem, [path])[0].contacts == 1


def test_a_crash_or_a_loop_below_is_a_refusal(tmp_path, monkeypatch):
    """Some damaged files send libhdf5 into an endless loop or a segmentation fault."""
    from cd_engine import guarded
    monkeypatch.setattr(guarded, "SECONDS", 1)
    path = tmp_path / "file"
    path.write_bytes(b"")

    def loop(_):
        while True:
            pass
    for function, words in ((lambda _: os.kill(os.getpid(), signal.SIGSEGV), "fails on it"), (loop, "did not finish")):
        with pytest.raises(ValueError, match=f"{path}: damaged.*{words}"):
            guarded.call(function, path)
    assert guarded.call(lambda _: "read", path) == "read"
