"""Every dependency is a package of Debian, named once in .debian-packages with its reason; .ci/clean-root proves that they are enough."""
import ast
import functools
import glob
import importlib.util
import os
import pathlib
import re
import shutil
import subprocess
import sys

import pytest

from tests.test_layout import imported

ROOT = pathlib.Path(__file__).resolve().parents[1]
PURPOSES = ("run", "test", "soak", "lint")
OURS = {"analysis", "cd_engine", "tests", "yade_scripts", "_yade_plugin", "tumbler"}
# Need more than `make deps` installs: the targets that run the first two install the packages of the tests first, and a cluster has its Slurm.
TESTED_WITH = ("tests", "yade_scripts/measuring/benchmark", "yade_scripts/cluster")


def listed():
    """[(package, purpose, reason)] as the file has them."""
    lines = [line.split(None, 2) for line in (ROOT / ".debian-packages").read_text().splitlines() if line.strip() and line[0] != "#"]
    assert all(len(line) == 3 for line in lines), "a package without purpose or reason"
    return lines


def sources():
    """The Python files that git knows."""
    names = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "*.py"], cwd=ROOT, capture_output=True, text=True,
                           check=True).stdout.split()
    return [name for name in names if (ROOT / name).exists()]


def executed(tree):
    """Programs that a file starts by a name written there: the first of a list that goes to subprocess, and names asked of shutil.which."""
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Attribute) or not node.args:
            continue
        first = node.args[0]
        if node.func.attr in ("run", "Popen", "check_output") and isinstance(first, ast.List) and first.elts:
            first = first.elts[0]
        elif node.func.attr != "which":
            continue
        if isinstance(first, ast.Constant):
            yield first.value


@functools.lru_cache(None)
def installed():
    """{package: (its source package, whether it is in every Debian)} of this machine."""
    form = "${Package}|${source:Package}|${Essential}|${Priority}\n"
    rows = (line.split("|") for line in subprocess.run(["dpkg-query", "-W", "-f", form], capture_output=True, text=True,
                                                       check=True).stdout.splitlines())
    return {name: (source, essential == "yes" or priority == "required") for name, source, essential, priority in rows}


def owners(paths):
    """{path: package}; files that no package of Debian brought are missing."""
    said = subprocess.run(["dpkg-query", "-S", *sorted(paths)], capture_output=True, text=True).stdout
    return {path: packages.split(":")[0] for packages, _, path in (line.partition(": ") for line in said.splitlines())}


def missing(uses):
    """Of [(file, name, path)] those whose path is of no package that is listed for the file's purpose nor in every Debian."""
    owner, sources = owners({path for _, _, path in uses}), installed()
    listed_for = {purposes: [name for name, purpose, _ in listed() if purpose in purposes] for purposes in (PURPOSES, ("run",))}

    def named(file, path):
        names = listed_for[PURPOSES if file.startswith(TESTED_WITH) else ("run",)]
        source, everywhere = sources.get(owner.get(path), (None, False))
        # One source makes several packages, of which the one is named that brings the others: yade, python3-dev.
        return everywhere or source is not None and (owner[path] in names or source in {sources[name][0] for name in names if name in sources})

    return [(file, name) for file, name, path in uses if not named(file, path)]


def test_each_package_is_named_once_with_its_reason():
    packages = listed()
    names = [name for name, _, _ in packages]
    assert sorted(names) == sorted(set(names))
    assert all(purpose in PURPOSES for _, purpose, _ in packages)


def test_imports_come_from_these_packages():
    uses, absent = [], {name for name, _, _ in listed()} - set(installed())
    for file in sources():
        for name in {name.partition(".")[0] for name in imported(ROOT / file, ROOT)} - OURS - sys.stdlib_module_names:
            found = importlib.util.find_spec(name)
            if found is None and f"python3-{name}" in absent:  # this release has no such package
                continue
            uses.append((file, name, found.origin if found else "not there"))
    assert len(uses) > 20
    assert missing(uses) == []


