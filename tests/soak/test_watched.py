"""The plug-in in YADE with every memory access checked: by the compiler's sanitizers in its tests, by valgrind in a run."""
import collections
import os
import pathlib
import shutil
import subprocess
import sys
import xml.etree.ElementTree

import pytest

from tests.core import test_core

HERE = pathlib.Path(__file__).parent
PLUGIN = "_yade_plugin.so"
RUN = """
import glob, math, sys
sys.path[:0] = [{root!r}, *glob.glob("/usr/lib/*/yade-double/py")]
import yade
from tests.plugin import tumbler
engine = tumbler.build(30)
for k in range(6):
    yade.O.run(40, True)
    engine.gravity = (9.81 * math.sin(k), -9.81 * math.cos(k), 0)
for method in ("newton", "accelerated", "nsgs"):
    engine.method = method
    yade.O.run(20, True)
assert engine.contacts > 20
yade.O.save({folder!r} + "/state.yade.gz")
yade.O.load({folder!r} + "/state.yade.gz")
yade.O.run(20, True)
print("steps", yade.O.iter)
"""


def library(name):
    """The compiler's own library of that name."""
    return subprocess.run(["g++", f"-print-file-name={name}"], capture_output=True, text=True, check=True).stdout.strip()


def watched_copy(root, folder, kind):
    """A copy of the repository whose plug-in is built with this sanitizer."""
    subprocess.run(["make", "-s", "-C", str(root / "cd_engine"), f"build/{kind}/{PLUGIN}"], check=True)
    copy = folder / "copy"
    names = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=root, capture_output=True, text=True, check=True).stdout.splitlines()
    for name in (name for name in names if (root / name).is_file()):
        (copy / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(root / name, copy / name)
    shutil.copy2(root / "cd_engine" / "core" / "_core.so", copy / "cd_engine" / "core")
    shutil.copy2(root / "cd_engine" / "build" / kind / PLUGIN, copy / "cd_engine")
    return copy


@pytest.mark.timeout(3600)
def test_core_s_tests_with_address_and_undefined_behaviour_sanitizers(root):
    """The first fault ends them."""
    test_core.run(root, "build/sanitized/core_tests")


@pytest.mark.timeout(3600)
def test_threads_of_a_step_with_the_thread_sanitizer(root):
    """The core's own tests of threads; any fault found makes the exit status one of failure."""
    test_core.run(root, "build/threaded/core_tests", "--source-file=*test_threads*")


@pytest.mark.timeout(3600)
def test_plugin_s_tests_with_address_and_undefined_behaviour_sanitizers(root, tmp_path):
    """All of tests/plugin in a copy of the repository whose plug-in is the watched one. The first fault ends the process that made it.

    The C++ library is loaded ahead too, since the sanitizer finds its exceptions there. Leaks are not looked for: YADE's and Python's objects
    live to the end of the process (test_memory looks at what grows).
    """
    copy = watched_copy(root, tmp_path, "sanitized")
    preloaded = ":".join(map(library, ("libasan.so", "libubsan.so", "libstdc++.so")))
    options = f"detect_leaks=0:suppressions={HERE / 'sanitizers.txt'}:log_path={tmp_path / 'fault'}"
    # Those left out preload a library of their own or build it anew.
    done = subprocess.run([sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "tests/plugin", "--ignore", "tests/plugin/test_memory.py"],
                          cwd=copy,
                          env=os.environ | {"LD_PRELOAD": preloaded, "ASAN_OPTIONS": options,
                                            "UBSAN_OPTIONS": f"print_stacktrace=1:log_path={tmp_path / 'fault'}"},
                          capture_output=True, text=True)
    faults = [path.read_text() for path in tmp_path.glob("fault*")]
    assert not faults, faults[0]
    assert done.returncode == 0 and " passed" in done.stdout, done.stdout[-3000:]


@pytest.mark.timeout(3600)
def test_runs_in_the_background_with_the_thread_sanitizer(root, tmp_path):
    """What tests/plugin/test_background.py does: an export must not meet a step, nor a reader of attributes one that writes them."""
    copy = watched_copy(root, tmp_path, "threaded")
    options = f"ignore_noninstrumented_modules=1:exitcode=0:log_path={tmp_path / 'fault'}"
    done = subprocess.run([sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "tests/plugin/test_background.py"], cwd=copy,
                          env=os.environ | {"LD_PRELOAD": library("libtsan.so"), "TSAN_OPTIONS": options, "OMP_NUM_THREADS": "1"},
                          capture_output=True, text=True)
    faults = [fault for path in tmp_path.glob("fault*") for fault in path.read_text().split("==================") if PLUGIN in fault]
    assert b"__tsan_read8" in (copy / "cd_engine" / PLUGIN).read_bytes()  # asks the sanitizer at every access: without it, it would not load
    assert done.returncode == 0 and " passed" in done.stdout, done.stdout[-3000:] + done.stderr[-3000:]
    assert not faults, faults[0]


@pytest.mark.timeout(3600)
def test_valgrind_finds_nothing_of_ours(root, tmp_path):
    """Runs every solver, saving and loading. Valgrind reports invalid reads and writes, uninitialized values and leaks. A finding in Python or a
    library counts if a function of the plug-in is among its callers; one kind is expected, see valgrind.txt."""
    if shutil.which("valgrind") is None:
        pytest.skip("valgrind is not installed: .ci/install-packages soak")
    report = tmp_path / "report.xml"
    done = subprocess.run(["valgrind", "--error-limit=no", "--num-callers=40", "--leak-check=full", "--show-leak-kinds=definite",
                           f"--suppressions={HERE / 'valgrind.txt'}",
                           "--xml=yes", f"--xml-file={report}", sys.executable, "-c", RUN.format(root=str(root), folder=str(tmp_path))],
                          env=os.environ | {"PYTHONMALLOC": "malloc", "OMP_NUM_THREADS": "1"}, capture_output=True, text=True)
    assert done.returncode == 0 and "steps 320" in done.stdout, done.stderr[-3000:]
    ours, kinds = [], collections.Counter()
    for error in xml.etree.ElementTree.parse(report).getroot().iter("error"):
        kinds[error.findtext("kind")] += 1
        frames = error.find("stack").findall("frame")
        if any((frame.findtext("obj") or "").endswith(PLUGIN) for frame in frames):
            ours.append(error.findtext("kind") + ": " + " < ".join(frame.findtext("fn") or "?" for frame in frames[:12]))
    print(sum(kinds.values()), "findings,", len(ours), "with the plug-in among the callers")
    assert sum(kinds.values()) > 10  # Python alone causes a hundred, so the run was really checked
    assert ours == []
