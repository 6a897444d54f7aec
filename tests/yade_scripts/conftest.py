"""Runs of YADE in processes of their own, and one prepared packing of 60 disks for all tests of a worker."""
import json
import os
import pathlib
import subprocess

import h5py
import pytest

SCRIPTS = pathlib.Path(__file__).resolve().parents[2] / "yade_scripts"


class Yade:
    """Starts scripts by `yade -n -x` in a folder of its own, where results/ then is."""

    def __init__(self, folder):
        self.folder = folder

    def script(self, name, *arguments, **environment):
        """Run yade_scripts/<name>; the finished process."""
        return subprocess.run(["yade", "-n", "-x", str(SCRIPTS / name), *arguments], cwd=self.folder, env=os.environ | environment,
                              stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=1200)

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
        """Run a script, options of YADE's first among the arguments; the last line printed, read as JSON."""
        options = [a for a in arguments if a.startswith("-")]
        done = subprocess.run(["yade", "-n", "-x", *options, str(path), *(a for a in arguments if a not in options)], cwd=self.folder,
                              env=os.environ | environment, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=1200)
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


@pytest.fixture(scope="session")
def yade60(tmp_path_factory):
    """YADE in a folder where the packing of 60 disks, seed 1, is prepared."""
    runner = Yade(tmp_path_factory.mktemp("yade"))
    runner.prepare("disks=60")
    return runner


@pytest.fixture
def yade_elsewhere(tmp_path):
    """YADE in an empty folder."""
    return Yade(tmp_path)
