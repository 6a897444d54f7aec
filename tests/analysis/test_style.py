"""The common style of the figures: numbers on their axes, colours that can be told apart, and captions that say what was drawn."""
import numpy as np
import pytest
from PIL import Image

from analysis import style
from tests.analysis.conftest import write
from yade_scripts.results import reader


@pytest.mark.parametrize("low", (1.0, 2.1, 5.1, 9.9e-9))
@pytest.mark.parametrize("factor", (1.01, 1.5, 4.7, 9.0, 30.0, 95.0))
def test_every_logarithmic_axis_has_two_numbers_at_least(tmp_path, low, factor):
    fig, axes = style.plt.subplots()
    axes.set(xscale="log", yscale="log", xlim=(low, factor * low), ylim=(low, factor * low))
    style.finish(fig, tmp_path / "figure.png", "", "")
    for axis in (axes.xaxis, axes.yaxis):
        inside = [tick.label1.get_text() for tick in axis.get_major_ticks() if low <= tick.get_loc() <= factor * low]
        assert len(inside) >= 2 and all(inside) and len(set(inside)) == len(inside)


def test_ticks_of_a_figure_s_own_stay(tmp_path):
    fig, axes = style.plt.subplots()
    axes.set(xscale="log", xlim=(300, 8000))
    axes.set_xticks((400, 1600, 6400), ("400", "1600", "6400"))
    style.finish(fig, tmp_path / "figure.png", "", "")
    assert [label.get_text() for label in axes.get_xticklabels()] == ["400", "1600", "6400"]


@pytest.mark.parametrize("count", (2, 5, 9))
def test_neighbouring_shades_can_be_told_apart(count):
    """By a ninth of a channel at least, and the lighter the larger the value."""
    colours = np.array(list(style.shades(range(count)).values()))[:, :3]
    assert (np.abs(np.diff(colours, axis=0)).max(axis=1) > 1 / 9).all() and (np.diff(colours @ (0.30, 0.59, 0.11)) > 0.02).all()


TO_TOLERANCE = "; CD's tolerance 1e-08, missed by at most 0.4 % of the steps of a run"
SWEPT = "; runs with a fixed number of sweeps have no tolerance"


@pytest.mark.parametrize("sweeps, said", [([0, 0], TO_TOLERANCE), ([40, 40], SWEPT), ([0, 40], TO_TOLERANCE + SWEPT)])
def test_a_caption_counts_missed_steps_only_of_runs_with_a_tolerance(tmp_path, sweeps, said):
    runs = [reader.load(write(tmp_path / f"{number}.h5", "CD", row=dict(fixed_iterations=count))) for number, count in enumerate(sweeps)]
    assert style.source(runs).split("YADE 2023.02a")[1] == said


def test_the_file_of_a_figure_holds_its_caption_and_how_high_it_is(tmp_path):
    fig, _ = style.plt.subplots()
    style.finish(fig, tmp_path / "figure.png", "what it shows", "where it comes from")
    with Image.open(tmp_path / "figure.png") as image:
        assert image.info[style.CAPTION] == "what it shows" and image.info["Description"] == "where it comes from"
        foot = np.asarray(image.convert("L"))[-int(image.info[style.FOOT]):]
    assert (foot[:3] == 255).all() and (foot < 128).any()
