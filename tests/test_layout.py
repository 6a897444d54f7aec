"""Imports go one way and in no circle: yade_scripts imports nothing of analysis, a run of YADE no plotting, and results nothing that runs."""
import ast
import graphlib
import subprocess

import pytest

PACKAGES = ("analysis", "yade_scripts", "cd_engine")  # each imports only those after it
COMPILED = {"cd_engine._yade_plugin", "cd_engine.core._core"}


def imported(path, root):
    """What a file below `root` imports, at any place in it, as a dotted name: a module, or a name in a module."""
    package = path.relative_to(root).parent.parts
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (name.name for name in node.names)
        elif isinstance(node, ast.ImportFrom):
            source = [*package[:len(package) - node.level + 1]] * bool(node.level) + [node.module] * bool(node.module)
            yield from (".".join([*source, name.name]) for name in node.names)


def offenders(root, folder, forbidden):
    """In what a folder holds; what draws pictures is imported when they are drawn."""
    drawing = root / "cd_engine" / "pictures"
    return [f"{path.relative_to(root)} imports {name}" for path in sorted((root / folder).rglob("*.py")) for name in imported(path, root)
            if any(name == other or name.startswith(other + ".") for other in forbidden)
            and not (drawing in path.parents and name.startswith("matplotlib"))]


def arrows(root):
    """{module: the modules that it imports}. To import a module runs the packages in which it lies, too, unless the import comes from inside them."""
    files = [path for package in PACKAGES for path in (root / package).rglob("*.py")]
    files = {".".join(path.relative_to(root).with_suffix("").parts).removesuffix(".__init__"): path for path in files}
    found = {}
    for module, path in files.items():
        found[module] = set()
        for name in imported(path, root):
            while name and name not in files.keys() | COMPILED:
                name = name.rpartition(".")[0]
            parents = {name[:end] for end, letter in enumerate(name) if letter == "."}
            found[module] |= {name} | {parent for parent in parents if not f"{module}.".startswith(f"{parent}.")}
        found[module] -= {"", module}  # others' modules, and scripts that import themselves
    return found


def test_imports_form_no_circle_and_packages_stand_one_above_the_other(root):
    found = arrows(root)
    graphlib.TopologicalSorter(found).prepare()
    rank = lambda module: PACKAGES.index(module.partition(".")[0])
    assert not [(module, other) for module, others in found.items() for other in others if rank(other) < rank(module)]


def test_imports_inside_functions_and_packages_are_seen(tmp_path):
    for name, text in (("__init__", ""), ("one/__init__", "from .two import f"), ("one/two", "def f():\n    import cd_engine.three"),
                       ("three", "from cd_engine.one import two")):
        (tmp_path / "cd_engine" / f"{name}.py").parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "cd_engine" / f"{name}.py").write_text(text)
    assert offenders(tmp_path, "cd_engine", ("cd_engine.three",))
    with pytest.raises(graphlib.CycleError, match="cd_engine.three"):
        graphlib.TopologicalSorter(arrows(tmp_path)).prepare()


@pytest.mark.parametrize("folder, forbidden", [
    ("cd_engine", ("yade_scripts", "analysis", "matplotlib", "tests")),
    ("yade_scripts", ("analysis", "matplotlib", "PIL", "jinja2", "tests")),
    ("yade_scripts/results", ("yade", "yade_scripts.running", "yade_scripts.preparing", "yade_scripts.measuring", "yade_scripts.tables")),
    ("yade_scripts/theory", ("yade", "yade_scripts.running", "yade_scripts.preparing", "yade_scripts.measuring", "yade_scripts.cluster")),
    ("yade_scripts/running", ("yade_scripts.preparing", "yade_scripts.measuring", "yade_scripts.cluster")),
    ("analysis", ("yade", "tests"))])
def test_imports_go_one_way(root, folder, forbidden):
    assert offenders(root, folder, forbidden) == []


def test_a_timed_run_has_no_plotting_in_memory(tmp_path, root):
    """Checked in the process after a run and a measurement. Some releases of YADE import matplotlib at the start, so only new modules count."""
    script = tmp_path / "run.py"
    script.write_text(f"""
import sys
before = {{name for name in sys.modules if name.split(".")[0] in ("matplotlib", "PIL", "analysis")}}
sys.path.insert(0, {str(root)!r})
from yade_scripts import run
from yade_scripts.measuring.charts import measure
assert run.execute(dict(scene="stack", disks=2), {str(tmp_path / "results")!r}) == 0
assert measure.measure(dict(scene="stack", method="CD", disks=2), {str(tmp_path / "results")!r}, 20, lambda seconds: None)[0]["status"] == "finished"
print("new:", sorted({{name for name in sys.modules if name.split(".")[0] in ("matplotlib", "PIL", "analysis")}} - before))
""")
    done = subprocess.run(["yade", "-n", "-x", "-j1", script], cwd=tmp_path, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=1200)
    assert "new: []" in done.stdout, done.stdout + done.stderr
