"""Stability maps: the search, the files, and the boundaries that were found."""
import dataclasses
import json
import math
import pathlib

import pytest

from analysis.charts import maps as drawn
from yade_scripts.measuring import maps, store
from yade_scripts.parameters import ParameterError
from yade_scripts.results import provenance
from yade_scripts.results.reader import ResultError
from cd_engine import springs
from yade_scripts.theory import spring_limits
from yade_scripts.measuring.maps import INACCURATE, Outcome, STABLE, Search, UNSTABLE

STORED = json.loads((pathlib.Path(__file__).parent / "boundaries.json").read_text())["boundaries"]


def jump(limit, good_below=True):
    """Return a probe of x that is stable on one side of `limit`, and the list of values it was asked for."""
    asked = []

    def probe(case):
        asked.append(case["x"])
        return Outcome(STABLE) if (case["x"] < limit) == good_below else Outcome(UNSTABLE, "energy growth")

    return probe, asked


@pytest.mark.parametrize("good, bad, below", [(1e-6, 1e3, True), (1e3, 1e-6, False)])
def test_bisection_finds_a_jump_between_its_sides(good, bad, below):
    probe, asked = jump(0.0371, below)
    found = maps.bisect(Search({}, "x", good, bad, 1.01), probe)
    assert min(found.good, found.bad) <= 0.0371 <= max(found.good, found.bad) < 1.01 * min(found.good, found.bad)
    # Nine decades of ln 10 halved to ln 1.01, and the two ends.
    assert len(asked) <= 2 + math.ceil(math.log2(9 * math.log(10) / math.log(1.01))) and found.reason == "energy growth"


def test_bisection_of_whole_numbers_ends_at_neighbours():
    probe, _ = jump(37)
    found = maps.bisect(Search({}, "x", 1, 1000, 1.0001), probe)
    assert (found.good, found.bad) == (36, 37)


def test_a_line_without_a_boundary_says_so():
    assert maps.bisect(Search({}, "x", 1.0, 2.0), jump(5)[0]).note == "none up to 2"
    at_once = maps.bisect(Search({}, "x", 1.0, 2.0), jump(0.5)[0])
    assert at_once.note == "energy growth already at 1" and math.isnan(at_once.value)


@pytest.mark.parametrize("good, bad, at", [(1.0, 64.0, (2, 4)), (64.0, 1.0, (64, 32))])
def test_the_first_failure_is_told_where_good_cases_and_failures_alternate(good, bad, at):
    """Of 1, 2, 4, ... 64 the values 1, 2, 8, 16 and 64 are good: a bisection ends at one of several crossings. What is outside does not count."""
    search = Search({"y": 3}, "x", good, bad, 1.01)
    outcomes = {value: Outcome(STABLE) if value in (1, 2, 8, 16, 64) else Outcome(UNSTABLE, "penetration") for value in (64, 4, 1, 8, 32, 16, 2, 128)}
    found, again = drawn.first_failure(search, outcomes)
    assert (found.good, found.bad, found.reason, found.note) == (*at, "penetration", "") and again
    assert maps.on_line(search, {"y": 3, "x": 4.0}) == 4.0 and maps.on_line(search, {"y": 2, "x": 4.0}) is None
    single, again = drawn.first_failure(search, {value: outcomes[value] for value in ((1, 2, 4) if good < bad else (64, 32, 4))})
    assert (single.good, single.bad) == at and not again


def test_accepted_verdicts_shift_the_boundary():
    probe = lambda case: (Outcome(STABLE) if case["x"] < 2 else Outcome(INACCURATE, "wrong motion") if case["x"] < 5
                          else Outcome(UNSTABLE, "energy growth"))
    for accepted, limit in (((STABLE,), 2), ((STABLE, INACCURATE), 5)):
        assert maps.bisect(Search({}, "x", 1.0, 10.0, 1.001, accepted), probe).value == pytest.approx(limit, rel=1e-3)


def test_an_outcome_needs_a_reason_that_there_is():
    for verdict, reason in ((STABLE, "energy growth"), (UNSTABLE, ""), (UNSTABLE, "bad luck"), ("fine", "")):
        with pytest.raises(ValueError):
            Outcome(verdict, reason)


@pytest.mark.parametrize("name", maps.names())
def test_every_map_asks_for_cases_of_its_own_parameters(name):
    """The quick map has fewer cases than the full one, and no case twice."""
    chart = maps.get(name)
    own = tuple(chart.grid(False)[0])
    for full in (False, True):
        cells = chart.grid(full)
        assert all(tuple(case) == own for case in cells) and len({tuple(case.values()) for case in cells}) == len(cells)
        for line in chart.searches(full):
            assert set(line.case(line.good)) == set(own)
    assert len(chart.grid(False)) < len(chart.grid(True))
    assert {chart.x.name, chart.y.name} <= set(own) and (not chart.panels or chart.panels in own)


def test_a_map_that_lacks_something_is_refused(monkeypatch):
    """A command that walks over all maps says which file lacks what."""
    file = maps.module("servo")
    maps.module.cache_clear()
    monkeypatch.delattr(file, "probe")
    with pytest.raises(ParameterError, match="servo.py lacks probe; .*maps/__init__.py explains"):
        maps.names()
    with pytest.raises(TypeError, match="'criterion', 'remedy', 'y', 'grid', and 'searches'"):
        maps.Map(title="Too little", question="What else?", x=maps.Axis("x", "x"))


