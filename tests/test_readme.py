"""README: it is short, its script runs as printed, and the files that it names exist."""
import re
import subprocess


def test_readme_is_short_and_shows_a_picture_first(root):
    lines = (root / "README.md").read_text(encoding="utf-8").splitlines()
    assert len(lines) <= 150
    assert next(number for number, line in enumerate(lines) if line.startswith("![")) < 15


def test_the_minimal_script_runs(root, tmp_path):
    """As a user saves it; the module path stands in for `make install`."""
    script = re.search(r"```python\n(.*?)```", (root / "README.md").read_text(encoding="utf-8"), re.S)[1]
    (tmp_path / "heap.py").write_text(f"import sys\nsys.path.insert(0, {str(root)!r})\n" + script)
    done = subprocess.run(["yade", "-n", "-x", "-j1", "heap.py"], cwd=tmp_path, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          timeout=1200)
    converged, contacts, unbalanced = done.stdout.strip().splitlines()[-1].split()
    assert converged == "True" and int(contacts) > 100 and float(unbalanced) < 1, done.stdout + done.stderr


def test_paths_and_targets_that_are_named_exist(root):
    makefile = (root / "Makefile").read_text()
    for readme in [*root.glob("README.md"), *root.glob("*/README.md"), *root.glob("*/*/README.md")]:
        text = readme.read_text(encoding="utf-8")
        for target in re.findall(r"\bmake ([a-z]+)", text):
            assert re.search(rf"^{target}:", makefile, re.M) or target in ("sure", "it"), (readme, target)
        folders = ("tests|analysis|yade_scripts|cd_engine|measuring|scenes|core|running|results|studies|charts|published|cluster|theory|preparing|"
                   "tables")
        for path in re.findall(rf"`((?:{folders})/[\w/.]*)`", text):
            assert (root / path).exists() or (readme.parent / path).exists() or path.startswith("results/"), (readme, path)
        for path in re.findall(r"\]\(([^)#:]+)\)", text):
            assert (readme.parent / path).exists(), (readme, path)
