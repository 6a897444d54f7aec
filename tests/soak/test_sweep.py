"""A table on a cluster: the same result files as locally, whatever happens to its tasks."""
import itertools
import os
import shutil
import signal
import subprocess
import sys
import types

import h5py
import numpy
import pytest

from tests.analysis.conftest import write
from tests.soak import cluster
from yade_scripts import batch, parameters, results, tables
from yade_scripts.cluster import slurm, sweep

TABLE = """\
description     scene   speed
plain           bounce  1.0
node-dies       bounce  2.0
over-its-limit  bounce  3.0
leaves-no-file  bounce  4.0
"""
# The real YADE, once the test lets go of the row; of the last row it ends before it can write.
YADE = """\
#!/bin/sh
for word; do
    case $word in speed=*)
        touch "{folder}/reached-${{word#speed=}}"
        [ "${{word#speed=}}" != 4.0 ] || {{ echo "libhdf5 is of another version"; exit 1; }}
        while [ -e "{folder}/hold-${{word#speed=}}" ]; do sleep 0.2; done
    esac
done
exec {yade} "$@"
"""


@pytest.fixture
def cluster_here(tmp_path):
    missing = cluster.missing()
    if missing:
        pytest.skip(f"needs a Slurm on this machine (packages slurmctld, slurmd, slurm-client, munge); not found: {', '.join(missing)}")
    with cluster.Cluster(tmp_path / "slurm") as running:
        yield running


def start(cluster_here, root, table, folder, said):
    """A sweep of the table, in the background."""
    environment = cluster_here.environment | {"PATH": f"{folder}/bin:{os.environ['PATH']}"}
    with open(said, "w") as log:
        return subprocess.Popen([sys.executable, root / "yade_scripts/cluster/sweep.py", table, "--results", folder / "results", "--minutes", "3",
                                 "--retries", "1",
                                 "--seconds", "1"], env=environment, cwd=folder, stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT,
                                # A test run in the background has Ctrl-C ignored, which its children inherit.
                                preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))


def histories(table, folder):
    """{row: {name: values}} without the clock's column, which differs from run to run."""
    found = {}
    for line, row in tables.read(table).items():
        path = results.path_of(parameters.complete(row), folder)
        if results.finished(path):
            with h5py.File(path) as file:
                found[line] = {name: values[()] for name, values in file["history"].items() if name not in ("wall_clock", "processor_time")}
    return found


@pytest.mark.timeout(400)  # 100 s on a busy machine, most of it Slurm's own delays
def test_a_killed_node_a_time_limit_and_a_stopped_watch_change_no_result(cluster_here, root, tmp_path, capsys, monkeypatch):
    """Three rows finish with the bits of a local run: one undisturbed, one whose node dies, one beyond its time limit; one never leaves a file."""
    table, program = tmp_path / "table.txt", tmp_path / "bin" / "yade"
    table.write_text(TABLE)
    program.parent.mkdir()
    program.write_text(YADE.format(folder=tmp_path, yade=shutil.which("yade")))
    program.chmod(0o755)
    for row in ("2.0", "3.0"):
        (tmp_path / f"hold-{row}").touch()

    first = start(cluster_here, root, table, tmp_path, tmp_path / "first")
    cluster.until(lambda: all((tmp_path / f"reached-{row}").exists() for row in ("2.0", "3.0")), 90, "start of both tasks that wait")
    first.send_signal(signal.SIGINT)
    assert first.wait(150) == 130, (tmp_path / "first").read_text()
    assert "The tasks go on" in (tmp_path / "first").read_text()

    second = start(cluster_here, root, table, tmp_path, tmp_path / "second")
    tasks = cluster_here.tasks()
    assert {tasks[1], tasks[2]} == {("RUNNING", "n0"), ("RUNNING", "n1")}
    job = cluster_here.ask("squeue", "-h", "-o", "%F").split()[0]
    cluster_here.ask("scontrol", "update", f"JobId={job}_2", "EndTime=now+2")
    cluster_here.kill(tasks[1][1])
    (tmp_path / "hold-2.0").unlink()
    # Slurm looks for tasks beyond their limit every 30 s.
    cluster.until(lambda: cluster_here.tasks().get(2, ("gone",))[0] not in ("RUNNING", "COMPLETING"), 90, "end of the task beyond its limit")
    (tmp_path / "hold-3.0").unlink()
    status, said = second.wait(200), (tmp_path / "second").read_text()
    assert status == 1, said

    assert "an earlier call's tasks are in the queue" in said
    assert "DUE TO TIME LIMIT" in said
    assert "attempt 1: 2 rows in 2 tasks of at most 3 min" in said, said  # beyond its limit, no file; not the row whose node died
    assert "attempt 2: 1 rows in 1 tasks of at most 6 min" in said, said
    assert "libhdf5 is of another version" in said  # why there is no file: the end of the row's log
    assert cluster_here.ask("sinfo", "-h", "-t", "down", "-o", "%N").split() == [tasks[1][1]]

    monkeypatch.setenv("PATH", f"{tmp_path}/bin:{os.environ['PATH']}")
    assert batch.main([str(table), "--results", str(tmp_path / "local")]) == 1
    capsys.readouterr()
    here, there = histories(table, tmp_path / "local"), histories(table, tmp_path / "results")
    assert len(here) == 3 and here.keys() == there.keys()
    for line in here:
        assert here[line].keys() == there[line].keys()
        for name, values in here[line].items():
            numpy.testing.assert_array_equal(values, there[line][name], err_msg=f"row {line}, {name}")