@pytest.mark.parametrize("changes, words", [
    ({"x": maps.Axis("gian", "gain")}, "servo.py: MAP has axes or panels gian, but its cases have .*gain"),
    ({"grid": lambda full: []}, "servo.py.*IndexError")])
def test_a_map_whose_axes_are_not_in_its_cases_is_refused(monkeypatch, changes, words):
    file = maps.module("servo")
    maps.module.cache_clear()
    monkeypatch.setattr(file, "MAP", dataclasses.replace(file.MAP, **changes))
    with pytest.raises((ParameterError, ImportError), match=words):
        maps.names()


def test_a_map_with_the_name_of_a_scene_is_refused(monkeypatch):
    maps.module.cache_clear()
    monkeypatch.setattr("yade_scripts.scenes.names", lambda: ("servo",))
    with pytest.raises(ParameterError, match="servo.py: there is a scene of this name, whose chart it would replace"):
        maps.names()


def test_limits_of_the_scheme_agree_with_its_recurrence():
    """At the limit the roots of r^2 - (2 - 2 z s - s^2) r + 1 - 2 z s reach -1; and the matrices of one mode give the same."""
    import numpy as np
    from scipy import sparse
    for damping in (0.0, 0.1, 0.5, 0.9):
        s = spring_limits.oscillator_limit(damping)
        assert min(np.roots([1, -(2 - 2 * damping * s - s**2), 1 - 2 * damping * s]).real) == pytest.approx(-1, abs=1e-12)
        mass, stiffness = np.array([0.3]), sparse.csr_matrix([[50.0]])
        omega = math.sqrt(50 / 0.3)
        dt = springs.matrix_limit(mass, sparse.csr_matrix([[2 * damping * 0.3 * omega]]), stiffness)
        assert omega * dt == pytest.approx(s, rel=2e-4)  # what matrix_limit bisects to


def test_boundaries_are_where_they_were(yade_elsewhere):
    """Each stored boundary is bracketed by its tolerance: the good side is good, the bad side is what it was."""
    cases = []
    for stored in STORED:
        factor = (1 + stored["tolerance"])**(1 if stored["good"] == "below" else -1)
        whole = stored["along"] == "sweeps"
        for side, value in (("good", stored["value"] / factor), ("bad", stored["value"] * factor)):
            cases.append((stored["map"], side, stored["at"] | {stored["along"]: round(value) if whole else value}))
    outcomes = yade_elsewhere.code(f"""
import importlib
from yade import O
found = []
for name, side, case in json.loads({json.dumps(json.dumps(cases))}):
    O.reset()
    outcome = importlib.import_module("yade_scripts.measuring.maps." + name).probe(case)
    found.append([outcome.verdict, outcome.reason, outcome.told])
print(json.dumps(found))
""")
    wrong = []
    for (name, side, case), (verdict, reason, told) in zip(cases, outcomes):
        stored = next(one for one in STORED if one["map"] == name and one["at"].items() <= case.items())
        expected = stored["bad"] if side == "bad" and stored["bad"] else STABLE
        good = (STABLE, INACCURATE) if stored["bad"] == UNSTABLE else (STABLE,)
        if verdict not in (good if expected == STABLE else (expected,)):
            wrong.append((name, side, case, verdict, reason))
        # A failure that looks like success is the worst kind: the program must report these failures.
        if side == "bad" and name in ("servo", "md_packing", "cd_mass_ratio", "cd_sweeps"):
            assert told, (name, case, verdict)
    assert not wrong


@pytest.fixture
def probed(O, tmp_path, monkeypatch):
    """The quick map md_contact, measured with outcomes as its theory has them: unstable above the limit, inaccurate above half of it."""
    def probe(case):
        share = case["omega_dt"] / spring_limits.contact_limit(case["beta_n"], case["kt_over_kn"])
        return Outcome(UNSTABLE, "energy growth") if share > 1 else Outcome(INACCURATE, "wrong motion") if share > 0.5 else Outcome(STABLE)

    monkeypatch.setattr(maps.module("md_contact"), "probe", probe)
    work = maps.Work("md_contact", False, tmp_path)
    work.measure(lambda name, seconds: None)
    return work


def test_boundaries_are_found_again_from_what_is_kept(probed, tmp_path):
    """Instability where theory has it, to the search's precision of 3 %; the first failure at half of it."""
    found = drawn.collect("md_contact", tmp_path, False)
    assert not found.missing
    rows = drawn.rows([found])
    assert {row["from"] for row in rows} == {"instability", "first failure"}
    for row in rows:
        assert row["boundary"] == pytest.approx(row["theory"] * (1 if row["from"] == "instability" else 0.5), rel=0.03)


def test_figures_and_tables_name_what_was_not_run(probed, tmp_path):
    """A map that was not probed at all is left out; missing cells are rows with a status."""
    for case in probed.map.grid(False)[-3:]:
        (probed.folder / f"{store.name_of({'map': probed.name, 'case': case})}.h5").unlink()
    several, origin = drawn.measured(tmp_path, False)
    assert list(drawn.draw(several, tmp_path, "a line")) == ["map_md_contact.png"] and (tmp_path / "map_md_contact.png").stat().st_size > 10000
    assert origin["commits"] == [provenance.git_commit()] and sum(row["status"] == "not run yet" for row in drawn.rows(several)) == 3
    with pytest.raises(ResultError, match="make charts"):
        drawn.measured(tmp_path / "elsewhere", False)
