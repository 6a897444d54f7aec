"""The command line of the analysis: figures with ink where it should be, tables, and exit statuses."""
import io
import math
import os
import subprocess
import sys

import h5py
import matplotlib.image
import numpy as np
import pytest

from analysis import __main__ as command
from analysis import studies
from tests.analysis.conftest import history, lattice, write, write_row
from yade_scripts import parameters, results, tables
from yade_scripts.measuring import store
from yade_scripts.results import reader, schema, sealed


def main(arguments):
    return command.main([str(argument) for argument in arguments])


def ink(path, colour, columns=slice(0, 1)):
    """Share of pixels near a colour in a part of a figure, columns as shares of its width."""
    image = matplotlib.image.imread(path)[:, :, :3]
    part = image[int(0.1 * len(image)):int(0.75 * len(image)), int(columns.start * image.shape[1]):int(columns.stop * image.shape[1])]
    target = np.array([int(colour[k:k + 2], 16) for k in (1, 3, 5)]) / 255
    return (np.abs(part - target).max(axis=2) < 0.1).mean()


MD_BLUE, CD_RED, BLACK = "#0072B2", "#D55E00", "#1A1A1A"


def drawn(name, runs, path):
    module = studies.module(name)
    runs = [reader.load(run) for run in runs]
    module.draw(runs, module.summarize(runs), path)
    return path


def test_fig4_shows_both_methods_on_one_axis(md, cd, tmp_path):
    path = drawn("fig4", (md, cd), tmp_path / "fig4.png")
    assert ink(path, MD_BLUE) > 1e-3 and ink(path, CD_RED) > 1e-3
    rigid = write(tmp_path / "rigid.h5", "CD", history("CD", scale=0.0))  # a sample that does not move
    assert ink(drawn("fig4", (md, rigid), tmp_path / "fig4.png"), CD_RED) > 1e-3


def test_force_networks_show_chains_and_sliding_contacts_on_both_sides(md, cd, tmp_path):
    path = drawn("force_networks", (md, cd), tmp_path / "networks.png")
    for columns in (slice(0.02, 0.33), slice(0.37, 0.66)):
        assert ink(path, BLACK, columns) > 0.02 and ink(path, CD_RED, columns) > 1e-3


def test_line_width_grows_with_the_force(md, tmp_path):
    """Three times the CD forces draw more ink on the CD side than on the MD side: one scale serves both."""
    strong = {time: lattice(20, "CD") for time in (0.0, 0.5, 1.0)}
    for snapshot in strong.values():
        snapshot["force_normal"] *= 3
    path = drawn("force_networks", (md, write(tmp_path / "strong.h5", "CD", snapshots=strong)), tmp_path / "networks.png")
    assert ink(path, BLACK, slice(0.37, 0.68)) > 1.4 * ink(path, BLACK, slice(0.02, 0.33))


def test_a_table_of_a_study_runs_under_yade_batch(capsys, tmp_path):
    """Printed, it reads back as the same rows."""
    assert main(["table", "implicit", "--full"]) == 0
    path = tmp_path / "implicit.txt"
    path.write_text(capsys.readouterr().out)
    rows = list(tables.read(path).values())
    names = [parameters.result_name(parameters.complete(row)) for row in rows]
    assert names == [parameters.result_name(row) for row in studies.rows("implicit", True)]
    assert tables.batch_row(f"{path}:2") == rows[0]


