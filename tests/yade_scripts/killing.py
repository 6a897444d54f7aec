"""Kills runs, and checks the files that they leave."""
import os
import signal
import subprocess
import time

import h5py
import numpy as np

from yade_scripts.results import reader
from yade_scripts import results

from .conftest import SCRIPTS

# Nine checkpoints a run, so that kills fall before, between and within them.
EVERY = 3
BASE = dict(disks=20, period=0.05, cycles=3, records_per_cycle=10)
ROWS = {"MD_force": BASE | dict(method="MD", md_walls="force", period=0.2, cycles=2), "CD": BASE | dict(method="CD"),
        "MD_servo": BASE | dict(method="MD", md_walls="servo"),
        "drum": BASE | dict(scene="drum", period=0.5, cycles=1, records_per_cycle=30)}


def make(folder, states):
    """Make a folder of results with the packings of another folder."""
    for place in (folder, states):
        place.mkdir(exist_ok=True)
    (folder / "states").symlink_to(states)


def start(folder, row, *options, threads="1"):
    """A run under way in a process of its own."""
    arguments = [f"{name}={value}" for name, value in row.items()]
    return subprocess.Popen(["yade", "-n", "-x", "-j", threads, str(SCRIPTS / "run.py"), f"--results={folder}", *options, *arguments],
                            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def whole(folder, row, *options):
    """An uninterrupted run: (result file, seconds from start to end)."""
    began = time.monotonic()
    process = start(folder, row, *options)
    said, _ = process.communicate(timeout=1200)
    path = only_result(folder)
    assert process.returncode == 0 and results.finished(path), said
    return path, time.monotonic() - began


def only_result(folder):
    """The one file under a final name, or None."""
    found = [path for path in folder.glob("*.h5") if not path.name.endswith(reader.PARTIAL_SUFFIX)]
    assert len(found) <= 1
    return found[0] if found else None


def kill_at(folder, row, seconds, *options, by=signal.SIGKILL):
    """Start a run and kill it after so many seconds; False if it had ended before."""
    process = start(folder, row, *options)
    try:
        said, _ = process.communicate(timeout=seconds)
        assert process.returncode == 0, said
        return False
    except subprocess.TimeoutExpired:
        os.kill(process.pid, by)
        process.communicate(timeout=1200)
    check_what_is_left(folder)
    return True


def check_what_is_left(folder):
    """A file with a final name is complete; an unfinished one is readable and is not taken for a result."""
    done = only_result(folder)
    if done is not None:
        reader.load(done)
    for path in folder.glob("*" + reader.PARTIAL_SUFFIX):
        assert reader.load(path, finished=False).attributes["status"] == "running"
        assert not results.finished(path)


def differences(one, other):
    """Names of the data sets of two result files that differ in any bit; computing times do, always."""
    found = []
    with h5py.File(one) as first, h5py.File(other) as second:
        def compare(name, data):
            if isinstance(data, h5py.Dataset) and name not in ("history/wall_clock", "history/processor_time"):
                if name not in second or np.asarray(data[()]).tobytes() != np.asarray(second[name][()]).tobytes():
                    found.append(name)
        first.visititems(compare)
        return found + [name for name in ("status", "outcome", "state_sha256", "parameters") if first.attrs[name] != second.attrs[name]]