def test_programs_come_from_these_packages():
    uses = []
    for file in sources():
        for name in set(executed(ast.parse((ROOT / file).read_text()))):
            uses.append((file, name, shutil.which(name, path="/usr/sbin:/usr/bin")))
    assert len({name for _, name, _ in uses}) > 5
    assert missing([use for use in uses if use[2] is not None]) == []  # a file that is not installed has no known package


# What the programs say that .ci/install-packages asks: nothing is installed, apt offers all but {lacking}.
STUBS = {"dpkg-query": "exit 1", "id": "echo 0",
         "apt-cache": 'shift; for name; do case " {lacking} " in *" $name "*) ;; *) echo "$name | 1 | source" ;; esac; done',
         "apt-get": 'echo "$*" >> {log}; case "$* " in *" yade "*) [ "{lacking}" != yade ] ;; esac'}


@pytest.mark.parametrize("lacking, status, left_out", [("", 0, []), ("python3-siconos libfclib0", 0, ["python3-siconos", "libfclib0"]),
                                                       ("yade", 1, [])])
def test_what_a_release_does_not_package_is_left_out_unless_it_is_needed_to_run(tmp_path, lacking, status, left_out):
    log = tmp_path / "log"
    for name, text in STUBS.items():
        program = tmp_path / name
        program.write_text("#!/bin/sh\n" + text.replace("{lacking}", lacking).replace("{log}", str(log)) + "\n")
        program.chmod(0o755)
    done = subprocess.run([ROOT / ".ci" / "install-packages", "run", "test"], env={"PATH": f"{tmp_path}:/usr/bin:/bin"}, capture_output=True,
                          text=True)
    assert done.returncode == status, done.stderr
    assert [line.split()[5][:-1] for line in done.stdout.splitlines() if line.endswith("what needs it is left out.")] == left_out
    assert log.read_text().splitlines()[0] == "-y update"
    asked = log.read_text().splitlines()[1].split()
    assert asked[:3] == ["-y", "install", "--no-install-recommends"]
    assert sorted(asked[3:]) == sorted(name for name, purpose, _ in listed() if purpose in ("run", "test") and name not in left_out)
    assert status == 0 or "apt-get failed" in done.stderr


def test_the_engine_is_linked_to_the_boost_of_yade_and_of_this_python():
    """No library is spelled out with its version: the build finds the Boost.Python of the Python it is given."""
    def boost(library):
        said = subprocess.run(["readelf", "-dW", library], capture_output=True, text=True, check=True).stdout
        return {name for name in re.findall(r"NEEDED.*\[(.*)\]", said) if name.startswith(("libboost_python", "libboost_serialization"))}
    yade, = glob.glob("/usr/lib/*/yade-double/libpkg_common.so")
    plugin = boost(ROOT / "cd_engine" / "_yade_plugin.so")
    assert plugin and plugin <= boost(yade)
    python, = boost(ROOT / "cd_engine" / "core" / "_core.so")
    assert python in plugin and python.startswith("libboost_python{}{}.so.".format(*sys.version_info))


def test_objects_made_with_other_tools_are_made_anew(tmp_path):
    """After an upgrade of Debian a build starts over. File times cannot decide this, since the system's files may be older than ours."""
    def up_to_date():
        return subprocess.run(["make", "-q", "-C", tmp_path / "cd_engine", f"PYTHON={sys.executable}"], capture_output=True).returncode == 0
    # Times of change are copied, too; not what another test may be building now.
    shutil.copytree(ROOT / "cd_engine", tmp_path / "cd_engine", ignore=shutil.ignore_patterns("sanitized", "core_tests*", "tests"))
    assert up_to_date()
    (tmp_path / "cd_engine" / "build" / "tools").write_text("g++ 1 Python 1 BOOST 1\n")
    assert not up_to_date()


def test_all_processors_are_used_whatever_make_hands_on():
    """GNU make 4.4 gives its exported variables to the programs it asks, too, and nproc takes OMP_NUM_THREADS for the number of processors."""
    said = subprocess.run(["make", "-n", "study"], cwd=ROOT, env=os.environ | {"OMP_NUM_THREADS": "1"}, capture_output=True, text=True,
                          check=True).stdout
    assert f"--jobs {len(os.sched_getaffinity(0))}\n" in said
