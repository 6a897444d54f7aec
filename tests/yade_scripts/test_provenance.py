"""Which commit a result says it is of."""
import importlib.util
import shutil
import subprocess

from yade_scripts.results import provenance


def test_a_scene_that_git_does_not_know_is_another_code(tmp_path):
    """Scenes, studies and maps are found by their presence, so that a new one changes what runs; a table of one's own does not."""
    place = tmp_path / "yade_scripts" / "results"
    place.mkdir(parents=True)
    shutil.copy(provenance.__file__, place / "provenance.py")

    def commit():
        spec = importlib.util.spec_from_file_location("copied", place / "provenance.py")
        copied = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(copied)
        return copied.git_commit()

    def git(*arguments):
        subprocess.run(["git", "-c", "user.name=a", "-c", "user.email=a@b", *arguments], cwd=tmp_path, check=True, capture_output=True)

    git("init")
    git("add", ".")
    git("commit", "-m", "one")
    clean = commit()
    assert len(clean) == 40
    (tmp_path / "table.txt").write_text("seed\n1\n")
    (tmp_path / "own.py").write_text("")
    assert commit() == clean
    (tmp_path / "yade_scripts" / "scenes").mkdir()
    (tmp_path / "yade_scripts" / "scenes" / "own.py").write_text("")
    assert commit() == f"{clean}-dirty"
