"""Runs of YADE in processes of their own, and one prepared packing of 60 disks for all tests of a worker."""
import functools
import json
import os
import pathlib
import subprocess

import h5py
import pytest

SCRIPTS = pathlib.Path(__file__).resolve().parents[2] / "yade_scripts"


@functools.cache
def forking():
    """The YADE of this worker in whose forks scripts run; it ends with the worker, whose end of the pipe then closes."""
    return subprocess.Popen(["yade", "-n", "-x", str(pathlib.Path(__file__).with_name("forking.py"))], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                            stderr=subprocess.DEVNULL, text=True)


class Yade:
    """Runs scripts by `yade -n -x` in a folder of its own, where results/ then is: in a fork of a YADE that has started, or in one started for
    each."""

    def __init__(self, folder, forks=True):
        self.folder, self.forks = folder, forks

    def script(self, name, *arguments, **environment):
        """Run a script, yade_scripts/<name> or any path, options of YADE's own before it; the finished process."""
        called = [*(a for a in arguments if a.startswith("-j")), str(SCRIPTS / name), *(a for a in arguments if not a.startswith("-j"))]
        if not self.forks:
            return subprocess.run(["yade", "-n", "-x", *called], cwd=self.folder, env=os.environ | environment, stdin=subprocess.DEVNULL,
                                  capture_output=True, text=True, timeout=1200)
        outputs = [self.folder / "stdout.txt", self.folder / "stderr.txt"]
        request = {"arguments": called, "folder": str(self.folder), "environment": environment, "outputs": [str(path) for path in outputs]}
        print(json.dumps(request), file=forking().stdin, flush=True)
        status = next(line for line in forking().stdout if line.startswith("status"))
        return subprocess.CompletedProcess(called, int(status.split()[1]), *(path.read_text() for path in outputs))

    def prepare(self, *arguments):
        """Prepare a packing; its state file and the JSON record beside it."""
        done = self.script("preparing/prepare.py", *arguments)
        assert done.returncode == 0, done.stderr
        name = [line for line in done.stdout.splitlines() if ".yade.gz" in line][-1].split()[0]
        state = self.folder / name
        return state, json.loads(state.with_name(state.name.replace(".yade.gz", ".json")).read_text())

    def code(self, text):
        """Run Python text inside YADE with the repository on the path; the last line printed, read as JSON."""
        path = self.folder / "script.py"
        path.write_text(f"import json, sys\nsys.path.insert(0, {str(SCRIPTS.parent)!r})\n" + text)
        return self.printed(path)

    def printed(self, path, *arguments, **environment):
        """Run a script; the last line printed, read as JSON."""
        done = self.script(path, *arguments, **environment)
        assert done.returncode == 0, done.stderr
        return json.loads([line for line in done.stdout.splitlines() if line.startswith(("{", "["))][-1])

    def run(self, **row):
        """Run a row with 60 disks; its result file, opened."""
        from yade_scripts import parameters, results
        row = {"disks": 60} | row
        done = self.script("run.py", *(f"{name}={value}" for name, value in row.items()))
        path = results.path_of(parameters.complete(row), self.folder / "results")
        assert path.exists(), done.stderr
        return h5py.File(path)

    def load(self, **row):
        """The same; what the reader makes of it."""
        from yade_scripts.results import reader
        with self.run(**row) as file:
            return reader.load(file.filename)


@pytest.fixture(scope="session")
def yade60(tmp_path_factory):
    """YADE in a folder where the packing of 60 disks, seed 1, is prepared."""
    runner = Yade(tmp_path_factory.mktemp("yade"))
    runner.prepare("disks=60")
    return runner


@pytest.fixture
def yade_elsewhere(tmp_path):
    """YADE in an empty folder, started anew for each script."""
    return Yade(tmp_path, forks=False)