def test_summary_keeps_failed_runs(md, cd, tmp_path, capsys):
    failed = write_row(tmp_path, {"method": "CD", "seed": 2}, finished=False, status="failed: walls locked")
    assert main(["summary", md, cd, failed]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert "-0.00025" in lines[1] and "-5e-07" in lines[2] and "failed" in lines[3]
    assert lines[4:] == [f"{failed.name}: failed: walls locked"]
    # The stiffness of rigid grains would be the noise of the strain.
    assert "loop width  stiffness Pa" in lines[0] and lines[1].split()[6] != lines[2].split()[6] == "n/a"


def test_summary_of_a_scene_without_walls(tmp_path, capsys):
    columns = history("CD")
    for name in schema.OF_A_BOX:
        columns[name][:] = np.nan
    assert main(["summary", write_row(tmp_path, {"method": "CD"}, columns=columns)]) == 0
    assert "n/a" in capsys.readouterr().out


def test_a_collapse_and_what_a_run_did_not_show_are_told(tmp_path, capsys):
    fell = write_row(tmp_path, {"method": "MD", "seed": 3}, outcome="collapsed: |gamma| above 0.2", columns={
        name: values[:40] for name, values in history("MD").items()})  # before the load falls: no loop
    content = io.BytesIO(fell.read_bytes())
    with h5py.File(content, "r+") as file:
        file["extra/rate"], file["extra/slope"] = math.nan, 1.0
    sealed.write(fell, content.getvalue())
    assert main(["summary", fell]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[1].split()[5] == "n/a" and said[2] == f"{fell.name}: collapsed: |gamma| above 0.2"
    assert main(["check", fell]) == 0
    assert capsys.readouterr().out.strip().endswith("collapsed: |gamma| above 0.2, no rate")
    assert results.in_words(fell) == "finished, collapsed: |gamma| above 0.2"


@pytest.mark.parametrize("change, status, word", [
    ({}, 0, "finished"), (dict(finished=False, status="failed: x"), 1, "failed: x"), (dict(git_commit="d" * 40), 1, "different commits")])
def test_check(md, tmp_path, capsys, change, status, word):
    assert main(["check", md, write_row(tmp_path, {"method": "CD"}, **change)]) == status
    assert word in capsys.readouterr().out


def test_check_and_summary_refuse_a_renamed_run(md, tmp_path, capsys):
    other = md.rename(tmp_path / f"{md.stem}.old.h5")
    said = f"{other}: it holds another run than its name says ({md.stem}); rename it, or run it again\n"
    assert main(["check", other]) == 1
    assert capsys.readouterr().out == said
    assert main(["summary", other]) == 2
    assert capsys.readouterr().err == f"analysis: {said}"


def test_a_file_that_cannot_be_read_costs_the_others_nothing_in_a_summary(md, tmp_path, capsys):
    (wrong := tmp_path / "wrong.h5").write_text("no result")
    assert main(["summary", str(wrong), str(md)]) == 2
    said = capsys.readouterr()
    assert md.name in said.out and str(wrong) in said.err


def test_check_of_measurements(tmp_path, capsys):
    """They are finished, whatever was found, damaged or misnamed."""
    for case, facts in enumerate(({"verdict": "stable"}, {"verdict": "not solved"})):
        store.add(tmp_path, {"map": "m", "case": {"x": case}, "git_commit": "c" * 40} | facts)
    good, bad = sorted(tmp_path.glob("*.h5"))
    assert main(["check", str(good), str(bad)]) == 0
    said = {line.partition(": ")[2] for line in capsys.readouterr().out.splitlines()}
    assert said == {"finished, a measurement (stable)", "finished, a measurement (not solved)"}
    assert main(["summary", str(good)]) == 2
    assert capsys.readouterr().err == f"analysis: {good}: is a measurement, not a run; `python3 -m analysis check` reads it\n"
    renamed = bad.rename(tmp_path / "m-0.h5")
    good.write_bytes(good.read_bytes().replace(b'"verdict"', b'"Verdict"'))
    assert main(["check", str(renamed)]) == 1 and main(["check", str(good)]) == 1
    said = capsys.readouterr().out.splitlines()
    assert said[0].startswith(f"{renamed}: holds another measurement than its name says (m-")
    assert "is damaged, or another program has changed it" in said[1]


@pytest.mark.parametrize("more", (["--full"], ["--quick"], ["--results", "elsewhere"]))
def test_a_published_page_is_of_no_other_results(tmp_path, capsys, more):
    assert main(["report", "--published", "analysis/published", "-o", tmp_path / "page.html", *more]) == 2
    assert capsys.readouterr().err == "analysis: --published takes figures and tables as they are: leave out --quick, --full and --results\n"


@pytest.mark.parametrize("command", ("table", "charts", "report"))
def test_what_runs_nothing_promises_no_hours(capsys, command):
    with pytest.raises(SystemExit):
        main([command, "--help"])
    assert "--full" in (said := capsys.readouterr().out) and "hours" not in said


PAGE = ["report", "--published", "analysis/published", "-o", "{page}"]
LATIN = {"LC_ALL": "de_DE.ISO-8859-1", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}


@pytest.mark.parametrize("surroundings, arguments", [
    (LATIN | {"HOME": None}, PAGE), (LATIN | {"LC_ALL": "C"}, ["recommend"]), ({"PATH": "/nowhere"}, ["check", "{run}"])],
    ids=["Latin-1, no HOME", "ASCII", "no git"])
def test_commands_work_in_poor_surroundings(root, tmp_path, md, surroundings, arguments):
    """They work without a UTF-8 locale, HOME or git: the published page has all letters, drawing looks for fonts below HOME, provenance asks git."""
    environment = {name: value for name, value in (os.environ | surroundings).items() if value is not None}
    words = [word.format(page=tmp_path / "page.html", run=md) for word in arguments]
    done = subprocess.run([sys.executable, "-m", "analysis", *words], cwd=root, env=environment, capture_output=True)
    assert done.returncode == 0, done.stderr
    assert arguments is not PAGE or "García-Rojo" in (tmp_path / "page.html").read_text(encoding="utf-8")


def test_a_run_without_home_and_git_is_started(tmp_path, monkeypatch):
    """YADE does not start without a HOME; the runner gives it one. Without git the commit is unknown."""
    from yade_scripts.results import provenance
    from yade_scripts.running import queue
    monkeypatch.delenv("HOME")
    assert queue.environment()["HOME"]
    monkeypatch.setenv("PATH", "/nowhere")
    assert provenance.git_commit.__wrapped__() == "unknown"


def test_a_closed_output_is_no_traceback(root, md):
    done = subprocess.run(f"{sys.executable} -m analysis check {md} >&-", cwd=root, shell=True, stderr=subprocess.PIPE, text=True)
    assert (done.returncode, done.stderr) == (0, "")


def test_a_closed_pipe_is_no_traceback(root):
    done = subprocess.run("exec 2>&1; { /usr/bin/python3 -m analysis table fig3 --full; echo status $? >&3; } 3>&1 | head -1; true", cwd=root,
                          shell=True,
                          executable="/bin/bash", capture_output=True, text=True)
    assert "Traceback" not in done.stdout and "Error" not in done.stdout
