"""The core's own tests (C++, doctest), built by cd_engine's Makefile; the core knows neither YADE nor Python."""
import subprocess


def test_core(root):
    subprocess.run(["make", "-s", "-C", str(root / "cd_engine"), "core_tests"], check=True)
    done = subprocess.run([str(root / "cd_engine" / "build" / "core_tests")], capture_output=True, text=True)
    assert done.returncode == 0 and "Status: SUCCESS" in done.stdout, done.stdout
