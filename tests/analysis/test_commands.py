"""The command line: figures that hold ink where they should, tables, and exit statuses."""

import subprocess
import sys

import matplotlib.image
import numpy as np
import pytest

from analysis.__main__ import main
from tests.analysis.conftest import history, lattice, write


def ink(path, colour, rows=slice(None), columns=slice(None)):
    """Share of pixels near a colour in a part of a figure, rows and columns as shares of its size."""
    image = matplotlib.image.imread(path)[:, :, :3]
    height, width = image.shape[:2]
    part = image[int((rows.start or 0) * height):int((rows.stop or 1) * height),
                 int((columns.start or 0) * width):int((columns.stop or 1) * width)]
    target = np.array([int(colour[k:k + 2], 16) for k in (1, 3, 5)]) / 255
    return (np.abs(part - target).max(axis=2) < 0.1).mean()


LEFT, RIGHT = slice(0, 0.5), slice(0.5, 1)
MD_BLUE, CD_RED, BLACK = "#0072B2", "#D55E00", "#1A1A1A"


def test_fig4_draws_md_left_and_cd_right(md, cd, tmp_path):
    path = tmp_path / "new" / "fig4.png"
    assert main(["fig4", str(cd), str(md), "-o", str(path)]) == 0
    for rows in (slice(0.1, 0.4), slice(0.45, 0.75)):
        assert ink(path, MD_BLUE, rows, LEFT) > 1e-3 and ink(path, MD_BLUE, rows, RIGHT) == 0
        assert ink(path, CD_RED, rows, RIGHT) > 1e-3 and ink(path, CD_RED, rows, LEFT) == 0


def test_fig4_draws_a_sample_that_does_not_move(md, tmp_path):
    columns = history("CD", scale=0.0)
    rigid = write(tmp_path / "rigid.h5", "CD", columns)
    path = tmp_path / "fig4.png"
    assert main(["fig4", str(md), str(rigid), "-o", str(path)]) == 0
    assert ink(path, CD_RED, slice(0.45, 0.75), RIGHT) > 1e-3


def test_force_networks_show_chains_and_sliding_contacts_on_both_sides(md, cd, tmp_path):
    path = tmp_path / "networks.png"
    assert main(["force-networks", str(md), str(cd), "-o", str(path)]) == 0
    for columns in (slice(0.02, 0.34), slice(0.38, 0.7)):
        assert ink(path, BLACK, slice(0.15, 0.75), columns) > 0.02
        assert ink(path, CD_RED, slice(0.15, 0.75), columns) > 1e-3


def test_line_width_grows_with_the_force(md, tmp_path):
    """Three times the CD forces draw more ink on the CD side than on the MD side: one scale serves both."""
    strong = {time: lattice(20, "CD") for time in (0.0, 0.5, 1.0)}
    for snapshot in strong.values():
        snapshot["force_normal"] *= 3
    path = tmp_path / "networks.png"
    assert main(["force-networks", str(md), str(write(tmp_path / "strong.h5", "CD", snapshots=strong)), "-o", str(path)]) == 0
    assert ink(path, BLACK, slice(0.15, 0.75), slice(0.38, 0.7)) > 1.5 * ink(path, BLACK, slice(0.15, 0.75), slice(0.02, 0.34))


def test_figures_find_the_newest_pair(md, cd, tmp_path, capsys):
    path = tmp_path / "fig4.png"
    assert main(["fig4", "--results", str(tmp_path), "-o", str(path)]) == 0
    assert capsys.readouterr().out.strip() == str(path)


def mistake(capsys, *arguments):
    """The one line on standard error with which a command refuses, with exit status 2."""
    assert main([str(argument) for argument in arguments]) == 2
    output = capsys.readouterr()
    assert output.out == "" and output.err.count("\n") == 1
    return output.err


def test_mistakes_are_one_line(md, cd, tmp_path, capsys):
    assert "no such file" in mistake(capsys, "fig4", md, tmp_path / "none.h5")
    assert "1 file(s) given" in mistake(capsys, "fig4", md)
    assert "make study" in mistake(capsys, "fig4", "--results", tmp_path / "empty")
    assert "cycle 2 is not complete" in mistake(capsys, "fig4", md, cd, "--cycle", 2, "-o", tmp_path / "x.png")
    assert ".png, .pdf or .svg" in mistake(capsys, "fig4", md, cd, "-o", tmp_path / "x.docx")
    (tmp_path / "file").touch()
    assert "file" in mistake(capsys, "fig4", md, cd, "-o", tmp_path / "file" / "x.png")
    assert not list(tmp_path.glob("x.*"))


def test_unknown_command_exits_with_2(root):
    run = subprocess.run([sys.executable, "-m", "analysis", "fig44"], cwd=root, capture_output=True, text=True)
    assert run.returncode == 2 and "Traceback" not in run.stderr and "fig4" in run.stderr


def test_summary_keeps_failed_runs(md, cd, tmp_path, capsys):
    failed = write(tmp_path / "failed.h5", "CD", finished=False, status="failed: walls locked")
    assert main(["summary", str(md), str(cd), str(failed)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 4
    assert "-2.5000e-04" in lines[1] and "-5.0000e-07" in lines[2] and "failed: walls locked" in lines[3]


def test_summary_of_a_scene_without_walls(tmp_path, capsys):
    columns = history("CD")
    columns["gamma"][:] = np.nan
    assert main(["summary", str(write(tmp_path / "bounce.h5", "CD", columns))]) == 0
    assert "n/a" in capsys.readouterr().out


@pytest.mark.parametrize("change, status, word", [
    ({}, 0, "finished"), (dict(finished=False, status="failed: x"), 1, "failed: x"), (dict(git_commit="d" * 40), 1, "different commits")])
def test_check(md, tmp_path, capsys, change, status, word):
    other = write(tmp_path / "other.h5", "CD", **change)
    assert main(["check", str(md), str(other)]) == status
    assert word in capsys.readouterr().out
