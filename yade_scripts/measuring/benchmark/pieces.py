"""Lists the pieces of `make bench`. A piece that was measured with this build is not measured again.

A piece has the table that its rows belong to, a name, its settings, and a function that measures its rows. The name of its file contains a hash of
the settings and of the compiled code. Use --again on another machine, or after a change of the code that measures.
"""
import hashlib
import pathlib
from dataclasses import dataclass
from typing import Callable

from yade_scripts.measuring import store
from yade_scripts.measuring.benchmark import problems, siconos, solutions, sweeps

TABLES = "solutions", "oracle", "sweeps", "engine", "step"


@dataclass(frozen=True)
class Piece:
    table: str
    name: str
    settings: dict
    rows: Callable  # rows(say) returns the rows and reports progress by say(text)

    def facts(self):
        """Return what decides the name of its file: the table, and by a hash its name, settings and build."""
        return {"table": self.table, "piece": self.name, "settings": self.settings, "build": build()}

    def stored(self, folder):
        """Return its rows if they were measured with this build, else None."""
        found = store.get(pathlib.Path(folder) / "pieces", store.name_of(self.facts()))
        return found and found["rows"]

    def measure(self, folder, say):
        rows = self.rows(say)
        store.add(pathlib.Path(folder) / "pieces", self.facts() | store.origin(), rows)
        return rows


def build():
    """Return the SHA-256 of the compiled solvers and of the plug-in."""
    engine = problems.ROOT / "cd_engine"
    return hashlib.sha256(b"".join(path.read_bytes() for path in (engine / "core" / "_core.so", engine / "_yade_plugin.so"))).hexdigest()


def _solve(name, make, peer, **settings):
    """Return a piece of solutions.py; make() gives the case."""
    settings = {"rounds": 3, "targets": solutions.TARGETS, "most_seconds": 5.0, "peer": peer} | settings
    return Piece("solutions", name, settings, lambda say: solutions.measure(make(), say=say, **settings))


def _packing(folder, disks, seed, mu, start, peer, **settings):
    return _solve(f"packing {disks} #{seed} mu {mu:g} {start}", lambda: problems.packing(folder, disks, seed, mu, start), peer, **settings)


def _oracle(rows, mu):
    case = problems.crystal(rows, mu)
    return Piece("oracle", case.name, {}, lambda say: solutions.oracle(case))


def _sweep(folder, disks, copies, rounds, peer):
    def rows(say):
        case = problems.packing(folder, disks, 1, 0.5)
        problem = problems.tiled(case.problem, copies) if copies > 1 else case.problem
        name = f"{copies} packings of {disks}" if copies > 1 else f"packing of {disks}"
        return sweeps.measure(name, problem, copies * disks, rounds, peer and copies == 1, problems.crystal(4, 0.5).problem, say)
    return Piece("sweeps", f"sweeps over {copies} x {disks} disks", {"rounds": rounds, "peer": peer}, rows)


def _engine(folder, disks, mu, **settings):
    return Piece("engine", f"engine in YADE, {disks} disks mu {mu:g} to {settings['tolerance']:g}", settings,
                 lambda say: [problems.in_yade("engine.py", {"stem": str(problems.state(folder, disks, 1, mu))} | settings)])


def _step(rows, columns, **settings):
    """Return a piece of step.py: the cost of a step of a packing at rest, beside that of YADE's springs."""
    wish = {"rows": rows, "columns": columns} | settings
    return Piece("step", f"a step of {rows * columns} disks to {settings['tolerance']:g}, {settings['order']}", wish,
                 lambda say: [problems.in_yade("step.py", wish)])


def quick(folder, files):
    """Return the pieces of a benchmark of one minute: one small packing, a row or two in each table."""
    peer = siconos.available() is None
    few = {"targets": (1e-2, 1e-4, 1e-6), "most_seconds": 2.0}
    return [_packing(folder, 400, 1, mu, start, peer, **few) for mu in problems.FRICTION for start in ("cold", "warm")] \
        + [_solve("crystal", lambda: problems.crystal(10, 0.8), peer, **few)] \
        + [_file(path, peer, **few) for path in files] \
        + ([_oracle(4, 0.5)] if peer else []) \
        + [_sweep(folder, 400, copies, 3, peer) for copies in (1, 10)] \
        + [_engine(folder, 400, 0.5, tolerance=1e-6, steps=5, most_sweeps=10000), _step(20, 20, tolerance=1e-4, steps=100, order="built")]


def _file(path, peer, **settings):
    # The settings contain a hash of the file, so that a changed file is measured anew.
    content = hashlib.sha256(pathlib.Path(path).read_bytes()).hexdigest()
    piece = _solve(f"file {pathlib.Path(path).name}", lambda: problems.from_file(path), peer, **settings)
    return Piece(piece.table, piece.name, piece.settings | {"sha256": content}, piece.rows)


def full(folder, files):
    peer = siconos.available() is None
    worst, longer = {"most_seconds": 5.0}, {"peer_seconds": 30.0}
    cases = [_packing(folder, 400, seed, mu, start, peer, **worst)
             for seed in range(1, 6) for mu in problems.FRICTION for start in ("cold", "warm")]
    cases += [_packing(folder, 4000, seed, mu, start, peer, **longer)
              for seed in range(1, 4) for mu in problems.FRICTION for start in (("cold", "warm") if seed == 1 else ("cold",))]
    cases += [_solve(f"crystal {rows} mu {mu}", lambda rows=rows, mu=mu: problems.crystal(rows, mu), peer, **worst)
              for rows, mu in ((20, 0.5), (20, 0.8), (60, 0.8))]
    cases += [_solve(f"masses {disks} mu {mu}", lambda disks=disks, mu=mu: problems.masses(folder, disks, 1, mu), peer, **worst)
              for disks, mu in ((400, 0.5), (400, 0.1), (4000, 0.1))]
    cases += [_solve(f"pile {rows} mu {mu}", lambda rows=rows, mu=mu: problems.crystal(rows, mu, 1000.0, "pile 1000:1 of"), peer, **worst)
              for rows, mu in ((20, 0.5), (20, 0.8))]
    cases += [_file(path, peer, **longer) for path in files]
    return cases + ([_oracle(rows, mu) for rows, mu in ((3, 0.5), (4, 0.1), (4, 0.5), (4, 0.8))] if peer else []) \
        + [_sweep(folder, disks, copies, rounds, peer) for disks, copies, rounds in ((400, 1, 5), (4000, 1, 5), (4000, 10, 5), (4000, 200, 3))] \
        + [_engine(folder, 4000, mu, tolerance=1e-8, steps=25, most_sweeps=10000) for mu in problems.FRICTION] \
        + [_engine(folder, 40000, mu, tolerance=tolerance, steps=steps, most_sweeps=10000)
           for tolerance, steps in ((1e-4, 20), (1e-6, 8)) for mu in problems.FRICTION] \
        + [_step(20, columns, tolerance=tolerance, steps=steps, order="built") for columns, steps in ((20, 2000), (200, 500), (2000, 200), (12500, 100))
           for tolerance in (1e-4, 1e-6)] \
        + [_step(20, 2000, tolerance=1e-4, steps=200, order="shuffled"), _step(20, 50000, tolerance=1e-4, steps=50, order="built")] \
        + [_packing(folder, 40000, 1, mu, start, peer, targets=(1e-2, 1e-3, 1e-4, 1e-5, 1e-6), **longer)
           for mu in problems.FRICTION for start in ("cold", "warm")]
