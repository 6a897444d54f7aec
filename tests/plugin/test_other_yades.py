"""In a YADE that it does not fit the engine says so, and the process lives on: tested with real binaries and with false claims about them."""
import importlib
import re
import shutil
import subprocess
import sys

import pytest
from yade import config

import cd_engine

from . import programs

# Debian's package yade brings one binary a precision.
OTHERS = ("longdouble", "float128", "mpfr150")
SCRIPT = """\
sys.path.append(sys.path[0] + "/cd_engine")

def refused(name, load):
    try:
        load()
    except ImportError as error:
        print(name, "refused:", error)
    else:
        print(name, "loaded")

def direct():
    import _yade_plugin

def engine():
    import cd_engine
    cd_engine.ContactDynamics

refused("engine", engine)
refused("the compiled module alone", direct)
from yade_scripts import run
from yade_scripts.preparing import prepare
for method in ("MD", "CD"):
    print(method, "status", run.main(["scene=bounce", "method=" + method, "--results=results"]))
print("packing status", prepare.main(["disks=20"]))
O.bodies.append(utils.sphere((0, 0, 0), 1))
O.step()
print("alive after step", O.iter)
"""


@pytest.mark.parametrize("precision", OTHERS)
def test_another_precision_refuses_every_way_in(precision, tmp_path):
    """The engine by its package and by its compiled file, runs by either method, a packing: each one sentence, no result, no crash."""
    if shutil.which(f"yade-{precision}") is None:
        pytest.skip(f"yade-{precision} is not installed here")
    done = programs.in_yade(tmp_path, SCRIPT, f"yade-{precision}")
    said = done.stdout + done.stderr
    assert done.returncode == 0, said
    assert "engine refused: cd_engine computes in double precision; this is YADE " in said and "Start `yade`" in said
    assert "the compiled module alone refused: " in said and "loaded" not in said
    assert all(f"{what} status 2" in said for what in ("MD", "CD", "packing")) and said.count("computes in double precision") == 4, said
    assert "alive after step 1" in said
    assert "run.py\", line" not in said  # no traceback of ours
    assert not list(tmp_path.glob("results/**/*.h5")) + list(tmp_path.glob("results/**/*.gz"))


@pytest.fixture
def forgotten(monkeypatch):
    """Compiled module of cd_engine that is not loaded yet as far as Python knows."""
    for name in [name for name in sys.modules if name.endswith("._yade_plugin")]:
        monkeypatch.delitem(sys.modules, name)


def test_what_yade_says_of_its_precision_decides_and_not_its_folder(forgotten, monkeypatch):
    """A YADE that somebody has built lies in a folder of any name."""
    monkeypatch.setattr(config, "libDir", "/opt/yade")
    cd_engine.ContactDynamics
    monkeypatch.setattr(config, "highPrecisionName", "PrecisionFloat")
    monkeypatch.delitem(sys.modules, "cd_engine._yade_plugin")
    with pytest.raises(ImportError, match="computes in double precision.* /opt/yade"):
        cd_engine.ContactDynamics


UNTESTED = """\
from yade import config
config.version = {version!r} or config.version
import cd_engine
cd_engine.ContactDynamics
O.engines = cd_engine.engines()
O.dt = 1e-3
O.step()
cd_engine.release()
print("steps", O.iter)
"""


@pytest.mark.parametrize("version", ["2099.1", ""])
def test_an_untested_version_that_fits_runs_and_says_so_once(version, tmp_path):
    done = programs.in_yade(tmp_path, UNTESTED.format(version=version))
    assert done.returncode == 0 and "steps 1" in done.stdout, done.stderr
    running = version or config.version
    assert done.stderr.count(f"nobody has tested it with YADE {running},") == (running not in cd_engine.TESTED), done.stderr
    if version:
        assert all(f"{tested} (Debian {debian})" in done.stderr for tested, debian in cd_engine.TESTED.items())


def test_a_module_that_does_not_load_says_what_to_do(forgotten, monkeypatch):
    """After an upgrade of Debian, or in a YADE without a function that is called: what the loader says, and the remedy."""
    def load(name):
        raise ImportError("undefined symbol: _ZN4yade5Omega5otherEv", name=name, path="_yade_plugin.so")
    monkeypatch.setattr(importlib, "import_module", load)
    with pytest.raises(ImportError, match="does not load into YADE .*_ZN4yade5Omega5otherEv.*make build"):
        cd_engine.ContactDynamics


def test_two_boosts_in_one_process_are_refused(tmp_path):
    """A plug-in built with another Boost than YADE would register its engines where YADE never looks."""
    other = tmp_path / "libboost_python00.so.1.0"
    subprocess.run(["g++", "-shared", "-x", "c++", "-o", str(other), "-"], input="", text=True, check=True)
    done = programs.in_yade(tmp_path, f"import ctypes\nctypes.CDLL({str(other)!r})\nimport cd_engine\n"
                            "try:\n    cd_engine.ContactDynamics\nexcept ImportError as error:\n    print('refused:', error)\n")
    assert re.search("refused: .*libboost_python: expected one .* and libboost_python00.so.1.0|refused: .*found libboost_python00.so.1.0 and ",
                     done.stdout), done.stdout + done.stderr


def test_tested_versions_stand_in_the_readme(root):
    text = (root / "README.md").read_text()
    assert all(re.search(rf"^\| {debian}\b.*\| {re.escape(version)} \|", text, re.M) for version, debian in cd_engine.TESTED.items())
