"""Lists the pieces of `make bench`. A piece that was measured with this build is not measured again.

A piece has the table that its rows belong to, and settings. The name of its file contains a hash of both and of the compiled code. Use --again on
another machine, or after a change of the code that measures.
"""
import hashlib
import pathlib
from dataclasses import dataclass

from cd_engine import core
from yade_scripts.measuring import store
from yade_scripts.measuring.benchmark import problems, siconos, solutions, space, space_scenes, sweeps
from yade_scripts.tables import product

BOTH = ("cold", "warm")


# What measures the rows of each table, as function(folder of the problems, **settings).
MEASURE = {
    "solutions": lambda folder, problem, **how: solutions.measure(problems.case(folder, **problem), **how),
    "space": lambda folder, problem, **how: space.measure(problems.case(folder, **problem), **how),
    "spheres": lambda folder, problem, **how: solutions.measure(problems.case(folder, **problem), **how),
    "sweeps": sweeps.measure,
    "step": lambda folder, **settings: [problems.in_yade("step", settings)],
    "flow": lambda folder, **settings: [problems.in_yade("flow", settings)],
    "community": lambda folder, **settings: problems.in_yade("community", settings),
    "threads": lambda folder, **settings: problems.in_yade("threads", settings),
}


@dataclass(frozen=True)
class Piece:
    table: str
    settings: dict

    @property
    def name(self):
        return f"{self.table} " + " ".join(f"{name}={value}" for name, value in self.settings.get("problem", self.settings).items())

    def facts(self):
        """Return what decides the name of its file."""
        return {"table": self.table, "piece": self.name, "settings": self.settings, "build": build()}

    def stored(self, folder):
        """Return its rows if they were measured with this build, else None."""
        found = store.get(folder / "pieces", store.name_of(self.facts()))
        return found and found["rows"]

    def measure(self, folder):
        rows = MEASURE[self.table](folder / "problems", **self.settings)
        store.add(folder / "pieces", self.facts(), rows)
        return rows


def build():
    """Return the SHA-256 of the compiled solvers and of the plug-in."""
    compiled = (problems.ROOT / "cd_engine" / name for name in ("core/_core.so", "_yade_plugin.so"))
    return hashlib.sha256(b"".join(path.read_bytes() for path in compiled)).hexdigest()


def _pieces(table, *rows):
    return [Piece(table, settings) for several in rows for settings in several]


def _solve(*rows, **how):
    """Return pieces of solutions.py, one for each problem in the rows."""
    how = {"rounds": 3, "targets": solutions.TARGETS, "most_seconds": 5.0, "peer": siconos.available() is None} | how
    return [Piece("solutions", {"problem": problem} | how) for several in rows for problem in several]


def _space(*rows, files=(), **how):
    """Return pieces of space.py, one for each problem in the rows and each file of a problem in space."""
    rows = *rows, [settings for settings in _of_files(files) if core.read_problem(settings["path"]).dimension == 3]
    how = {"peer": siconos.available() is None} | how
    return [Piece("space", {"problem": problem} | how) for several in rows for problem in several]


def _packings(disks, seed, start):
    return product(kind="packing", disks=disks, seed=seed, mu=problems.FRICTION, start=start)


def _spheres(bodies, **how):
    """Return pieces of solutions.py for packings of spheres: cold to all targets, warm to one."""
    how = {"rounds": 2, "most_seconds": 5.0, "peer": siconos.available() is None} | how
    pieces = product(kind="spheres", bodies=bodies, seed=1, mu=problems.FRICTION_IN_SPACE, start=BOTH)
    return [Piece("spheres", {"problem": problem} | how | {"targets": (1e-4,) if problem["start"] == "warm" else (1e-4, 1e-6, 1e-8)})
            for problem in pieces]


def _of_files(files):
    # The settings contain a hash of the file, so that a changed file is measured anew.
    return [{"kind": "file", "path": str(path), "sha256": hashlib.sha256(pathlib.Path(path).read_bytes()).hexdigest()} for path in files]


def _plane(files):
    return [settings for settings in _of_files(files) if core.read_problem(settings["path"]).dimension == 2]


