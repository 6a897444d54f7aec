"""The core's own tests (C++, doctest), built by cd_engine's Makefile; the core knows neither YADE nor Python. tests/soak has them sanitized."""
import subprocess

import pytest


def run(root, build, *options):
    """Build the tests and run them."""
    subprocess.run(["make", "-s", "-C", str(root / "cd_engine"), build], check=True)
    done = subprocess.run([root / "cd_engine" / build, *options], capture_output=True, text=True)
    assert done.returncode == 0 and "Status: SUCCESS" in done.stdout, done.stdout + done.stderr


@pytest.mark.timeout(1800)  # compiling takes a minute on a quiet machine
def test_core(root):
    run(root, "build/core_tests")
