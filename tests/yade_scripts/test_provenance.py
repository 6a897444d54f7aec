"""Which commit a result says it is of."""
import importlib.util
import pathlib
import shutil
import subprocess

import pytest

from yade_scripts.results import provenance


class Tree:
    """A repository of its own with the code that names the commit."""

    def __init__(self, folder):
        self.folder, self.code = folder, folder / "yade_scripts" / "results" / "provenance.py"
        self.write("yade_scripts/results/provenance.py", pathlib.Path(provenance.__file__).read_text(encoding="utf-8"))
        self.write(".gitignore", "*.so\nbuild/\n")
        self.git("init")

    def git(self, *arguments):
        subprocess.run(["git", "-c", "user.name=a", "-c", "user.email=a@b", *arguments], cwd=self.folder, check=True, capture_output=True)

    def write(self, name, text=""):
        (self.folder / name).parent.mkdir(parents=True, exist_ok=True)
        (self.folder / name).write_text(text)

    def commit(self):
        self.git("add", ".")
        self.git("commit", "-m", "one")

    def named(self):
        """The commit that a result would name."""
        spec = importlib.util.spec_from_file_location("copied", self.code)
        copied = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(copied)
        return copied.git_commit()


@pytest.fixture
def tree(tmp_path):
    return Tree(tmp_path)


def test_a_scene_that_git_does_not_know_is_another_code(tree):
    """Scenes, studies and maps are found by their presence, so that a new one changes what runs; a table of one's own does not."""
    assert tree.named() == "unknown"
    tree.commit()
    clean = tree.named()
    assert len(clean) == 40
    tree.write("table.txt", "seed\n1\n")
    tree.write("own.py")
    assert tree.named() == clean
    tree.write("yade_scripts/scenes/own.py")
    assert tree.named() == f"{clean}-dirty"


def test_an_engine_that_was_built_of_other_sources_is_another_code(tree, root):
    """Never built, or not since the last commit."""
    tree.write("cd_engine/core/solvers/nsgs.cpp", "one\n")
    shutil.copy(root / "cd_engine" / "Makefile", tree.folder / "cd_engine")
    up_to_date = [word for library in ("_yade_plugin.so", "core/_core.so") for word in ("-o", library)]  # so that nothing is compiled
    for source in ("one\n", "two\n"):
        tree.write("cd_engine/core/solvers/nsgs.cpp", source)
        tree.commit()
        assert tree.named()[40:] == "-dirty"
        subprocess.run(["make", "-C", tree.folder / "cd_engine", *up_to_date], check=True, capture_output=True)
        assert len(tree.named()) == 40
