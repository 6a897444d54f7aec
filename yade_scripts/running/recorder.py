"""Writes a run's HDF5 file: names, units and meanings are those of yade_scripts/results/schema.py.

The file is built in memory, written as a whole under another name, then renamed. So the file on the disk is readable at every moment, and libhdf5,
which crashes if a write fails, never meets a full disk. A run of 400 disks takes 1 MB; with 10^5 disks a snapshot takes about 20 MB.
"""
import io
import json
import math
import pathlib
import sys
import time

import h5py
import numpy as np
from yade import O, config, utils

import cd_engine
from yade_scripts import parameters
from yade_scripts.results import reader, schema, sealed
from yade_scripts.running import bodies, hooks, md, observe, walls
from yade_scripts.running.bounds import Bounds
from yade_scripts.results.provenance import git_commit
from yade_scripts.running.sums import total
from yade_scripts.running.wall_check import Collapse, LoadCheck

SAFE = 0.25  # md_dt_factor that is stable for every packing, see measuring/maps/md_packing.py
SECONDS = 30  # between two writes of the unfinished file, for those who want to look


def _clocks():
    return time.perf_counter(), hooks.processor_time()


def _called(what, function):
    """Return function() of a scene. Raise ValueError with the name of what it measures if it fails."""
    try:
        return function()
    except Exception as error:
        raise ValueError(f"{what}: {type(error).__name__}: {error}") from error


def _ending(full, failure, collapse):
    """Return outcome and status of a run that these exceptions, or None, have ended."""
    if failure is None:
        return schema.OUTCOME_COMPLETED if collapse is None else f"{schema.OUTCOME_COLLAPSED}{collapse}", schema.STATUS_FINISHED
    if isinstance(failure, cd_engine.Unstable):
        return f"{schema.OUTCOME_UNSTABLE}{remedy(full, failure)}", f"{schema.STATUS_UNSTABLE}{failure}"
    return schema.OUTCOME_FAILED, f"{schema.STATUS_FAILED}{failure}"


def remedy(full, failure):
    """Return what to change in the row of a run that an Unstable has ended."""
    name = "md_dt_factor" if full["method"] == "MD" else "cd_dt"
    if failure.step:
        return f"{name} = {full[name]:g} is too long, {_below(full[name] * failure.step / O.dt):g} would do"
    if full["method"] == "MD" and full[name] > SAFE and not full["tangential_damping"]:
        return f"{name} = {full[name]:g} is too long, {SAFE} would do"
    return f"use a smaller {name} than {full[name]:g}, or " + ("stiffer springs" if full["method"] == "MD" else "a smaller tolerance")


def _below(value):
    """Return the largest number of two digits that is at most `value`."""
    unit = 10.0**(math.floor(math.log10(value)) - 1)
    return math.floor(value / unit * (1 + 1e-12)) * unit


