"""Checkpoints of long runs: an interrupted run continues from the last one and ends with the same numbers.

At a checkpoint the run itself goes through O.save and O.load, as a resumed run does, so that both continue from the same bits. Checkpoints are
made at fixed samples, not at fixed times of the clock. So resumed and uninterrupted runs are equal although YADE does not save everything:
TriaxialStressController loses its wall stiffness and InsertionSortCollider its bounds. Stored in addition to YADE's file are the dissipation summed
by the law functor, the functions that the PyRunners call, and numbers kept in Python. Only runs longer than INTERVAL have checkpoints.
YADE does not save the forces on the bodies. All engines compute them again in the next step, except for CD's sample at the beginning of a step,
which records the forces of the step before. So a checkpoint is made one step after a sample, and CD with a sample at every step has none.

`<result>.checkpoint.zip` holds the scene, the record so far, and the other values as JSON. It is written under another name, flushed to the disk,
then renamed. Every part has a check sum. A checkpoint that does not fit the run is ignored with a message.
"""
import glob
import io
import json
import math
import sys
import zipfile

from yade import O, config

from cd_engine import watching
from yade_scripts import results
from yade_scripts.results import sealed
from yade_scripts.running import hooks, md, saved_scene
from yade_scripts.results.provenance import git_commit

# Disks times steps: about ten minutes on one core for MD, two to forty for CD, whose sweeps a step vary. Of the published studies only single runs of
# larger_flows and many_disks, those of 6400 disks (size) and of cycles by the hundred (long_cycles) are longer and have checkpoints.
INTERVAL = {"MD": 2 * 10**9, "CD": 4 * 10**7}
SCENE, RECORD, MEMORY = "scene.yade", "record.h5", "memory.json"


def samples_between(full, scene, asked=None):
    """Return the number of samples between two checkpoints: `asked`, by default that of INTERVAL; 0 if the run is short or cannot be resumed."""
    if scene.kept is None or full["method"] == "CD" and scene.every == 1:
        return 0
    if asked is not None:
        return asked
    count = math.ceil(INTERVAL[full["method"]] / (full["disks"] * scene.every))
    return count if count < scene.samples else 0


class Checkpoints:
    """The checkpoints of one run: where they are, how they are written and read."""

    def __init__(self, path, full, scene, every):
        self.path, self.full, self.scene, self.every = results.checkpoint_of(path), full, scene, every
        # All of this must be the same in the run that wrote the checkpoint and in this one.
        self.origin = {"parameters": full, "git_commit": git_commit(), "yade_version": config.version, "state_sha256": scene.state_sha256,
                       "samples_between": every}

    def found(self):
        """Return {RECORD: bytes, SCENE: bytes, MEMORY: dict} of the checkpoint of this run, or None. Print why one cannot be used."""
        if not self.path.exists():
            return None
        try:
            with zipfile.ZipFile(self.path) as archive:
                parts = {name: archive.read(name) for name in (SCENE, RECORD, MEMORY)}
            memory = json.loads(parts[MEMORY])
            different = [name for name, value in self.origin.items() if memory["origin"].get(name) != value]
        except Exception as error:  # a damaged archive raises exceptions of many types
            reason = f"it is damaged ({error})"
        else:
            if not different:
                return parts | {MEMORY: memory}
            reason = f"it differs from this run in {', '.join(different)}"
        print(f"{self.path} is not used, {reason}: starting from the beginning.", file=sys.stderr)
        return None

    def simulate(self, steps, recorder):
        """Make steps until the run has made `steps` of them, with checkpoints on the way."""
        between = self.every * self.scene.every
        while O.iter < steps:
            goal = min(O.iter // between * between + between + 1, steps) if between else steps
            hooks.simulate(goal - O.iter)
            if O.iter < goal:  # stopped by a hook
                return
            if goal < steps:
                self.take(recorder)

    def take(self, recorder):
        """Write a checkpoint, then continue from it."""
        scene, record = saved_scene.take(), recorder.image()
        memory = {"origin": self.origin, "friction": md.law().plasticDissipation() if self.full["method"] == "MD" else None,
                  "kept": {name: _kept(keeper) for name, keeper in self._keepers(recorder).items()}, "scene": self.scene.kept}
        content = io.BytesIO()
        with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
            archive.writestr(SCENE, scene)
            archive.writestr(RECORD, record)
            archive.writestr(MEMORY, json.dumps(memory))
        sealed.replace(self.path, content.getvalue())
        with watching.kept():
            self.resume({SCENE: scene, MEMORY: json.loads(json.dumps(memory))}, recorder)

    def resume(self, parts, recorder):
        """Load the parts of a checkpoint, including the values that O.load does not restore. The scene of the run must have been built in O."""
        memory = parts[MEMORY]
        saved_scene.restore(parts[SCENE])
        if self.full["method"] == "MD":
            md.bind(self.full, self.scene)
            md.law().initPlasticDissipation(memory["friction"])
        for name, keeper in self._keepers(recorder).items():
            for attribute, value in memory["kept"][name].items():
                setattr(keeper, attribute, value)
        for name, values in memory["scene"].items():
            self.scene.kept[name][:] = values

    def _keepers(self, recorder):
        """Return the objects in Python that change as the run goes on."""
        found = {"load": self.scene.load, "recorder": recorder, "load_check": recorder.load_check, "bounds": recorder.bounds}
        return {name: keeper for name, keeper in found.items() if keeper is not None}

    def remove(self):
        """Remove the checkpoint, and files of this run that were half written when it was killed. Call it when the run has ended."""
        self.path.unlink(missing_ok=True)
        name = self.path.name.removesuffix(".checkpoint.zip")
        for left in self.path.parent.glob(f"{glob.escape(name)}.*.new"):
            left.unlink(missing_ok=True)


def _kept(keeper):
    """Return all numbers among an object's attributes, so that later attributes are included without a list of names."""
    return {name: value for name, value in vars(keeper).items() if _is_numbers(value) and name not in getattr(keeper, "NOT_KEPT", ())}


def _is_numbers(value):
    """Tell whether a value consists of None, numbers, and lists of them."""
    return value is None or isinstance(value, (int, float)) or isinstance(value, (list, tuple)) and all(map(_is_numbers, value))
