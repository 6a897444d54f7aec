"""Prepares a packing at rest under P0 and saves it under the hash of its inputs.

    yade -n -x yade_scripts/preparing/prepare.py seed=3 disks=400

YADE's TriaxialStressController compacts a gas of disks on a grid (of spheres, for a scene in space), in 2D with springs and dashpots (paper, section
3: "This first stage is carried out with the MD algorithm") and `preparation_friction`. Contacts are then stiffened by `stiffening`. Last, the
packing settles with `friction` and `wall_friction`. MD and CD start from this file.
"""
import gzip
import hashlib
import json
import math
import pathlib
import random
import struct
import sys
import time

if __name__ == "__main__":
    file = sys._getframe().f_code.co_filename  # YADE sets no __file__
    sys.path.insert(0, str(pathlib.Path(file).resolve().parents[2]))
    from yade_scripts import commands
    commands.script("yade_scripts.preparing.prepare", file)

from yade import O, config, utils

import cd_engine
from cd_engine import failing
from yade_scripts import commands, parameters, results, tables
from yade_scripts.errors import ParameterError
from yade_scripts.results import sealed
from yade_scripts.running import bodies, hooks, locks, md, progress, saved_scene, walls

# Part of the hash: raise it when the procedure below changes.
RECIPE = 2
STRESS_ERROR, UNBALANCED = 1e-7, 1e-8  # largest errors at rest: of a wall stress over P0; mean net force on a body over mean contact force
CHECKS = 3          # passed checks in a row that count as rest; one alone may fall between two hits of a rattler
CHECK_EVERY = 500   # steps
MOST_STEPS = 2000000
LOOSE = 1e-3  # both errors, for the end of an intermediate stage
LARGEST_STIFFENING = 1.3  # factor on k_n in one step


class PreparationError(RuntimeError):
    """The packing did not come to rest under its load."""


def inputs(full):
    """Return all inputs that determine the saved state."""
    space = {"in_space": True} if parameters.in_space(full) else {}
    return parameters.preparation(full) | space | {"yade_version": config.version, "recipe": RECIPE}


def ensure(full, folder):
    """Return (path, SHA-256) of the prepared state; prepare it if it does not exist, which leaves its scene in O.

    Raise ParameterError for a row with gravity, under which a packing would lie otherwise than its hash says.
    """
    if full["gravity"]:
        raise ParameterError(f"gravity = {full['gravity']}: packings are prepared without gravity: set gravity = 0")
    path = pathlib.Path(folder) / "states" / f"{parameters.digest(inputs(full), 16)}.yade.gz"
    path.parent.mkdir(parents=True, exist_ok=True)
    with locks.held(path):  # rows that run at the same time prepare it once
        checksum = _verified(path, inputs(full))
        if checksum is None:
            _make(full)
            checksum = _save(full, path)
    return path, checksum


def load(full, folder=results.FOLDER):
    """Load the prepared packing of a row into O. Return its SHA-256."""
    path, checksum = ensure(full, folder)
    O.load(str(path))
    return checksum


def _record(path):
    return path.with_name(path.name.split(".")[0] + ".json")


def _verified(path, wanted):
    """Return the SHA-256 of an existing, undamaged state that was prepared from the inputs `wanted`, else None."""
    if not path.exists():
        return None
    checksum = hashlib.sha256(path.read_bytes()).hexdigest()
    try:
        record = json.loads(_record(path).read_bytes())
        if record["sha256"] == checksum and record["inputs"] == wanted:
            return checksum
        reason = "is of another packing than its name says" if record["sha256"] == checksum else f"does not match its record {_record(path).name}"
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        reason = f"has no readable record {_record(path).name}"
    print(f"{path} {reason}: preparing it again.", file=sys.stderr)
    return None


def _save(full, path):
    """Write state and record, each to a temporary file that is then renamed. Return the SHA-256 of the state."""
    # YADE saves its computing speed, which differs in every run and cannot be set: its eight bytes, found by their value, become zero.
    content = gzip.compress(saved_scene.take().replace(struct.pack("<d", O.speed), bytes(8), 1), mtime=0)
    checksum = hashlib.sha256(content).hexdigest()
    facts = {"sha256": checksum, "inputs": inputs(full), "sigma": walls.mean_stresses(), "sides": walls.sides(),
             "solid_fraction": bodies.solid_fraction(), "contacts_per_disk": bodies.contacts_per_disk(),
             "unbalanced_force": utils.unbalancedForce()}
    sealed.replace(_record(path), (json.dumps(facts, indent=1) + "\n").encode())
    sealed.replace(path, content)
    return checksum


