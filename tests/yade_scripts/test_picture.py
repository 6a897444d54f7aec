"""yade_scripts/picture.py: the picture and the film of a scene."""
import pytest
from PIL import Image

from .conftest import Yade


def test_a_row_of_a_table(tmp_path):
    (tmp_path / "table.txt").write_text("scene disks method\nstack 2 CD\n")
    done = Yade(tmp_path).script("picture.py", YADE_BATCH=f"{tmp_path / 'table.txt'}:2")
    assert done.returncode == 0 and [path.name[:9] for path in (tmp_path / "results").iterdir()] == ["stack-CD-"], done.stderr


@pytest.mark.parametrize("method", ["MD", "CD"])
def test_picture_and_film_of_a_scene(tmp_path, method):
    done = Yade(tmp_path).script("picture.py", "scene=stack", "disks=2", f"method={method}", "--film=0.02", "--results=there")
    picture, film = (tmp_path / line for line in done.stdout.split()[-2:])
    assert done.returncode == 0 and picture.stem == film.stem and picture.name.startswith(f"stack-{method}-"), done.stderr
    with Image.open(picture) as one, Image.open(film) as other:
        assert one.format == "PNG" and other.format == "GIF" and other.n_frames > 3
    assert sorted(path.suffix for path in (tmp_path / "there").iterdir()) == [".gif", ".png"]
