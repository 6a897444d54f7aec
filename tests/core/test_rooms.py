"""The rooms of cd_engine/core: what each may include, as cd_engine/core/README.md lists them."""
import pathlib
import re

ENGINE = pathlib.Path(__file__).parents[2] / "cd_engine"
CORE = ENGINE / "core"
ROOMS = re.findall(r"^\| `([a-z]+)` \|", (CORE / "README.md").read_text(), re.M)


def included(path):
    """The (room, header) that a file includes."""
    return [match.split("/") for match in re.findall(r'^#include "(\w+/[\w.]+)"', path.read_text(), re.M)]


def test_readme_lists_all_rooms():
    assert set(ROOMS) == {path.name for path in CORE.iterdir() if path.is_dir() and path.name != "__pycache__"}
    assert not list(CORE.glob("*.[chi][pn]*")), "a C++ file in no room"


def test_rooms_use_only_rooms_above_them_by_their_faces():
    """And law.inl, which the kernels compile for each instruction set."""
    wrong = [(path.relative_to(CORE), room, header) for path in CORE.glob("*/*") if path.suffix in (".cpp", ".hpp", ".inl")
             for room, header in included(path) if room != path.parent.name
             and (ROOMS.index(room) >= ROOMS.index(path.parent.name) or header not in (f"{room}.hpp", "law.inl"))]
    assert wrong == []


def test_others_include_faces_only():
    outside = [*(ENGINE / "yade_plugin").rglob("*.[ch]pp"), *(ENGINE / "bindings").glob("*.[ch]pp")]
    assert outside and [(path.name, room, header) for path in outside for room, header in included(path) if header != f"{room}.hpp"] == []