def _community():
    """Return pieces of community.py: fewer, larger grains for what is compared, all grains for the cost."""
    silo, cost = dict(case="silo", material=("M1", "M2"), orifice="large"), {"seed": 1, "window": 100}
    return _pieces("community", product(case="drum", **cost), product(**silo | {"material": "M1"}, **cost),
                   product(case="penetration", seed=(1, 2, 3), larger=2.0),
                   product(case="drum", seed=(1, 2, 3), larger=2.0, softer=100.0, seconds=2.0),
                   product(**silo, seed=(1, 2, 3), larger=3.0, softer=100.0, seconds=1.0),
                   product(case="silo", material="M1", orifice="small", seed=(1, 2), larger=2.5, softer=100.0, seconds=0.6),
                   product(case="silo", material="M1", orifice="large", seed=1, larger=3.0, softer=10.0, seconds=0.5))


def quick(files):
    """Return the pieces of a benchmark of two minutes: small packings, a row or two in each table."""
    peer = siconos.available() is None
    return (_solve(_packings(400, 1, BOTH), product(kind="crystal", rows=10, mu=0.8), _plane(files), targets=(1e-2, 1e-4, 1e-6), most_seconds=2.0)
            + _space(product(kind="space", shape=("spheres", "boxes"), bodies=20, mu=0.5), files=files, rounds=2, most_seconds=1.0)
            + _spheres(4000, rounds=1, most_seconds=2.0, peer_seconds=5.0)
            + _pieces("sweeps", product(disks=400, copies=(1, 10), rounds=3, peer=peer))
            + _pieces("step", product(rows=20, columns=20, tolerance=1e-4, steps=100, order="built"))
            + _pieces("flow", product(scene="hopper", disks=600, springs=False, tolerance=(1e-3, 0.0), steps=40))
            + _pieces("community", product(case="penetration", larger=4.0, softer=10.0))
            + _pieces("threads", product(rows=20, columns=20, tolerance=1e-4, steps=100)))


def full(files):
    peer = siconos.available() is None
    longer = {"peer_seconds": 30.0}
    step = {"rows": 20, "order": "built"}
    return (_solve(_packings(400, range(1, 6), BOTH))
            + _solve(_packings(4000, 1, BOTH), _packings(4000, (2, 3), "cold"), **longer)
            + _solve(product(kind="crystal", rows=20, mu=(0.5, 0.8)), product(kind="crystal", rows=60, mu=0.8),
                     product(kind="masses", disks=400, seed=1, mu=(0.5, 0.1)), product(kind="masses", disks=4000, seed=1, mu=0.1),
                     product(kind="crystal", rows=20, mu=(0.5, 0.8), ratio=1000.0, name="pile 1000:1 of"))
            + _solve(_plane(files), **longer)
            + _space(product(kind="space", shape=tuple(space_scenes.POINTS), bodies=(20, 60), mu=(0.1, 0.5), ratio=(1.0, 1e3)), files=files,
                     most_seconds=10.0)
            + _spheres(4000, most_seconds=30.0, peer_seconds=60.0) + _spheres(40000, most_seconds=60.0, peer_seconds=120.0)
            + _pieces("sweeps", product(disks=400, copies=1, rounds=5, peer=peer), product(disks=4000, copies=(1, 10), rounds=5, peer=peer),
                      product(disks=4000, copies=200, rounds=3, peer=peer))
            + _pieces("step", *(product(**step, columns=columns, steps=steps, tolerance=(1e-4, 1e-6))
                                for columns, steps in ((20, 2000), (200, 500), (2000, 500), (12500, 500))),
                      product(**step | {"order": "shuffled"}, columns=2000, steps=500, tolerance=1e-4),
                      product(**step, columns=50000, steps=150, tolerance=1e-4))
            + _pieces("flow", *(product(scene=scene, disks=disks, springs=springs, tolerance=tolerance, steps=300)
                                for scene, disks in (("drum", 2000), ("hopper", 600))
                                for springs, tolerance in ((False, (1e-3, 1e-4, 0.0)), (True, (1e-3, 1e-4)))))
            + _community()
            + _pieces("threads", *(product(rows=20, columns=columns, tolerance=1e-4, steps=steps) for columns, steps in ((200, 2000), (2000, 300))))
            + _solve(_packings(40000, 1, BOTH), targets=(1e-2, 1e-3, 1e-4, 1e-5, 1e-6), **longer))
