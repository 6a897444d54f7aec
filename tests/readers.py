"""Feeds every reader of files with damaged ones: each file is read, or refused in one sentence that names it; nothing else may happen.

`make test` draws hundreds for each reader, `make soak` thousands; the name of the reader seeds the draws.
"""
import contextlib
import hashlib
import io
import json
import pathlib
import random
from dataclasses import dataclass, replace
from typing import Callable

from analysis import benchmark, publish, report, studies
from analysis.charts import table as settings
from cd_engine import core
from tests.analysis.conftest import lattice, write
from tests.analysis.test_charts import series
from tests.analysis.test_published import FOLDER
from tests.core.test_body_problem import drawn
from tests.core.test_files import MU, Q, W, siconos_text
from yade_scripts import parameters, results, tables
from yade_scripts.measuring import store
from yade_scripts.preparing import prepare
from yade_scripts.results import reader

PIECES = [b"nan", b"inf", b"-1", b"1e999", b"=", b"#", b"\xff", b"\0", b'"', b"'", b"True", b"10**9", b"seed", b"1_0", b"\xc2\xb2", b"0x10",
          b"9" * 400, b"[", b"{}",
          b"scene", b"chain", b" ", b"\n", b"\t", b",", b"30", b"1e6", b"method", b"CD", b"null", b"[" * 3000]


def mutations(good, count, draw):
    """Damaged copies: cut, or with parts lost, repeated or replaced by bytes, by characters of numbers, or by words with a meaning in some format."""
    for _ in range(count):
        bad = bytearray(good)
        kind, place = draw.random(), draw.randrange(len(bad))
        part = slice(place, place + draw.randrange(1, 64))
        if kind < 0.15:
            del bad[place:]
        elif kind < 0.3:
            del bad[part]
        elif kind < 0.4:
            bad[place:place] = bad[part]
        elif kind < 0.6:
            bad[place:place + draw.randrange(7)] = draw.choice(PIECES)
        else:
            for _ in range(draw.choice([1, 1, 2, 4, 16])):
                bad[draw.randrange(len(bad))] = draw.choice([0, 1, 255, 127, 128, *b"-09.e", draw.randrange(256)])
        yield bytes(bad)


@dataclass
class Reader:
    """read(): reads all of the file as the program does; refusals: exceptions whose text is the message to the user; path: the file to damage."""
    path: pathlib.Path
    read: Callable
    refusals: tuple


def table(folder):
    """Tables of runs; a row that is not refused can be run."""
    path = folder / "table.txt"
    path.write_text(tables.text(studies.module("implicit").ROWS["full"]))

    def read():
        for row in tables.read(path).values():
            parameters.complete(row)
    return Reader(path, read, (tables.TableError,))


def result(folder):
    """Result files, read as a whole."""
    path = write(folder / "run.h5", snapshots={0.0: lattice(4, "MD")})
    return Reader(path, lambda: reader.load(path), (reader.ResultError,))


def ending(folder):
    """How the run of a result file ended, which decides whether it is run again. Every file must give an answer."""
    one = result(folder)

    def read():
        assert (said := results.status(one.path)) in ("finished", None) or isinstance(said, str)
    return replace(one, read=read, refusals=())


def _problem(path, write):
    write(path)
    return Reader(path, lambda: core.solve(core.read_problem(path), max_iterations=10), (ValueError,))


def problem_text(folder):
    """Contact problems in Siconos's text, sparse."""
    return _problem(folder / "problem.dat", lambda path: path.write_text(siconos_text("columns")))


def problem_dense(folder):
    """The same, dense."""
    return _problem(folder / "problem.dat", lambda path: path.write_text(siconos_text("dense")))


def problem_fclib(folder):
    """Contact problems of FCLIB."""
    return _problem(folder / "problem.hdf5", lambda path: core.write_problem(path, core.Problem(W, Q, MU)))


def problem_bodies(folder):
    """Contact problems by their bodies."""
    return _problem(folder / "problem.npz", lambda path: core.write_problem(path, drawn()))


def state(folder):
    """Prepared packings: a damaged one is prepared again, so none is refused, and no damaged one is used."""
    return _state(folder, "a.yade.gz")


def state_record(folder):
    """The records of prepared packings."""
    return _state(folder, "a.json")


def _state(folder, damaged):
    wanted, content = {"seed": 1, "recipe": 2}, bytes(range(256)) * 4
    checksum = hashlib.sha256(content).hexdigest()
    (folder / "a.yade.gz").write_bytes(content)
    (folder / "a.json").write_text(json.dumps({"sha256": checksum, "inputs": wanted}))

    def read():
        with contextlib.redirect_stderr(io.StringIO()) as said:
            found = prepare._verified(folder / "a.yade.gz", wanted)
        assert found in (None, checksum) and (found is None) == ("preparing it again" in said.getvalue())
    return Reader(folder / damaged, read, ())


def measurements(folder):
    """Measurements: a damaged file is measured again, so none is refused, and no damaged one is used."""
    facts = {"map": "a", "case": {"x": 1}, "seconds": 1.5}
    name = store.name_of(facts)
    store.add(folder, facts, [{"name": "x", "measured": 0.1}])
    whole = store.get(folder, name)

    def read():
        with contextlib.redirect_stderr(io.StringIO()) as said:
            found = store.get(folder, name)
        assert found in (None, whole) and (found is None) == ("measured again" in said.getvalue())
    return Reader(folder / f"{name}.h5", read, ())


def published_table(folder):
    """The table from which `recommend` answers."""
    path = folder / "work_precision.csv"
    publish.write_table(path, series("MD step", [1e-1, 1e-2]))
    return Reader(path, lambda: settings.from_csv(path), (reader.ResultError,))


def study_of_the_page(folder):
    """A study's findings, from which the page is made."""
    for suffix in (".json", ".csv", ".png"):
        (folder / f"fig4{suffix}").write_bytes((FOLDER / f"fig4{suffix}").read_bytes())
    return Reader(folder / "fig4.json", lambda: report.build(folder, folder / "page.html"), (reader.ResultError,))


def benchmark_table(folder):
    """Tables of the benchmark, from which its figures are drawn."""
    path = folder / "solutions.csv"
    lines = (FOLDER / "benchmark" / "solutions.csv").read_text().splitlines(keepends=True)
    path.write_text("".join(lines[:8]))
    return Reader(path, lambda: publish.read_table(path, **benchmark.COLUMNS["solutions"]), (reader.ResultError,))


READERS = {function.__name__: function for function in (
    table, result, ending, problem_text, problem_dense, problem_fclib, problem_bodies, state, state_record, measurements, published_table,
    study_of_the_page, benchmark_table)}


def feed(name, folder, count):
    """Feed the reader of this name with `count` damaged files. Return how many of them it refused."""
    fed = READERS[name](folder)
    good, refused = fed.path.read_bytes(), 0
    fed.read()
    for bad in mutations(good, count, random.Random(name)):
        fed.path.write_bytes(bad)
        try:
            fed.read()
        except fed.refusals as error:
            refused += 1
            said = str(error)
            assert str(fed.path) in said or str(fed.path.with_suffix("")) in said, said
            assert "\n" not in said and len(said) > len(str(fed.path)) + 10, said
    assert not fed.refusals or 0 < refused < count, f"{refused} of {count}: nothing is looked at, or everything refused"
    return refused
