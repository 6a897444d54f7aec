"""Feeds the readers of tests/analysis/test_readers.py with thousands of files."""
import pytest

from tests import readers

COUNT = 2000


@pytest.mark.timeout(3600)
@pytest.mark.parametrize("name", readers.READERS)
def test_damaged_files(tmp_path, name):
    print(f"{name}: {readers.feed(name, tmp_path, COUNT)} of {COUNT} refused, the others read")
