"""Checkpoints of long runs: an interrupted run goes on from the last one, and ends with the same numbers.

At a checkpoint the run itself goes through O.save and O.load, as a resumed one does, so that both continue from the same bits. Checkpoints stand
at fixed samples, never at a time of the clock. So resumed and uninterrupted runs are equal even though YADE does not save everything:
TriaxialStressController loses its wall stiffness and InsertionSortCollider its bounds. Kept beside YADE's file are the dissipation that the law
functor has summed, which functions the PyRunners call, and the numbers that live in Python. Only runs longer than INTERVAL have checkpoints.
The forces on the bodies are lost, and forces added after O.load would outlive the next ForceResetter. Every engine list computes them anew, except
for CD's sample at the beginning of a step, which shows those of the step before; so a checkpoint stands one step behind a sample, and CD
with a sample at every step has none.

`<result>.checkpoint.zip` holds the scene, the record up to then and the rest as JSON. It is written aside, brought to the disk, then
renamed, and every part has a check sum; one that does not fit the run is left aside with a message.
"""
import glob
import io
import json
import math
import pathlib
import struct
import sys
import zipfile
import zlib

from yade import O, config

from yade_scripts import scenes
from yade_scripts.results import sealed
from yade_scripts.running import hooks, saved_scene
from yade_scripts.results.provenance import git_commit

# Disks times steps: about ten minutes on one core for MD, two to forty for CD, whose sweeps a step vary. Every published run is shorter and so has none.
INTERVAL = {"MD": 2 * 10**9, "CD": 4 * 10**7}
SCENE, RECORD, MEMORY = "scene.yade", "record.h5", "memory.json"


def samples_between(full, scene):
    """Return the samples between two checkpoints of a run; 0: it has none, being short, or cannot be resumed."""
    count = math.ceil(INTERVAL[full["method"]] / (full["disks"] * scene.every))
    return count if resumable(full, scene) and count < scene.samples else 0


def resumable(full, scene):
    return scene.kept is not None and (full["method"] == "MD" or scene.every > 1)


class Checkpoints:
    """Of one run: where they stand, how they are taken and taken up. `recorder` is made anew or from the checkpoint before the run."""

    def __init__(self, path, full, scene, every):
        self.path, self.full, self.scene, self.every = pathlib.Path(path).with_suffix(".checkpoint.zip"), full, scene, every
        # What the checkpoint must have been made by and for.
        self.origin = {"parameters": full, "git_commit": git_commit(), "yade_version": config.version, "state_sha256": scene.state_sha256,
                       "samples_between": every}

    def found(self):
        """Return {RECORD: bytes, SCENE: bytes, MEMORY: dict} of the last checkpoint that fits this run, or None; says why one does not."""
        if not self.path.exists():
            return None
        try:
            with zipfile.ZipFile(self.path) as archive:
                parts = {name: archive.read(name) for name in (SCENE, RECORD, MEMORY)}
            memory = json.loads(parts[MEMORY])
            different = [name for name, value in self.origin.items() if memory["origin"].get(name) != value]
        except (zipfile.BadZipFile, zlib.error, struct.error, EOFError, OSError, RuntimeError, ValueError, KeyError, AttributeError, TypeError) as error:
            reason = f"it is damaged ({error})"
        else:
            if not different:
                return parts | {MEMORY: memory}
            reason = f"it differs from this run in {', '.join(different)}"
        print(f"{self.path} is not used, {reason}: starting from the beginning.", file=sys.stderr)
        return None

    def simulate(self, steps, recorder):
        """Make steps up to number `steps` of the run, with a checkpoint after every step with a sample that one stands at."""
        between = self.every * self.scene.every
        while O.iter < steps:
            goal = min(O.iter // between * between + between + 1, steps) if between else steps
            hooks.simulate(goal - O.iter)
            if O.iter < goal:  # stopped by a hook
                return
            if goal < steps:
                self.take(recorder)

    def take(self, recorder):
        """Save, then go on from what was saved."""
        scene, record = saved_scene.take(), recorder.image()
        memory = {"origin": self.origin, "losses": self.scene.losses.memory() if self.scene.losses else None,
                  "kept": {name: _kept(keeper) for name, keeper in self._keepers(recorder).items()}, "scene": self.scene.kept}
        content = io.BytesIO()
        with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
            archive.writestr(SCENE, scene)
            archive.writestr(RECORD, record)
            archive.writestr(MEMORY, json.dumps(memory))
        sealed.replace(self.path, content.getvalue())
        self.resume({SCENE: scene, MEMORY: json.loads(json.dumps(memory))}, recorder)

    def resume(self, parts, recorder):
        """Do O.load and what it forgets, from the parts that `found` gave or a run has just saved; in O the scene of the run has been built."""
        memory = parts[MEMORY]
        saved_scene.restore(parts[SCENE])
        scenes.method(self.full).bind(self.full, self.scene)
        if self.scene.losses:
            self.scene.losses.remember(memory["losses"])
        for name, keeper in self._keepers(recorder).items():
            for attribute, value in memory["kept"][name].items():
                setattr(keeper, attribute, value)
        for name, values in memory["scene"].items():
            self.scene.kept[name][:] = values

    def _keepers(self, recorder):
        """Return the objects in Python that change as the run goes on."""
        found = {"load": self.scene.load, "watch": self.scene.watch, "recorder": recorder, "load_check": recorder.load_check, "bounds": recorder.bounds}
        return {name: keeper for name, keeper in found.items() if keeper is not None}

    def remove(self):
        """Remove the checkpoint, and files of this run that were half written when it was killed. Call it when the run has ended."""
        self.path.unlink(missing_ok=True)
        name = self.path.name.removesuffix(".checkpoint.zip")
        for left in self.path.parent.glob(f"{glob.escape(name)}.*.new"):
            left.unlink(missing_ok=True)


def _kept(keeper):
    """Return all numbers that an object holds; not a chosen few, so that none is forgotten when it is given one more."""
    return {name: value for name, value in vars(keeper).items() if _is_numbers(value) and name not in getattr(keeper, "NOT_KEPT", ())}


def _is_numbers(value):
    """Tell whether a value consists of None, numbers, and lists of them."""
    return value is None or isinstance(value, (int, float)) or isinstance(value, (list, tuple)) and all(map(_is_numbers, value))
