"""In another YADE than the one it is written for the engine says so, and the process lives on: the real binaries, and claims about versions."""
import shutil
import subprocess

import pytest

# Debian's package yade brings one binary a precision.
OTHERS = ("longdouble", "float128", "mpfr150")
SCRIPT = """\
import runpy, sys
sys.path[:0] = [{root!r}, {root!r} + "/cd_engine"]

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
from yade_scripts import prepare, run
for method in ("MD", "CD"):
    print(method, "status", run.main(["scene=bounce", "method=" + method, "--results=results"]))
print("packing status", prepare.main(["disks=20"]))
O.bodies.append(utils.sphere((0, 0, 0), 1))
O.step()
print("alive after step", O.iter)
"""


@pytest.mark.parametrize("precision", OTHERS)
def test_another_precision_refuses_every_way_in(precision, root, tmp_path):
    """The engine by its package and by its compiled file, runs by either method, a packing: each one sentence, no result, no crash."""
    if shutil.which(f"yade-{precision}") is None:
        pytest.skip(f"yade-{precision} is not installed here")
    script = tmp_path / "script.py"
    script.write_text(SCRIPT.format(root=str(root)))
    done = subprocess.run([f"yade-{precision}", "-n", "-x", str(script)], cwd=tmp_path, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=200)
    said = done.stdout + done.stderr
    assert done.returncode == 0, said
    assert "engine refused: cd_engine is written for YADE 2023.02a in double precision" in said and "Start `yade`" in said
    assert "the compiled module alone refused: " in said and "loaded" not in said
    assert all(f"{what} status 2" in said for what in ("MD", "CD", "packing")) and said.count("of YADE in double precision") == 3, said
    assert "alive after step 1" in said
    assert "run.py\", line" not in said  # no traceback of ours
    assert not list(tmp_path.glob("results/**/*.h5")) + list(tmp_path.glob("results/**/*.gz"))


@pytest.mark.parametrize("attribute, value", [("version", "2022.01a"), ("version", "2025.2.0"), ("libDir", "/usr/lib/x86_64-linux-gnu/yade-float128")])
def test_another_version_is_named(monkeypatch, attribute, value):
    """What the binary of another Debian says of itself; the module is already loaded in this process, so it must be forgotten first."""
    import sys

    import yade
    assert yade.O is not None
    import cd_engine
    for name in [name for name in sys.modules if name.endswith("._yade_plugin")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setattr(yade.config, attribute, value)
    with pytest.raises(ImportError, match="written for YADE 2023.02a in double precision") as caught:
        cd_engine.ContactDynamics
    assert value in str(caught.value)
