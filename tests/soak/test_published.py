"""What is published: all studies there are, with tables that their result files give again where these are at hand."""
import pytest

from analysis import charts, publish, studies
from tests.analysis.test_published import FOLDER, PUBLISHED, said
from yade_scripts.measuring import maps
from yade_scripts.results import reader


def test_every_study_and_map_is_published():
    """Not asked for by `make test`, since a new one is published only after its full run."""
    assert PUBLISHED == sorted(studies.names())
    assert all((FOLDER / charts.FOLDER / f"map_{name}.csv").exists() for name in maps.names())


@pytest.mark.parametrize("name", PUBLISHED)
def test_summary_regenerates_from_the_result_files(name, tmp_path):
    collection, found = studies.collect(name, reader.RESULTS, full=True), said(name)
    if len(collection.runs) != found["runs_finished"] or publish.origin(collection)["commits"] != found["commits"]:
        pytest.skip(f"the {found['runs_finished']} runs of {name} by commit {found['commits'][0][:12]} are not in {reader.RESULTS}: "
                    f"{found['run_command']}")
    stem = publish.publish(collection, tmp_path)
    assert stem.with_suffix(".csv").read_text() == (FOLDER / f"{name}.csv").read_text()