def options(folder):
    """Those of the command line."""
    return types.SimpleNamespace(results=str(folder), minutes=None, at_once=None, sbatch="")


def test_a_row_that_says_why_it_failed_has_its_answer_and_an_old_failure_is_none(tmp_path):
    """Runs are repeatable: a row that failed in this sweep would fail again. A failure of an earlier sweep may come from older code."""
    jobs = one, two, three = [batch.Row({"scene": "bounce", "speed": float(seed)}, str(tmp_path)) for seed in (1, 2, 3)]

    def leave(job, status):
        write(job.path, "CD", row=job.full, status=status, finished=status == "finished")

    leave(one, "failed: earlier")
    again = sweep.Sweep(jobs, options(tmp_path))
    again.collect()
    assert again.open == [one, two, three] and not again.failed
    leave(two, "failed: the wall ran away")
    leave(three, "finished")
    again.collect()
    assert again.open == [one] and again.failed == [two]


def test_rows_of_one_packing_do_not_start_together(tmp_path):
    jobs = [batch.Row({"scene": "biaxial", "seed": seed, "method": method}, str(tmp_path))
            for seed, method in itertools.product((1, 2), ("MD", "CD"))]
    assert [job.full["seed"] for job in sweep._packings_first(jobs)] == [1, 2, 1, 2]


@pytest.mark.parametrize("rows_open, tasks", [(3, 3), (10, 4)])
def test_more_rows_than_an_array_has_tasks_are_shared_out(monkeypatch, tmp_path, rows_open, tasks):
    """Every row is in exactly one task's share."""
    submitted = []
    monkeypatch.setattr(slurm, "largest_array", lambda: 4)
    monkeypatch.setattr(slurm, "submit", lambda name, command, count, *rest: submitted.append((command, count)) or "1")
    jobs = [batch.Row({"scene": "bounce", "speed": float(k + 1)}, str(tmp_path)) for k in range(rows_open)]
    sweep.Sweep(jobs, options(tmp_path)).submit(0)
    (command, count), = submitted
    assert count == tasks and command.endswith(f"--share $SLURM_ARRAY_TASK_ID/{tasks}")
    shares = [range(rows_open)[batch.share(f"{index}/{tasks}")] for index in range(tasks)]
    assert sorted(row for share in shares for row in share) == list(range(rows_open))


def test_mistakes_are_told_before_anything_is_submitted(tmp_path, monkeypatch, capsys):
    table = tmp_path / "table.txt"
    table.write_text("scene spede\nbounce 1\n")
    assert sweep.main([str(table)]) == 2
    assert "did you mean speed" in capsys.readouterr().err
    table.write_text("scene speed\nbounce 1\n")
    monkeypatch.setenv("PATH", str(tmp_path))
    assert sweep.main([str(table)]) == 2
    assert "there is no Slurm here" in capsys.readouterr().err
