"""Damaged files of every kind are refused in one sentence, or do no harm; see tests/readers.py."""
import pytest

from tests import readers


@pytest.mark.parametrize("name", readers.READERS)
def test_damaged_files(tmp_path, name):
    readers.feed(name, tmp_path, 150)
