"""Makes YADE importable in Debian's Python and gives every test an empty scene."""
import glob
import os
import pathlib
import sys

import pytest

from tests import waking

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))
for folder in glob.glob("/usr/lib/*/yade-double/py"):
    sys.path.append(folder)
# One thread: the tests run beside each other on few cores.
os.environ.setdefault("OMP_NUM_THREADS", "1")


@pytest.fixture
def O():
    """YADE's Omega with an empty scene, before and after the test."""
    import yade
    waking.often(type(yade.O))
    yade.O.reset()
    yield yade.O
    yade.O.reset()


@pytest.fixture(scope="session")
def root():
    """Top of the repository."""
    return ROOT
