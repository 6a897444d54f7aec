"""Damaged files of problems are refused in one sentence that names the file, or read as another problem that `solve` takes: no crash, no other
exception, no endless loop. The damages are drawn: bytes, words and lines of texts, data sets of HDF5 that change their values, kinds or lengths."""
import random

import h5py
import numpy as np
import pytest

from cd_engine import core

from .test_files import MU, Q, STORAGES, W, siconos_text

DRAWS = 60  # of each file; 2900 draws found nothing when this was written
WORDS = [b"nan", b"-1", b"1e999", b"2147483648", b"9" * 20, b"0", b"3", b"x", b"", b"1e308"]
SPACE = core.Problem(np.kron(np.eye(2), np.diag([2.0, 1, 1])) + 0.1, [-1, 0.2, 0.1, -2, 0, 0.3], [0.3, 0.5])


def damaged_bytes(content, draw):
    content = bytearray(content)
    for _ in range(draw.randint(1, 20)):
        content[draw.randrange(len(content))] = draw.randrange(256)
    return bytes(content[:draw.randrange(len(content))]) if draw.random() < 0.2 else bytes(content)


def damaged_text(content, draw):
    lines = content.split(b"\n")
    for _ in range(draw.randint(1, 3)):
        line, way = draw.randrange(len(lines)), draw.randrange(6)
        if way == 0 and line:
            lines = lines[:line]
        elif way == 1:
            lines.insert(line, draw.choice(lines))
        else:
            words = lines[line].split() or [b""]
            words[draw.randrange(len(words))] = draw.choice(WORDS)
            lines[line] = b" ".join(words)
    return b"\n".join(lines)


def damage_data_set(path, draw):
    with h5py.File(path, "a") as file:
        names = []
        file.visititems(lambda name, what: names.append(name) if isinstance(what, h5py.Dataset) else None)
        name = draw.choice(names)
        value = np.atleast_1d(file[name][()])
        del file[name]
        if value.dtype.kind in "if":
            number = draw.choice([-1, 0, 7, 2**31 - 1] if value.dtype.kind == "i" else [np.nan, np.inf, 1e308, -3.0, 1e-320])
            place = draw.randrange(value.size)
            file[name] = draw.choice([np.where(np.arange(value.size) == place, number, value), value[:-1], np.repeat(value, 2), value.astype(complex),
                                      value.reshape(1, -1), np.array([b"text"])])


def files(folder):
    """Yield (path, its content) of a sound file of each kind."""
    for storage in STORAGES:
        yield folder / f"{storage}.dat", siconos_text(storage).encode()
    for name, problem in (("plane.hdf5", core.Problem(W, Q, MU)), ("space.hdf5", SPACE)):
        core.write_problem(folder / name, problem)
        yield folder / name, (folder / name).read_bytes()


@pytest.mark.filterwarnings("error")
def test_damaged_files_are_refused_or_solved(tmp_path):
    draw, refused = random.Random(1), 0
    for path, content in files(tmp_path):
        for _ in range(DRAWS):
            by_bytes = draw.random() < 0.3
            path.write_bytes(damaged_bytes(content, draw) if by_bytes else damaged_text(content, draw) if path.suffix == ".dat" else content)
            if path.suffix == ".hdf5" and not by_bytes:
                damage_data_set(path, draw)
            try:
                problem = core.read_problem(path)
            except ValueError as error:
                assert str(error).startswith(str(path)) and "\n" not in str(error)
                refused += 1
                continue
            report = core.solve(problem, max_iterations=100)
            assert np.isfinite(report.impulses).all()
    assert DRAWS < refused < 7 * DRAWS - 10  # both happen