def gas(full):
    """Append walls 0..5, then disks or spheres on a grid with random radii, shifts and velocities."""
    draw = random.Random(full["seed"])
    space = parameters.in_space(full)
    axes = 3 if space else 2
    low, high = (full["radius_mean"] * (1 + sign * full["radius_spread"]) for sign in (-1, 1))
    bodies.append_material("wall", 0.0, full)
    bodies.append_material("disk", full["preparation_friction"], full)
    columns, cell = math.ceil(full["disks"]**(1 / axes) - 1e-9), 2.2 * high
    side = columns * cell
    walls.append((side, side), side if space else full["depth"], "wall")
    speed = 0.2 * math.sqrt(parameters.pressure(full) / full["density"])
    for k in range(full["disks"]):
        radius = draw.uniform(low, high)
        numbers = divmod(k, columns) if axes == 2 else (*divmod(k // columns, columns), k % columns)
        place = [(n + 0.5) * cell + draw.uniform(-1, 1) * (cell / 2 - radius) for n in numbers]
        velocity = [draw.uniform(-speed, speed) for _ in range(axes)]
        if space:
            bodies.append_sphere((*place[:2], place[2] - side / 2), radius, "disk", velocity)
        else:
            bodies.append_disk(place, radius, bodies.disk_mass(radius, full), "disk", velocity)


class _Rest:
    """Checks every CHECK_EVERY steps whether the sample is at rest under P0, and stops the loop if it is."""

    def __init__(self, p0, stress_error, unbalanced):
        self.p0, self.stress_error, self.unbalanced = p0, stress_error, unbalanced
        self.passed, self.said = 0, time.monotonic()

    def errors(self):
        """Return (largest wall stress error relative to P0, unbalanced force)."""
        return walls.stress_error(self.p0), utils.unbalancedForce()

    def check(self):
        stress, force = self.errors()
        if time.monotonic() - self.said >= progress.SECONDS:
            self.said = time.monotonic()
            print(f"preparing: wall stress off by {stress:.0e} P0 (goal {self.stress_error:g}), "
                  f"unbalanced force {force:.0e} (goal {self.unbalanced:g})", flush=True)
        self.passed = self.passed + 1 if stress < self.stress_error and force < self.unbalanced else 0
        if self.passed >= CHECKS:
            failing.stop()
        # A disk without contacts is not damped, and its next impact would disturb the others.
        for body in bodies.disks():
            if not bodies.loaded_contacts(body):
                body.state.vel = body.state.angVel = (0, 0, 0)


def _relax(full, stiffness, stress_error, unbalanced, damping):
    """Run under P0 to rest with contacts of `stiffness` [N/m]. Raise PreparationError after MOST_STEPS."""
    p0 = parameters.pressure(full)
    O.dt = 0.2 * math.sqrt(min(b.state.mass for b in bodies.disks()) / stiffness)
    # A tenth of sqrt(P0/rho): compaction without inertia (inertial number 0.01 for 400 disks).
    controller = walls.servo((p0, p0, p0), full["beta_n"], bodies.mean_mass(), stiffness, 0.1 * math.sqrt(p0 / full["density"]))
    rest = _Rest(p0, stress_error, unbalanced)
    O.engines = md.contact_engines(full | {"kn": stiffness, "stiffening": 1.0}) + [
        hooks.runner(rest.check, iterPeriod=CHECK_EVERY), controller, md.integrator(full, damping)]
    hooks.simulate(MOST_STEPS)
    if rest.passed < CHECKS:
        stress, force = rest.errors()
        raise PreparationError(f"no rest after {MOST_STEPS} steps: wall stress off by {stress:.1e} P0 (goal {stress_error:g}), unbalanced "
                               f"force {force:.1e} (goal {unbalanced:g}). Try another seed, more disks, or preparation_friction above 0.")


def _stiffen(full):
    """Raise the stiffness at constant P0 in small steps, since the overlaps of softer contacts push the grains apart. The friction is still that of
    the preparation; with the final friction, contacts that slide here would be at their limit when the loading begins."""
    stages = math.ceil(math.log(full["stiffening"]) / math.log(LARGEST_STIFFENING))
    for stage in range(1, stages + 1):
        md.stiffen(full["stiffening"]**(1 / stages))
        _relax(full, full["kn"] * full["stiffening"]**(stage / stages), LOOSE, LOOSE, damping=0.5)


def _make(full):
    O.reset()
    gas(full)
    _relax(full, full["kn"], LOOSE, LOOSE, damping=0.2)
    _stiffen(full)
    md.set_friction(full["friction"], full["wall_friction"])
    _relax(full, parameters.stiffness(full), STRESS_ERROR, UNBALANCED, damping=0.5)
    for body in O.bodies:
        body.state.vel = body.state.angVel = body.state.angMom = (0, 0, 0)
    O.engines = []
    O.resetTime()
    # User, date and process, which YADE saves: the same packing is to give the same file.
    for tag in list(O.tags.keys()):
        O.tags[tag] = "-"
    O.stopAtIter = 0


@commands.command("prepare")
def main(arguments=None):
    options = commands.parser(__doc__, "row", "--results").parse_args(arguments)
    cd_engine.methods()  # raises ImportError, with the remedy, in a YADE of another precision
    full = parameters.complete(tables.given(options.row))
    results.make(options.results)
    try:
        print(*ensure(full, options.results))
    except PreparationError as error:
        print(f"prepare: {error}", file=sys.stderr)
        return 1
    return 0
