"""Our reader of tables against yade-batch's own, and its messages."""
import argparse

import pytest

from yade_scripts import parameters, tables
from yade_scripts.tables import TableError

def write(tmp_path, text):
    path = tmp_path / "table.txt"
    path.write_text(text)
    return path


def test_same_rows_as_yade_batch_reads(tmp_path):
    from yade import utils
    path = write(tmp_path, "# comment\n\ndescription seed friction !OMP_NUM_THREADS method\n"
                           " a 1 0.1 1 'MD'  # here\f\n\n b = 0.2 = 'CD'\n c 3 = 1 =\n")
    theirs = utils.TableParamReader(str(path)).paramDict()
    ours = tables.read(path)
    assert ours.keys() == theirs.keys() == {4, 6, 7}
    for line, row in ours.items():
        assert row == {name: eval(theirs[line][name]) for name in ("seed", "friction", "method")}


def test_batch_row_is_one_line(tmp_path):
    path = write(tmp_path, "seed method\n1 MD\n2 CD\n")
    assert tables.batch_row(f"{path}:3") == {"seed": 2, "method": "CD"}
    with pytest.raises(TableError, match="no run on line 7; lines with runs: 2, 3"):
        tables.batch_row(f"{path}:7")


@pytest.mark.parametrize("text, message", [
    ("seed\n", "at least one line of values"), ("seed method\n1\n", ":2: 1 values for 2 columns"),
    ("seed\n=\n", ":2: '=' repeats"), (None, "cannot be read")])
def test_broken_table_says_where(tmp_path, text, message):
    path = tmp_path / "none.txt" if text is None else write(tmp_path, text)
    with pytest.raises(TableError, match=message):
        tables.read(path)


def test_lines_are_counted_as_yade_counts_them_and_a_byte_order_mark_is_none(tmp_path):
    """A form feed ends no line. Editors on Windows begin a file with the mark."""
    path = tmp_path / "table.txt"
    path.write_bytes("\ufeffseed # page\f\r\n1 \x0b\x85 # \u2028 \r\n2\n".encode())
    assert tables.read(path) == {2: {"seed": 1}, 3: {"seed": 2}} and tables.batch_row(f"{path}:3") == {"seed": 2}


def test_a_product_has_all_combinations_the_last_name_fastest():
    assert tables.product(seed=range(1, 3), method=("MD", "CD"), disks=60) == [
        {"seed": seed, "method": method, "disks": 60} for seed in (1, 2) for method in ("MD", "CD")]


def test_rows_with_different_names_make_one_table(tmp_path):
    """The table has defaults for values that a row does not set; reading gives the same runs."""
    rows = tables.product(method="MD", seed=(1, 2)) + tables.product(method="CD", tolerance=1e-6, scene="biaxial")
    back = tables.read(write(tmp_path, tables.text(rows))).values()
    assert [parameters.result_name(parameters.complete(row)) for row in back] == [parameters.result_name(parameters.complete(row)) for row in rows]


def test_fig4_runs_both_methods_from_each_packing():
    from analysis import studies

    def compared(row):  # what both methods must share: the packing and its load
        return repr((parameters.preparation(row), [row[name] for name in ("stress_path", "loading", "delta_sigma", "period", "cycles")]))
    for full in (False, True):
        rows = [row for row in studies.rows("fig4", full) if row.get("md_dt_factor") not in studies.module("fig4").FINER]
        springs, rigid = (sorted(compared(row) for row in rows if row["method"] == method) for method in ("MD", "CD"))
        assert springs == rigid and len(set(springs)) == len(springs) == (30 if full else 1)


def test_scenes_with_parameters_of_their_own_make_one_table(tmp_path):
    """A row of one scene has no value for a parameter of another."""
    from yade import utils
    rows = [dict(scene="hopper", slot=12.0, seed=2), dict(scene="filling", seed=3)]
    path = write(tmp_path, tables.text(rows))
    found = list(tables.read(path).values())
    assert found == [dict(scene="hopper", slot=12.0, seed=2), dict(scene="filling", seed=3)]
    assert [parameters.complete(row) for row in found] == [parameters.complete(row) for row in rows]
    assert len(utils.TableParamReader(str(path)).paramDict()) == 2  # yade-batch starts one process for each


def test_shares_are_all_rows_once():
    from yade_scripts import batch
    rows = list(range(7))
    assert sorted(row for index in range(3) for row in rows[batch.share(f"{index}/3")]) == rows
    for wrong in ("3/3", "1", "x/2", "1/0"):
        with pytest.raises(argparse.ArgumentTypeError):
            batch.share(wrong)
