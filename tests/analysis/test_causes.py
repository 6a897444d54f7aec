"""The table of causes on the report's first page: its numbers, one by one, against the published tables."""
import numpy as np
import pandas
import pytest

from analysis import causes, publish
from analysis.studies import collapse, critical_load, fig3, ratcheting
from tests import numbers
from tests.analysis.test_published import FOLDER, values


def published(name):
    return publish.read_table(FOLDER / f"{name}.csv")


def with_quartiles(rows):
    return list(np.quantile(rows.abs(), (0.5, 0.25, 0.75)))


def quotients(case, base):
    """Cycles until collapse over those of base, under both loads: median, or both ends of what is known of it; load; on how many packings more."""
    times = collapse.times(published("collapse"), case, base)
    return [number for load in collapse.LOADS
            for number in (*dict.fromkeys(collapse.medians(times.loc[load])), load, collapse.longer(times.loc[load]), len(times.loc[load]))]


def stiffness_of_collapse():
    slow = collapse.times(published("collapse"), "rigid, 2 s", "springs, 2 s")
    return [*quotients("rigid", "springs"), 10, *quotients("rigid, packing of 10 k_n", "springs, 10 k_n"),
            2, collapse.medians(slow), collapse.longer(slow), len(slow)]


def tolerance_of_a_rate():
    rows = published("ratcheting").query("`load over limit` < 1 and `k_n over the usual` == 1 and dSigma == 0.4")
    tight = ratcheting.RIGID["tolerance"]
    loose, own = (rows[rows.tolerance == tolerance].rate for tolerance in (ratcheting.LOOSER, tight))
    return [loose.abs().median(), ratcheting.LOOSER, own.abs().median(), tight, [len(loose), len(own)], tight, (own > 1e-7).sum()]


def networks():
    """The runs of each packing that was loaded from several networks."""
    packings = published("critical_load").query("method == 'CD'").groupby(["preparation mu", "seed"])
    return [own for _, own in packings if len(own) > 1]


def networks_of_a_cycle():
    loads = [own["load at 0.0001"] for own in networks()]
    return [max(100 * (own.max() / own.min() - 1) for own in loads), sum(map(len, loads)), len(loads)]


def networks_of_a_rate():
    creep = pandas.concat(networks())[f"gamma at {critical_load.NEARLY} limit"]
    return [len(creep), len(networks()), critical_load.NEARLY, creep.min(), creep.max()]


def limit_of_a_rate():
    case, rate = ["preparation friction", "stress path", "dSigma", "seed"], f"rate of cycles {fig3.COMPARED // 2 + 1} to {fig3.COMPARED}"
    springs, rigid = (publish.finished(published("fig3")).query(f"method == '{method}'").set_index(case) for method in ("MD", "CD"))
    pairs = pandas.concat({"MD": springs[rate], "CD": rigid[rate], "load": springs["load over limit"]}, axis=1).dropna()
    return [fig3.COMPARED] + [number for own in (pairs[pairs.load < 1], pairs[pairs.load >= 1])
            for number in (*with_quartiles(own.MD), *with_quartiles(own.CD), len(own), len(own.groupby(level=[case[0], case[3]])))]


def limit_of_collapse():
    rows = publish.finished(published("fig3")).assign(falls=lambda rows: rows["collapses after"].notna())
    load = rows.groupby(["method", "falls"])["load over limit"]
    return [number for method in ("MD", "CD") for number in (load.min()[method, True], load.max()[method, False])]


def dense(name):
    """What springs do on dense packings, by stress path, load and seed."""
    rows = publish.finished(published("fig3")).query("method == 'MD' and `preparation friction` == 0")
    return rows.set_index(["stress path", "dSigma", "seed"])[name]


def same_ratio(name):
    """With the mean stress held at 0.2 over sigma1 held at 0.5: sigma2/sigma1 goes to 1.5 in both. Median, least, largest."""
    times = dense(name)["mean", 0.2] / dense(name)["constant", 0.5]
    return [1.5, times.median(), times.min(), times.max(), len(times)]


def path_of_collapse():
    falls = dense("collapses after").notna()
    return [number for path, load, ratio in (("mean", 0.3, 1.3 / 0.7), ("constant", 0.8, 1.8), ("constant", 0.3, 1.3))
            for number in (falls[path, load].sum(), len(falls[path, load]), ratio)]


@pytest.mark.parametrize("cause, expected", [
    ("Stiffness of the springs", lambda: (
        [*values("stiffness", "-0.94 -1.01 5 4.5e-4 5.1e-6"), 100],
        values("ratcheting", "2 0.3 -0.95 0.02 29 10 -0.67 0.10 -0.89 0.03 42 0.96 -0.50 0.16 14 8 0.96"), stiffness_of_collapse())),
    ("Tolerance of the solver", lambda: (
        values("tolerance", "7.8e-4 1e-2 9.2e-11 1e-10"), tolerance_of_a_rate(), [1e-6, 1e-8, *quotients("rigid, tolerance 1e-6", "rigid")])),
    ("Indeterminacy: contact forces at the start", lambda: (
        networks_of_a_cycle(), networks_of_a_rate(), quotients("rigid, other forces", "rigid"))),
    ("Static limit: the load that contact forces can balance", lambda: (
        values("fig4", "1.5 4 4 1.6e-6 5.0e-4 4.6e-3 6 6 4.4 13.5"), limit_of_a_rate(), limit_of_collapse())),
    ("Tangential law", lambda: (
        values("laws", "0.994 0.999 6"),
        [*values("laws", "1.01 0.93 1.02 0.4 2 0.99 0.88 1.01 0.5 0.39 1.27 5 -0.91"), *values("thousand", "1000 0.4 0.98 1.00 3")],
        quotients("springs, path-independent law", "springs"))),
    ("Stress path", lambda: (same_ratio("first cycle"), [*same_ratio("gamma after 20"), 20], path_of_collapse()))])
def test_every_number_of_a_cause_is_that_of_the_published_tables(cause, expected):
    for cell, known in zip(causes.TABLE[cause], expected(), strict=True):
        assert numbers.misplaced(cell, known) == [], cell


def test_every_process_has_a_cell():
    assert all(len(cells) == len(causes.PROCESSES) for cells in causes.TABLE.values())


def test_what_is_known_of_lives_that_end_with_the_run(tmp_path):
    cells = {"springs": (2, 4, 8, None), "rigid": (4, None, 6, None)}
    publish.write_table(tmp_path / "collapse.csv", [{"case": case, "dSigma": 0.3, "seed": seed, "collapses after": life,
                                                     "stands": np.nan if life else 80}
                                                    for case, lives in cells.items() for seed, life in enumerate(lives)])
    found = collapse.times(publish.read_table(tmp_path / "collapse.csv"), "rigid", "springs")
    assert found.least.tolist() == [2, 20, 0.75, 0] and found.most.tolist() == [2, np.inf, 0.75, np.inf]
    assert collapse.longer(found) == 2 and collapse.medians(found[:3]) == (2, 2)
    assert collapse.medians(found)[0] == 1.375 and collapse.medians(found)[1] > 1e8
