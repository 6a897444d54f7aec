"""Stability maps: the search, the files, and the boundaries that were found."""
import json
import math
import pathlib

import pytest

from yade_scripts import maps, spring_limits
from yade_scripts.maps import INACCURATE, STABLE, UNSTABLE, Outcome, Search, search, store

STORED = json.loads((pathlib.Path(maps.__file__).parent / "boundaries.json").read_text())["boundaries"]


def jump(limit, good_below=True):
    """A probe of x that is stable on one side of `limit`; the values it was asked."""
    asked = []

    def probe(case):
        asked.append(case["x"])
        return Outcome(STABLE) if (case["x"] < limit) == good_below else Outcome(UNSTABLE, "energy growth")

    return probe, asked


@pytest.mark.parametrize("good, bad, below", [(1e-6, 1e3, True), (1e3, 1e-6, False)])
def test_bisection_finds_a_jump_between_its_sides(good, bad, below):
    probe, asked = jump(0.0371, below)
    found = search.bisect(Search({}, "x", good, bad, 1.01), probe)
    assert min(found.good, found.bad) <= 0.0371 <= max(found.good, found.bad) < 1.01 * min(found.good, found.bad)
    # Nine decades of ln 10 halved to ln 1.01, and the two ends.
    assert len(asked) <= 2 + math.ceil(math.log2(9 * math.log(10) / math.log(1.01))) and found.reason == "energy growth"


def test_bisection_of_whole_numbers_ends_at_neighbours():
    probe, _ = jump(37)
    found = search.bisect(Search({}, "x", 1, 1000, 1.0001), probe)
    assert (found.good, found.bad) == (36, 37)


def test_a_line_without_a_boundary_says_so():
    assert search.bisect(Search({}, "x", 1.0, 2.0), jump(5)[0]).note == "none up to 2"
    at_once = search.bisect(Search({}, "x", 1.0, 2.0), jump(0.5)[0])
    assert at_once.note == "energy growth already at 1" and math.isnan(at_once.value)


def test_accepted_verdicts_shift_the_boundary():
    probe = lambda case: Outcome(STABLE) if case["x"] < 2 else Outcome(INACCURATE, "wrong motion") if case["x"] < 5 else Outcome(UNSTABLE, "energy growth")
    for accepted, limit in (((STABLE,), 2), ((STABLE, INACCURATE), 5)):
        assert search.bisect(Search({}, "x", 1.0, 10.0, 1.001, accepted), probe).value == pytest.approx(limit, rel=1e-3)


def test_an_outcome_needs_a_reason_that_there_is():
    for verdict, reason in ((STABLE, "energy growth"), (UNSTABLE, ""), (UNSTABLE, "bad luck"), ("fine", "")):
        with pytest.raises(ValueError):
            Outcome(verdict, reason)


def test_rows_are_kept_and_read_back(tmp_path):
    """To the bit; words with commas and lines cut short by a crash included."""
    case = maps.get("md_contact").grid(False)[0]
    kept = store.Store("md_contact", tmp_path)
    outcome = Outcome(UNSTABLE, "energy growth", "one, two", {"growth": 0.1 + 0.2, "decay_error": math.nan, "frequency_error": 1e-300})
    kept.add(case, outcome, commit="c", yade="y", seconds=1.5)
    with open(kept.path, "a") as file:
        file.write("c,y,1.5,0.25")
    again = store.Store("md_contact", tmp_path)
    assert len(again.rows) == 1 and again.outcome(case).measures["growth"] == 0.1 + 0.2 and again.outcome(case).told == "one, two"
    assert again.outcome(case | {"omega_dt": 77.0}) is None
    kept.path.write_text("other,columns\n1,2\n")
    with pytest.raises(store.StoreError, match="move it away"):
        store.Store("md_contact", tmp_path)


@pytest.mark.parametrize("name", maps.names())
def test_every_map_asks_for_cases_of_its_own_parameters(name):
    """The quick ones fewer than the full ones; no case twice."""
    chart = maps.get(name)
    for full in (False, True):
        cells = chart.grid(full)
        assert all(tuple(case) == chart.parameters for case in cells) and len({tuple(case.values()) for case in cells}) == len(cells)
        for line in chart.searches(full):
            assert set(line.case(line.good)) == set(chart.parameters)
    assert len(chart.grid(False)) < len(chart.grid(True))
    assert {chart.x.name, chart.y.name} <= set(chart.parameters) and (not chart.panels or chart.panels in chart.parameters)


def test_limits_of_the_scheme_agree_with_its_recurrence():
    """At the limit the roots of r^2 - (2 - 2 z s - s^2) r + 1 - 2 z s reach -1; and the matrices of one mode give the same."""
    import numpy as np
    from scipy import sparse
    for damping in (0.0, 0.1, 0.5, 0.9):
        s = spring_limits.oscillator_limit(damping)
        assert min(np.roots([1, -(2 - 2 * damping * s - s**2), 1 - 2 * damping * s]).real) == pytest.approx(-1, abs=1e-12)
        mass, stiffness = np.array([0.3]), sparse.csr_matrix([[50.0]])
        omega = math.sqrt(50 / 0.3)
        dt = spring_limits.matrix_limit(mass, sparse.csr_matrix([[2 * damping * 0.3 * omega]]), stiffness)
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
    outcome = importlib.import_module("yade_scripts.maps.probes." + name).probe(case)
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
        # What looks like success is the worst: these failures must be told.
        if side == "bad" and name in ("servo", "md_packing", "cd_mass_ratio", "cd_sweeps"):
            assert told, (name, case, verdict)
    assert not wrong


class Process:
    """Stands in for a YADE: ends with the codes given, one a start, leaving the first case under way where it crashes."""
    codes, case, path = [], {}, None

    def __init__(self, *arguments, **more):
        self.returncode = Process.codes.pop(0)
        if self.returncode:
            Process.path.write_text(json.dumps(Process.case))

    def poll(self):
        return self.returncode


def test_a_crash_costs_one_case_and_a_mistake_ends_the_map(tmp_path, monkeypatch):
    """Ended by a signal: the case under way is entered as crashed and the rest goes on; by an exception: the map is given up."""
    from yade_scripts.maps import run
    monkeypatch.setattr(run.subprocess, "Popen", Process)
    monkeypatch.setattr(run.commits, "git_commit", lambda: "abc")
    Process.case, Process.path = maps.get("tunnelling").grid(False)[0], tmp_path / "tunnelling.underway"
    Process.codes = [-11, 0]
    assert run.run(["tunnelling"], False, tmp_path, 1) == {}
    row = store.Store("tunnelling", tmp_path).rows
    assert [one["reason"] for one in row] == ["crashed"] and "-11" in row[0]["told"]
    Process.codes = [1]
    assert "exit status 1" in run.run(["tunnelling"], False, tmp_path, 1)["tunnelling"]
