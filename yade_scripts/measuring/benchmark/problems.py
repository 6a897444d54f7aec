"""Makes each contact problem of the benchmark once, and keeps it under results/benchmark/problems."""
import functools
import json
import math
import pathlib
import tempfile
from dataclasses import dataclass, replace

import numpy as np

from cd_engine import core
from cd_engine.core.files.problem import replaced
from yade_scripts.measuring.benchmark import space_scenes, spheres
from yade_scripts.running import locks, queue

ROOT = pathlib.Path(__file__).resolve().parents[3]
PACKING_RECIPE = 2  # raised when packing.py or jammed.py changes its procedure, so that older files are not used
SPHERES_RECIPE = 1  # the same for spheres.py
FRICTION = 0.1, 0.5
FRICTION_IN_SPACE = 0.1, spheres.PREPARED, 0.5
SIDE = 0.01         # radius of a lattice's disks [m]


@dataclass(frozen=True)
class Case:
    """A contact problem and its first guess."""
    name: str
    kind: str      # packing, crystal, masses, pile, file, space, spheres
    mu: float      # nan for a problem from a file, whose contacts may differ in mu
    disks: int     # or other bodies; 0 for a problem from a file
    seed: int
    start: str     # first guess; cold: zero, warm: the impulses of the step before
    problem: object

    @property
    def impulses(self):
        """First guess [N s]."""
        return self.problem.impulses if self.start == "warm" else np.zeros(self.problem.dimension * self.problem.contacts)


def state(folder, disks, seed, mu):
    """Return the path, without its ending, of a packing's files (.npz problem, .json facts). Make them unless files of these settings exist."""
    stem = f"{folder}/packing{PACKING_RECIPE}-{disks}-{seed}"
    pathlib.Path(folder).mkdir(parents=True, exist_ok=True)
    with locks.held(pathlib.Path(folder) / f"packing-{disks}-{seed}"):
        if not pathlib.Path(f"{stem}-{mu:g}.json").exists():
            in_yade("packing", {"disks": disks, "seed": seed, "friction": FRICTION, "stem": stem})
    return f"{stem}-{mu:g}"


def in_yade(module, settings):
    """Return what main(**settings) of a module of this folder returns in YADE. Raise RuntimeError if it fails."""
    with tempfile.TemporaryDirectory() as folder:
        job = queue.Job("measuring/in_yade.py", [f"benchmark.{module}", json.dumps(settings)], pathlib.Path(folder) / module)
        queue.run([job], 1)
        try:
            return json.loads(job.said(1))
        except ValueError:
            raise RuntimeError(f"{module} {json.dumps(settings)} ended with status {job.process.returncode}: {job.said()[-600:]}") from None


def case(folder, kind, **settings):
    """Return the Case of a kind: what the function of that name below makes of the settings."""
    kinds = {"packing": functools.partial(packing, folder), "masses": functools.partial(masses, folder), "crystal": crystal, "file": from_file,
             "space": space, "spheres": functools.partial(packing_in_space, folder)}
    return kinds[kind](**settings)


def packing(folder, disks, seed, mu, start="cold"):
    """Return the Case of a step that loads a dense packing by 0.2 % more (packing.py)."""
    stem = state(folder, disks, seed, mu)
    return Case(f"packing {disks} mu {mu:g} {start} #{seed}", "packing", mu, disks, seed, start, core.read_problem(f"{stem}.npz"))


def packing_in_space(folder, bodies, seed, mu, start="cold"):
    """Return the Case of a step that loads a packing of spheres by 0.2 % more (spheres.py). All frictions share one packing."""
    stem = pathlib.Path(folder) / f"spheres{SPHERES_RECIPE}-{bodies}-{seed}"
    stem.parent.mkdir(parents=True, exist_ok=True)
    packed, path = (stem.with_name(f"{stem.name}-{name}.npz") for name in ("packed", f"{mu:g}"))
    with locks.held(stem):
        if not packed.exists():
            with replaced(packed) as aside, open(aside, "wb") as file:
                np.savez(file, *spheres.packing(bodies, seed))
        if not path.exists():
            with np.load(packed) as arrays:
                core.write_problem(path, spheres.problem([arrays[name] for name in arrays.files], mu))
    return Case(f"{bodies} packed spheres mu {mu:g} {start}", "spheres", mu, bodies, seed, start, core.read_problem(path))


