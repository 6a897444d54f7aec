"""Every dependency is a package of Debian 12, named once in .debian-packages with its reason; .ci/clean-root proves that they are enough."""
import ast
import functools
import importlib.util
import pathlib
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
PURPOSES = ("run", "test", "soak", "lint")
OURS = {"analysis", "cd_engine", "tests", "yade_scripts", "_yade_plugin", "tumbler"}
# Need more than `make deps` installs: the targets that run the first two install the packages of the tests first, and a cluster has its Slurm.
TESTED_WITH = ("tests", "yade_scripts/benchmark", "yade_scripts/cluster")


def listed():
    """[(package, purpose, reason)] as the file has them."""
    lines = [line.split(None, 2) for line in (ROOT / ".debian-packages").read_text().splitlines() if line.strip() and line[0] != "#"]
    assert all(len(line) == 3 for line in lines), "a package without purpose or reason"
    return lines


def sources():
    """The Python files that git knows."""
    names = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "*.py"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split()
    return [name for name in names if (ROOT / name).exists()]


def imported(tree):
    """Top-level names of the modules that a file imports from elsewhere than itself."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name.partition(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            yield node.module.partition(".")[0]


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
    rows = (line.split("|") for line in subprocess.run(["dpkg-query", "-W", "-f", form], capture_output=True, text=True, check=True).stdout.splitlines())
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
    uses = []
    for file in sources():
        for name in set(imported(ast.parse((ROOT / file).read_text()))) - OURS - sys.stdlib_module_names:
            found = importlib.util.find_spec(name)
            uses.append((file, name, found.origin if found else "not there"))
    assert len(uses) > 20
    assert missing(uses) == []


def test_programs_come_from_these_packages():
    uses = []
    for file in sources():
        for name in set(executed(ast.parse((ROOT / file).read_text()))):
            uses.append((file, name, shutil.which(name, path="/usr/sbin:/usr/bin")))
    assert len({name for _, name, _ in uses}) > 5
    assert missing([use for use in uses if use[2] is not None]) == []  # what is not here cannot be asked for its package
