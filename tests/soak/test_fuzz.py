"""Hundreds of random scenes under random changes (tests/plugin/fuzz.py), every step held against the laws.

They can be taken up where they were left: FUZZ_FIRST=120 make soak begins at seed 120. FUZZ_COUNT is how many there are.
"""
import os
import subprocess
import sys

import pytest

FIRST, COUNT, AT_ONCE = int(os.environ.get("FUZZ_FIRST", 0)), int(os.environ.get("FUZZ_COUNT", 400)), 20


@pytest.mark.timeout(7200)
def test_random_scenes(root):
    """A broken law is reported with its seed, from which one command makes the scene again; the other scenes still run."""
    broken, lines = [], []
    for first in range(FIRST, FIRST + COUNT, AT_ONCE):
        last = min(first + AT_ONCE, FIRST + COUNT) - 1
        done = subprocess.run([sys.executable, "-m", "tests.plugin.fuzz", f"{first}-{last}"], cwd=root, capture_output=True, text=True)
        said = done.stdout.splitlines()
        assert said and said[-1].startswith(f"{last - first + 1} scenes"), f"seeds {first} to {last}: {done.stderr[-2000:]}"
        broken += [line for line in said if ": BROKEN: " in line]
        lines += [line for line in said if ": held: " in line]
        print(f"seeds {first} to {last}: {len(broken)} broken so far", flush=True)
    again = f"/usr/bin/python3 -m tests.plugin.fuzz {' '.join(line.split(':')[0].split()[1] for line in broken)}"
    assert not broken, "\n".join(broken) + f"\nMake them again: {again}"
    assert len(lines) == COUNT and sum("exact" in line for line in lines) > COUNT // 2