def masses(folder, disks, seed, mu):
    """Return the cold case of `packing` with every mass multiplied by a random factor from 1 to 1e6, uniform in the logarithm."""
    case = packing(folder, disks, seed, mu)
    factor = 10.0**np.random.default_rng(seed).uniform(0, 6, (len(case.problem.inverse_masses), 1))
    # free_velocities contain the load as force times dt over mass; the force must not change.
    heavy = replace(case.problem, inverse_masses=case.problem.inverse_masses / factor, free_velocities=case.problem.free_velocities / factor)
    return replace(case, name=f"masses over 1e6, {disks} mu {mu:g}", kind="masses", problem=heavy)


def crystal(rows, mu, ratio=1.0, name="crystal"):
    """Return the Case of rows x rows equal disks in a triangular lattice between a floor and two walls, under gravity.

    All neighbours touch, so the contact forces are not unique. ratio: mass of the disks in the upper half over that of those below.
    """
    j, i = np.divmod(np.arange(rows * rows), rows)  # row by row, the lowest first
    mass = np.where(j >= rows / 2, ratio, 1.0)
    number = 1 + i + rows * j  # body 0: floor and walls
    inverse = np.vstack([[0, 0, 0], np.stack([1 / mass, 1 / mass, 2 / (mass * SIDE**2)], axis=1)])
    up = math.sqrt(3) / 2
    odd = j % 2
    links = []
    for kept, other, normal in ((i > 0, number - 1, (1, 0)),
                                (j > 0, number - rows + odd - 1, (0.5, up)),
                                (j > 0, number - rows + odd, (-0.5, up)),
                                (j == 0, 0 * number, (0, 1)),
                                ((i == 0) & (odd == 0), 0 * number, (1, 0)),
                                ((i == rows - 1) & (odd == 1), 0 * number, (-1, 0))):
        # One of the two neighbours in the row below may lie outside.
        if normal[1] == up:
            column = i + odd - (normal[0] > 0)
            kept = kept & (column >= 0) & (column < rows)
        links += [(a, b, *normal) for a, b in zip(other[kept], number[kept])]
    links = np.array(sorted(links, key=lambda link: (max(link[:2]), link[0], link[2])))
    pairs, n = links[:, :2].astype(int), len(links)
    arms = np.stack([np.zeros(n), np.where(pairs[:, 0] > 0, SIDE, 0), np.zeros(n), np.full(n, -SIDE)], axis=1)
    free = np.where(inverse > 0, (0, -9.81e-3, 0), 0)
    problem = core.BodyProblem(inverse, free, pairs, links[:, 2:], arms, np.zeros(n), np.full(n, mu))
    return Case(f"{name} {rows} x {rows} mu {mu:g}", name, mu, rows * rows, 0, "cold", problem)


def space(shape, bodies, mu, ratio=1.0):
    """Return the Case of a random scene in space (space_scenes.py)."""
    problem = space_scenes.scene(shape, bodies, mu, bodies, ratio)
    return Case(f"{bodies} {shape} mu {mu:g} masses over {ratio:g}", "space", mu, bodies, bodies, "cold", problem)


def from_file(path, sha256=""):
    """Return the Case of a problem in a file that `core.read_problem` reads. ValueError states what is wrong with the file.

    sha256: makes the settings of a changed file others; not looked at here.
    """
    problem = core.read_problem(path)
    return Case(pathlib.Path(path).stem, "file", float("nan"), 0, 0, "cold", problem)


def tiled(problem, copies):
    """Return `copies` copies of a problem of bodies side by side, which do not touch. The order of the contacts within a copy is the original one."""
    bodies = len(problem.inverse_masses)
    pairs = (problem.pairs[None] + bodies * np.arange(copies)[:, None, None]).reshape(-1, 2)
    rest = {name: np.concatenate([getattr(problem, name)] * copies)
            for name in ("inverse_masses", "free_velocities", "normals", "arms", "bias", "mu", "impulses")}
    return core.BodyProblem(pairs=pairs, **rest)
