"""The message when Slurm does not answer: one line with the remedy."""
import os

import pytest

from yade_scripts.cluster import slurm


def test_no_controller(tmp_path, monkeypatch):
    """The four lines of squeue where nothing is configured."""
    squeue = tmp_path / "squeue"
    squeue.write_text("""#!/bin/sh
echo 'squeue: error: resolve_ctls_from_dns_srv: res_nsearch error: Unknown host
squeue: error: fetch_config: DNS SRV lookup failed
squeue: error: _establish_config_source: failed to fetch config
squeue: fatal: Could not establish a configuration source' >&2
exit 1
""")
    squeue.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
    with pytest.raises(slurm.SlurmError) as caught:
        slurm.states("x")
    said = str(caught.value)
    assert "\n" not in said and "Could not establish a configuration source" in said and "batch.py" in said and "DNS" not in said
