"""The README's two commands do all the set-up on each release of Debian that the engine was tested on, from a clean clone."""
import os
import shutil
import subprocess

import pytest

import cd_engine


@pytest.mark.timeout(5400)
@pytest.mark.parametrize("release", cd_engine.TESTED.values())
def test_two_commands_on_a_fresh_debian(root, release):
    """Of the last commit. What the commands print is printed, with the counts of passed and skipped tests."""
    if os.geteuid() != 0:
        pytest.skip("needs root, to install a Debian into a folder")
    if shutil.which("debootstrap") is None:
        pytest.skip("debootstrap is not installed: .ci/install-packages soak")
    done = subprocess.run([root / ".ci" / "clean-root", release], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True)
    print(done.stdout)
    assert done.returncode == 0 and f"both commands did all the set-up of {release}" in done.stdout
    assert " passed" in done.stdout and " failed" not in done.stdout