class Recorder:
    """Samples a scene into `<name>.partial.h5`, which becomes `<name>.h5` when the run ends, finished or failed."""
    NOT_KEPT = ("started", "written")  # by a checkpoint: readings of clocks

    def __init__(self, path, full, scene, progress=lambda fraction: None, record=None, checkpoint_samples=0):
        """record: the file's content so far, of a run that is resumed; None: a new file. checkpoint_samples: samples between checkpoints."""
        self.path, self.full, self.scene, self.progress = pathlib.Path(path), full, scene, progress
        self.partial = self.path.with_suffix(reader.PARTIAL_SUFFIX)
        self.names = [name for name, field in schema.HISTORY.items() if full["method"] in field.methods]
        self.rows, self.count, self.load_check = [], 0, LoadCheck(full, scene.samples)
        self.bounds = Bounds(dict(full), scene.load is not None)  # of a copy: reading a value here does not count as its effect
        self.started, self.seconds = _clocks(), (0.0, 0.0)  # computing time before `started`
        self.reference, self.first_sides, self.worst_across = None, None, None
        self.memory = io.BytesIO(record or b"")
        self.file = h5py.File(self.memory, "r+" if record else "w")
        if record:
            self.file.attrs["resumed"] += 1
        else:
            self._new_file(checkpoint_samples)
        self.written = time.monotonic()
        sealed.write(self.partial, self.image())

    def _new_file(self, checkpoint_samples):
        full = dict(self.full)  # a copy: storing a value does not count as its effect
        self.file.attrs.update({
            "schema_version": schema.SCHEMA_VERSION, "scene": full["scene"], "method": full["method"],
            "parameters": json.dumps(full), "state_sha256": self.scene.state_sha256, "git_commit": git_commit(),
            "yade_version": config.version, "seed": full["seed"], "finished": False, "status": "running", "outcome": "none yet",
            "pressure": parameters.pressure(full), "depth": full["depth"]})
        self.file.attrs.update(zip(schema.CHECKPOINT_ATTRIBUTES, (checkpoint_samples, 0)))
        for name in self.names:
            column = self.file.create_dataset(f"history/{name}", shape=(0,), maxshape=(None,), dtype=float)
            column.attrs["unit"] = schema.HISTORY[name].unit

    def image(self):
        """Return the content of the file so far, in bytes."""
        table = np.array(self.rows, float).reshape(-1, len(self.names))
        for name, values in zip(self.names, table.T):
            column = self.file[f"history/{name}"]
            first = len(column)
            column.resize((first + len(values),))
            column[first:] = values
        self.rows.clear()
        self.file.flush()
        self.seconds, self.started = self._elapsed(), _clocks()
        return self.memory.getvalue()

    def _elapsed(self):
        """Return (computing time, processor time) [s] of the run, without what an interruption has lost."""
        return tuple(before + now - start for before, now, start in zip(self.seconds, _clocks(), self.started))

    def sample(self):
        """Write one row of the history, at some samples a snapshot. Raise Collapse, StressError, OutOfBounds or Unstable where the run has to end."""
        elapsed = self._elapsed()
        row = self._measure() | dict(zip(("wall_clock", "processor_time"), elapsed))
        self.rows.append([row[name] for name in self.names])
        if self.count in self.scene.snapshots:
            self._snapshot(row)
        self.count += 1
        if time.monotonic() - self.written > SECONDS:
            sealed.write(self.partial, self.image())
            self.written = time.monotonic()
        self.progress((self.count - 1) / self.scene.samples)
        self.bounds.look(row, O.iter)
        try:
            if self.scene.load is not None:
                self.load_check.look(row | {"sigma1": self.worst_across})
        except Collapse:
            if self.count - 1 not in self.scene.snapshots:
                self._snapshot(row)
            raise

    def _measure(self):
        normal, tangential, friction, overlap = observe.loaded_contacts()
        row = {"time": O.time, "cycle": O.time / self.full["period"],
               "contacts": len(normal), "sliding_contacts": int(np.count_nonzero(schema.is_sliding(normal, tangential, friction))),
               "kinetic_energy": utils.kineticEnergy(), "unbalanced_force": utils.unbalancedForce()}
        row |= self._box()
        row |= self._cd() if self.full["method"] == "CD" else self._md(row) | {"max_penetration": max(overlap, default=0.0)}
        return row

    def _box(self):
        """Return stresses and strains; without a loaded box they have no meaning and are NaN."""
        if self.scene.load is None:
            return dict.fromkeys(schema.OF_A_BOX, math.nan) | {"wall_work": 0.0}
        sides = walls.sides()
        if self.first_sides is None:
            self.first_sides = sides
        along, across = walls.along_and_across([length / first - 1 for length, first in zip(sides, self.first_sides)])
        stresses, goal = walls.mean_stresses(), self.scene.load.goal
        sigma2, sigma1 = walls.along_and_across(stresses)
        self.worst_across = max(stresses[::2], key=lambda stress: abs(stress - goal[0]))  # of x and z; the history has their mean
        return {"sigma1": sigma1, "sigma2": sigma2, "sigma1_goal": goal[0], "sigma2_goal": goal[1], "strain1": across, "strain2": along,
                "gamma": along - across, "wall_work": self.scene.load.work()}

    def _md(self, row):
        """Return MD's energies. If the friction is not summed, the dissipated energy is computed from the energy balance."""
        stored = observe.stored_energy()
        if not self.full["md_energies"]:
            return {"stored_energy": stored, "dissipated_energy": math.nan, "friction_dissipation": math.nan}
        friction = md.friction_dissipation(self.full, self.scene.load is not None)
        gone = friction + sum(dashpots.work for dashpots in map(hooks.engine, ("DashpotWork", "TangentialDashpots")) if dashpots)
        if math.isnan(friction):
            weights = self.full["gravity"] * total(b.state.mass * b.state.pos[1] for b in bodies.disks())
            held = stored + row["kinetic_energy"] + weights - row["wall_work"]
            if self.reference is None:
                self.reference = held
            gone = self.reference - held
        return {"stored_energy": stored, "dissipated_energy": gone, "friction_dissipation": friction}

    def _cd(self):
        engine = hooks.engine("ContactDynamics")
        springs, lost = engine.stiffness < math.inf, engine.dissipatedEnergy + engine.dashpotEnergy + engine.dampedEnergy
        stored = observe.stored_energy(loaded=True) if springs and not engine.steps else engine.storedEnergy
        return {"stored_energy": stored, "dissipated_energy": lost, "max_penetration": engine.maxPenetration,
                "iterations": engine.iterations, "residual": engine.residual, "residual_max": engine.largestResidual,
                "unconverged_steps": engine.unconvergedSteps}

    def _snapshot(self, row):
        group = self.file.create_group(f"snapshots/{len(self.file.get('snapshots', ()))}")
        group.attrs.update({"time": row["time"], "cycle": row["cycle"]})
        for name, array in observe.snapshot(self.scene.load is not None).items():
            group.create_dataset(name, data=array).attrs["unit"] = schema.SNAPSHOT[name].unit

    def measure(self):
        """Store what the scene measures at its end. Raise an exception that names the quantity which cannot be measured or is no finite number."""
        for known in self.scene.known:
            number = _called(f"known {known.name!r}", lambda: float(known.measure()))
            if not math.isfinite(number):
                raise RuntimeError(f"known {known.name!r} is {number}: the run does not show it, or its measure() is wrong")
            value = self.file.create_dataset(f"known/{known.name}", data=number)
            value.attrs.update({name: getattr(known, name) for name in schema.KNOWN})
        for name, (unit, doc, array) in self.scene.extra.items():
            values = self.file.create_dataset(f"extra/{name}", data=_called(f"extra {name!r}", array) if callable(array) else array)
            if values.ndim == 0 and math.isnan(values[()]):
                print(f"run: the run does not show {name} ({doc}); take a longer one, or more disks.", file=sys.stderr)
            values.attrs.update({"unit": unit, "doc": doc})

    def close(self, failure=None, collapse=None):
        """End the file with its status; failure, collapse: the exception that ended the run. Return its known numbers, {name: reader.Known}."""
        self.file.attrs["outcome"], self.file.attrs["status"] = _ending(self.full, failure, collapse)
        self.file.attrs["finished"] = failure is None
        known = reader.known(self.file)
        self.image()
        self.file.close()
        sealed.write(self.path, self.memory.getvalue())
        self.partial.unlink(missing_ok=True)
        return known
