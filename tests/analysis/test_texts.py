"""The texts: their templates give what is stored, and refuse numbers that nobody has rounded."""
import jinja2
import pytest

from analysis import report, studies, texts
from yade_scripts.results.reader import ResultError


def test_the_stored_texts_are_those_of_the_templates():
    """`/usr/bin/python3 -m analysis texts` writes them."""
    for file, text in texts.committed().items():
        assert file.read_text(encoding="utf-8") == text, file


@pytest.mark.parametrize("source, written", [
    ("{{ 4.34e-4 | sci }} {{ 4.34e-4 | sci(1) }} {{ 12 | sci }}", "4.3e-4 4e-4 1.2e1"), ("{{ 0.996 | fixed(2) }} {{ 35.7 | fixed }}", "1.00 36"),
    ("{{ 0.0234 | percent(1) }} %", "2.3 %"), ("{{ (1.5, 0.25, 1) | range | fixed(2) }}", "0.25 to 1.50"), ("{{ (1, 2) | length }}", "2")])
def test_how_numbers_are_written(source, written):
    assert texts.ENVIRONMENT.from_string(source).render() == written


@pytest.mark.parametrize("source, error", [("{{ 0.1 + 0.2 }}", TypeError), ("{{ unknown }}", jinja2.UndefinedError)])
def test_what_is_not_rounded_or_not_known_is_refused(source, error):
    with pytest.raises(error):
        texts.ENVIRONMENT.from_string(source).render()


def test_a_text_that_fails_costs_the_page_no_other(monkeypatch, tmp_path):
    """Here one that names a quantity that its study does not have."""
    monkeypatch.setattr(studies.module("tolerance"), "ANSWER", "{{ unknown }}")
    texts._text.cache_clear()
    with pytest.raises(ResultError, match="tolerance: its text cannot be written .UndefinedError: 'unknown' is undefined.; correct it"):
        texts.answer("tolerance")
    page = report.build(texts.PUBLISHED, tmp_path / "page.html").read_text()
    texts._text.cache_clear()
    assert "Left out: tolerance: its text cannot be written" in page and studies.module("fig4").TITLE in page


def test_every_cell_of_the_table_of_causes_holds_a_number_or_a_dash():
    _, headings, causes = texts.causes()
    assert causes and all(len(cells) == len(headings) for cells in causes.values())
    assert all(cell == "-" or cell[0].isdigit() for cells in causes.values() for cell in cells)


def test_lines_are_wrapped_and_lists_stay_lists():
    words = " ".join(["word"] * 40)
    assert texts.wrap(f"{words}\n\n- {words}\n- b") == "\n".join((
        " ".join(["word"] * 30), " ".join(["word"] * 10), "", "- " + " ".join(["word"] * 29), "  " + " ".join(["word"] * 11), "- b"))


def test_rows_of_tables_are_not_wrapped():
    row = "| " + " ".join(["word"] * 40) + " |"
    assert texts.wrap(f"word\nword\n{row}\n{row}") == f"word word\n{row}\n{row}"
