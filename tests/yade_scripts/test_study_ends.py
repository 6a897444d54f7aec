"""Studies that are ended by force, and two at once in one folder."""
import os
import pathlib
import random
import signal
import subprocess
import sys
import time
import types

import pytest

from yade_scripts import batch, parameters, results, tables
from yade_scripts.running import locks

from .conftest import SCRIPTS

TABLE = "disks method period records_per_cycle seed delta_sigma\n" + "".join(
    f"20 {method} 0.05 10 1 0.2\n" for method in ("MD", "CD"))


@pytest.fixture
def table(tmp_path):
    path = tmp_path / "table.txt"
    path.write_text(TABLE)
    return path


def start(table, jobs=2):
    return subprocess.Popen([sys.executable, str(SCRIPTS / "batch.py"), str(table), "--jobs", str(jobs), "--results", str(table.parent / "results")],
                            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def paths(table):
    return [results.path_of(parameters.complete(row), table.parent / "results") for row in tables.read(table).values()]


def runs_in(folder):
    """Process ids of the runs whose results go to `folder`."""
    found = []
    for entry in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
        try:
            words = entry.read_bytes().decode(errors="replace").split("\0")
        except OSError:  # it has ended meanwhile
            continue
        if f"--results={folder}" in words:
            found.append(int(entry.parent.name))
    return found


def wait_for(condition, seconds=600):
    end = time.monotonic() + seconds
    while not (found := condition()):
        assert time.monotonic() < end, "nothing happened in time"
        time.sleep(0.02)
    return found


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGKILL], ids=lambda number: number.name)
def test_runs_end_with_their_study(table, number):
    """Orphaned runs would continue for hours, unseen, and hold the locks of their rows."""
    study, folder = start(table), table.parent / "results"
    wait_for(lambda: runs_in(folder))
    os.kill(study.pid, number)
    said, _ = study.communicate(timeout=1200)
    assert study.returncode == (-number if number == signal.SIGKILL else 128 + number), said
    wait_for(lambda: not runs_in(folder))


@pytest.mark.parametrize("command", ["yade -n -x {scripts}/run.py disks=20 period=0.05 records_per_cycle=10",
                                     "{python} {scripts}/batch.py {table} --jobs 1"])
def test_no_run_ends_with_the_reader_of_its_output(table, command):
    """The program is still at work when `grep` has found its first line, later than those of YADE itself."""
    words = command.format(scripts=SCRIPTS, python=sys.executable, table=table)
    done = subprocess.run(f"{words} --results={table.parent / 'results'} | grep -m 1 biaxial-; exit ${{PIPESTATUS[0]}}", shell=True,
                          executable="/bin/bash", capture_output=True,
                          text=True, stdin=subprocess.DEVNULL)
    wrong = [line for line in done.stderr.splitlines() if "Error" in line or "finished runs are kept" in line]
    assert done.returncode == 0 and not wrong, done.stderr
    assert all(map(results.finished, paths(table)[:1 if "run.py" in command else 2]))


def test_two_studies_at_once_share_the_rows(table):
    """Each row is run once, by one of them, and both end well; afterwards nothing is left but results."""
    studies = [start(table), start(table)]
    said = [study.communicate(timeout=1200)[0] for study in studies]
    assert [study.returncode for study in studies] == [0, 0], said
    folder = table.parent / "results"
    assert all(map(results.finished, paths(table)))
    assert {path.suffix for path in folder.iterdir() if path.is_file()} == {".h5", ".log", ""}
    assert len(list(folder.glob("*.h5"))) == 2


def test_a_killed_study_goes_on_where_it_stopped(table):
    """Killed at random moments; what was finished is not touched again."""
    draw, kept = random.Random(6), {}
    for _ in range(2):
        study = start(table, jobs=1)
        time.sleep(draw.uniform(0.5, 4))
        study.kill()
        study.communicate(timeout=1200)
        for path in paths(table):
            if path.exists():
                assert results.finished(path)
                kept.setdefault(path, path.stat().st_mtime_ns)
    last = start(table)
    said, _ = last.communicate(timeout=1200)
    assert last.returncode == 0, said
    assert all(path.stat().st_mtime_ns == when for path, when in kept.items())
    assert all(map(results.finished, paths(table)))


def test_locks_end_with_their_holder(tmp_path):
    """Held by another process, which is killed."""
    path = tmp_path / "row.h5"
    code = f"import sys, time; sys.path.insert(0, {str(SCRIPTS.parent)!r})\nfrom yade_scripts.running import locks\n" \
           f"with locks.held({str(path)!r}): print('held', flush=True); time.sleep(60)"
    holder = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
    assert holder.stdout.readline() == "held\n"
    assert locks.taken(path) and not locks.taken(tmp_path / "another.h5")
    holder.kill()
    holder.communicate()
    assert not locks.taken(path)
    with locks.held(path):
        pass


def test_a_packing_whose_preparation_is_killed_is_prepared_by_the_next(yade_elsewhere):
    """No lock stays, and a half-written file is not taken for a packing."""
    arguments = ["yade", "-n", "-x", str(SCRIPTS / "preparing" / "prepare.py"), "disks=20"]
    first = subprocess.Popen(arguments, cwd=yade_elsewhere.folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    states = yade_elsewhere.folder / "results" / "states"
    wait_for((states / ".locks").exists)
    first.kill()
    first.wait()
    state, record = yade_elsewhere.prepare("disks=20")
    assert state.exists() and record["sha256"]


def test_a_run_that_takes_too_long_ends_and_goes_on_later(table, capsys):
    """A fifth of a second is enough to start a process, not to finish a run. Without a limit both finish."""
    folder = str(table.parent / "results")
    assert batch.main([str(table), "--results", folder, "--hours", str(0.2 / 3600)]) == 1
    said = capsys.readouterr()
    assert said.out.count("ended, since it took longer than") == 2 and not runs_in(folder)
    assert said.err.count("hours: the same command begins it again: it has no checkpoint") == 2
    results.checkpoint_of(paths(table)[0]).touch()
    ended = []  # a study is drawn when the last of its rows has ended: these have not
    assert len(batch.work_off(batch.jobs_of(list(tables.read(table).values()), folder), 2, ended.append, 0.2 / 3600)) == 2 and not ended
    assert capsys.readouterr().err.count("hours: the same command continues it from its last checkpoint") == 1
    assert batch.main([str(table), "--results", folder]) == 0
    assert all(results.finished(path) for path in paths(table))


def test_a_full_disk_ends_a_batch(table, capsys, monkeypatch):
    """The rows that follow could not write their results either."""
    monkeypatch.setattr(batch.queue, "run", lambda jobs, at_once, ended, hours: [ended(job) for job in jobs])  # none leaves a file
    monkeypatch.setattr(batch.shutil, "disk_usage", lambda folder: types.SimpleNamespace(free=0))
    assert batch.main([str(table), "--results", str(table.parent / "results")]) == 1
    assert "No space left on device" in (said := capsys.readouterr().err) and "free some space and give the same command again" in said
