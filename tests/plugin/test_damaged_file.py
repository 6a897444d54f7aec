"""Damaged or invented data of the engine in a file: refused in a sentence or rebuilt, never read past its end."""
import re

import pytest

from . import plane


def saved(O, folder):
    """The text of a scene of three disks in a row that overlap, so that two pairs keep a reference overlap."""
    for k in range(3):
        plane.disk((0.019 * k, 0), 0.01)
    cd = plane.run(1, 1e-3)
    assert cd._referenceIds == [0, 1, 1, 2]
    O.save(str(folder / "scene.xml"))
    return (folder / "scene.xml").read_text()


def load(O, folder, text):
    (folder / "damaged.xml").write_text(text)
    O.load(str(folder / "damaged.xml"))


def with_list(text, name, values):
    """The text with other values in that list."""
    items = "".join(f"<item>{value}</item>" for value in values)
    changed, found = re.subn(rf"(<{name}>\s*<count>)\d+(</count>.*?)(<item>.*?)?(</{name}>)", rf"\g<1>{len(values)}\g<2>{items}\g<4>", text,
                             flags=re.DOTALL)
    assert found == 1
    return changed


DAMAGE = {
    "too few ids": ("referenceIds", [0, 1, 1]),
    "too many overlaps": ("referenceOverlaps", [1e-3] * 50),
    "a negative id": ("referenceIds", [-7, 1, 1, 2]),
    "one body": ("referenceIds", [0, 1, 2, 2]),
    "not in order": ("referenceIds", [1, 2, 0, 1]),
    "an overlap that is no number": ("referenceOverlaps", [1e-3, "nan"]),
    "a negative overlap": ("referenceOverlaps", [-1e-3, 1e-3]),
}


@pytest.mark.parametrize("name", DAMAGE)
def test_overlaps_that_cannot_be_are_refused(O, tmp_path, name):
    text = with_list(saved(O, tmp_path), *DAMAGE[name])
    with pytest.raises(RuntimeError, match="ContactDynamics: the file is damaged: referenceIds must hold the ids of two bodies"):
        load(O, tmp_path, text)


@pytest.mark.parametrize("name, value, words", [
    ("tolerance", "nan", "out of range"), ("searchMargin", "-3", "out of range"), ("restitution", "7", "out of range"),
    ("maxIterations", "0", "out of range"), ("method", "magic", "is not known; there is 'nsgs'"),
    ("publish", "never", "is not known; there is 'due', 'always'"),
])
def test_settings_that_cannot_be_are_refused(O, tmp_path, name, value, words):
    """With a tolerance that is no number the disks of such a scene fell through their floor."""
    text, found = re.subn(f"<{name}>[^<]*</{name}>", f"<{name}>{value}</{name}>", saved(O, tmp_path))
    assert found == 1
    with pytest.raises(RuntimeError, match=f"ContactDynamics: the file is damaged: {name}=.*{words}.*Correct it there"):
        load(O, tmp_path, text)


def test_ids_of_bodies_that_are_not_there_mean_nothing(O, tmp_path):
    load(O, tmp_path, with_list(saved(O, tmp_path), "referenceIds", [0, 1, 1000, 2000]))
    O.run(5, True)
    assert O.engines[-1].steps == 6


def test_emptied_lists_make_the_overlaps_present_count_as_such(O, tmp_path):
    text = with_list(with_list(saved(O, tmp_path), "referenceIds", []), "referenceOverlaps", [])
    load(O, tmp_path, text)
    O.run(1, True)
    assert O.engines[-1].maxPenetration == pytest.approx(1e-3)


def test_fingerprints_of_other_bodies_change_nothing(O, tmp_path):
    load(O, tmp_path, with_list(saved(O, tmp_path), "loadsBeforeTrial", [1] * 99))
    O.run(130, True)
    assert O.engines[-1].converged
