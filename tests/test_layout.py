"""Imports go one way: yade_scripts imports nothing of analysis, a run of YADE no plotting, and results nothing that runs."""
import ast
import subprocess

import pytest


def imported(path):
    """The modules that a file imports, at any place in it."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (name.name for name in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level:
            yield node.module
            yield from (f"{node.module}.{name.name}" for name in node.names)


def offenders(root, folder, forbidden):
    return [f"{path.relative_to(root)} imports {name}" for path in sorted((root / folder).rglob("*.py")) for name in imported(path)
            if any(name == other or name.startswith(other + ".") for other in forbidden)]


@pytest.mark.parametrize("folder, forbidden", [
    ("cd_engine", ("yade_scripts", "analysis", "matplotlib", "tests")),
    ("yade_scripts", ("analysis", "matplotlib", "PIL", "jinja2", "tests")),
    ("yade_scripts/results", ("yade", "yade_scripts.running", "yade_scripts.preparing", "yade_scripts.measuring", "yade_scripts.tables")),
    ("yade_scripts/theory", ("yade", "yade_scripts.running", "yade_scripts.preparing", "yade_scripts.measuring", "yade_scripts.cluster")),
    ("yade_scripts/running", ("yade_scripts.preparing", "yade_scripts.measuring", "yade_scripts.cluster")),
    ("analysis", ("yade", "tests"))])
def test_imports_go_one_way(root, folder, forbidden):
    assert offenders(root, folder, forbidden) == []


def test_the_check_sees_what_is_imported_inside_a_function(root, tmp_path):
    (tmp_path / "x").mkdir()
    (tmp_path / "x" / "a.py").write_text("def f():\n    from analysis.charts import maps\n")
    assert offenders(tmp_path, "x", ("analysis",))


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
