"""The core's own tests (C++, doctest), built by cd_engine's Makefile; the core knows neither YADE nor Python. tests/soak has them sanitized."""
import subprocess

import pytest


def run(root, build, *options):
    """Build the tests and run them."""
    subprocess.run(["make", "-s", "-C", str(root / "cd_engine"), build], check=True)
    program = root / "cd_engine" / "build" / {"core_tests": "core_tests", "sanitized": "core_tests_sanitized",
                                              "threaded_core": "core_tests_threaded"}[build]
    done = subprocess.run([str(program), *options], capture_output=True, text=True)
    assert done.returncode == 0 and "Status: SUCCESS" in done.stdout, done.stdout + done.stderr


@pytest.mark.timeout(1800)  # compiling takes a minute on a quiet machine
def test_core(root):
    run(root, "core_tests")
