"""The scenes with known answers, at stated settings: by Contact Dynamics, and by springs where they come close within a second; their energies."""
import dataclasses
import json
import math

import numpy as np
import pytest

from yade_scripts import parameters, results, run, scenes
from yade_scripts.results import schema

G = 9.81
MASS = 2600 * math.pi * 0.01**2  # [kg] of the disk of radius 0.01 m, 1 m deep
SPHERE = 2600 * 4 / 3 * math.pi * 0.01**3  # [kg] of the sphere of this radius


def omega(kn, share=1.0):
    """sqrt(share k_n/m) [1/s]."""
    return math.sqrt(share * kn / MASS)


# (scene, row, largest error, its reason). Springs err by their stiffness (displacements of m g/k_n, times of 1/omega) and by the step.
ROWS = [
    ("incline", dict(slope=-35.0), 1.7e-12, "round-off of 1000 steps"),
    ("incline", dict(slope=-85.0), 1.7e-12, "the same"),
    ("incline", dict(slope=10.0), 1.7e-12, "the same; it rests"),
    ("incline", dict(method="MD"), 4e-4, "the block starts with its tangential spring at rest and swings once"),
    ("incline", dict(method="MD", slope=16.0), 7e-4, "the same"),
    ("bounce", dict(method="MD", md_dt_factor=0.01, speed=0.01), 1e-3, "7e-4 from the step, first order, 1e-2 at the default 0.2; at 1 m/s the "
     "overlap of 6 % of the radius would add 3e-3"),
    ("stack", dict(disks=20), 1e-8, "the solver's tolerance"),
    ("stack", dict(method="MD", disks=20), 1e-8, "round-off"),
    ("loaded_box", dict(disks=25), 1e-8, "the solver's tolerance"),
    ("loaded_box", dict(method="MD", disks=25), 1e-8, "round-off"),
    ("loaded_box", dict(method="MD", disks=25, md_walls="force"), 1e-8, "round-off"),
    ("friction_angle", {}, 1e-10, "round-off of 1000 steps, 1e-12 of g mu, over the margin of 0.01"),
    ("friction_angle", dict(method="MD", margin=0.1, kn=2e8), 2.2 / (0.1 * omega(2e8, 0.5)), "speed won while the spring is loaded, g sin t/omega"),
    ("stopping_distance", {}, 0.3 * G * 1e-6 / 8 / (1 / (2 * 0.3 * G)) * 1.001, "mu g dt^2/8, if it stops in the middle of a step"),
    ("stopping_distance", dict(method="MD", kn=2e8), 1.1 * 0.3 * G / omega(2e8, 0.5), "it swings on its tangential spring, mu g/omega of 1 m/s"),
    ("zeno", {}, 50 * 1e-4 / 0.3029, "a bounce comes up to a step early, from g v dt too much height: 4 steps for each of the 12 bounces longer than "
     "a step"),
    ("zeno", dict(method="MD", kn=2e8), 0.04, "restitution 0.49 for steps of 0.2 sqrt(m/k_n), first order"),
    ("cradle", {}, 1e-12, "round-off"),
    ("cradle", dict(restitution=0.6), 1e-12, "round-off"),
    ("cradle", dict(restitution=0.0, period=0.5), 1e-11, "the solver's tolerance of 1e-13, in 500 steps"),
    ("cradle", dict(restitution=0.0, period=0.5, cd_dt=0.01), 1e-11, "the same in steps of twice the gap"),
    ("cradle", dict(method="MD", md_dt_factor=0.02), 2e-4, "4 collisions of 160 steps, 5e-5"),
    ("heavy_on_light", {}, 1e-10, "the tolerance of 1e-12 times the mass ratio"),
    ("heavy_on_light", dict(mass_ratio=1e4), 1e-8, "the same"),
    ("heavy_on_light", dict(method="MD", kn=2e8), 1.01 * 201 * MASS * G / 2e8 / 0.01, "the springs' compression by the weights"),
    ("thin_wall", dict(cd_dt=1e-3), 1.5 * 10 * 1e-3 / 0.3, "the bounce comes up to a step of ten wall thicknesses early"),
    ("thin_wall", dict(cd_dt=3e-3), 1.5 * 10 * 3e-3 / 0.3, "the same, thirty"),
    ("thin_wall", dict(cd_dt=3e-3, speed=100.0), 1.5 * 100 * 3e-3 / 3, "the same, three hundred"),
    ("thin_wall", dict(method="MD", kn=2e8, md_dt_factor=0.02), 0.01, "duration of the impact, 2e-4 s of 0.03 s"),
    ("groove", {}, 1e-10, "the solver's tolerance of 1e-12, 200 steps, over the margin of 0.05"),
    ("groove", dict(friction=0.8, slope=30.0), 1e-10, "the same; it rolls out"),
    ("groove", dict(friction=0.9, slope=60.0), 1e-10, "the same; it jams"),
    ("groove", dict(method="MD", kn=2e8), 0.01, "spin won while the springs are loaded, 1/(margin omega time), omega = 1e4/s"),
    ("groove", dict(method="MD", kn=2e8, friction=0.8, slope=30.0), 0.015, "the same"),
    ("arch", {}, 1e-4, "second order in dt = 1e-3 s, 3e-5"),
    ("arch", dict(cd_dt=1e-4), 1e-6, "the same at 1e-4 s, 3e-7"),
    ("arch", dict(method="MD", kn=2e10), 2e-3, "as 1/sqrt(k_n), 0.12 at 2e6"),
    ("pyramid", {}, 1e-10, "the tolerance of 1e-12 times the 15 weights in the lowest row"),
    ("pyramid", dict(rows=12), 1e-9, "the same, 78 weights"),
    ("pyramid", dict(method="MD"), 15 * MASS * G / 2e6 / 0.01, "the springs' compression by the weights, at most all of them on one"),
    ("packing_at_rest", {}, 1e-6, "the tolerance of 1e-8 on the forces, summed over a wall"),
    ("packing_at_rest", dict(warm_start=False), 1e-5, "the same, the forces found anew in every step"),
    ("packing_at_rest", dict(method="MD"), 1e-6, "the rest that the packing was brought to, 1e-7"),
    ("elastic_step", dict(tolerance=1e-10), 1e-3, "creep by the tolerance on the forces, 1e-8 of gamma at 1e-8 is 8e-3 of the springs'"),
    ("elastic_step", dict(method="MD"), 6e-3, "geometry that changes with the overlaps, P0/k_n = 6e-4 a few times; inertia as much"),
    ("yield_ramp", {}, 0.01, "a step and a sample of the ramp, 0.002 P0 each; contacts that close in a strain of 2e-5"),
    ("yield_ramp", dict(seed=2), 0.01, "the same"),
    ("yield_ramp", dict(stress_path="mean", ramp_rate=0.25), 0.01, "the same, with the mean stress held"),
    ("hopper", dict(tolerance=1e-2, cd_dt=2e-3), 0.15, "four standard deviations of one run, 0.035 each"),
    ("drum", dict(tolerance=1e-2, cd_dt=2e-3, gap_correction=0.1), 0.11, "the same, 0.026 each"),
    ("filling", dict(tolerance=1e-2), 0.032, "the same, 0.008 each"),
    ("sphere_slide_to_roll", {}, 1e-12, "round-off of 1000 steps"),
    ("sphere_slide_to_roll", dict(method="MD"), 1.05 * 3.5 * 0.3 * G / math.sqrt(1.75 * 2e6 / SPHERE), "friction ends at once and leaves "
     "the tangential spring swinging, by mu g (m/m_t)/omega of 1 m/s: m_t = m/3.5 at the contact point, omega^2 = k_t/m_t; steps of 0.2 sqrt(m/k_n)"),
    ("oblique_impact", {}, 1e-8, "it touches 1e-6 steps after the middle of one, 1e-6 3.9 m/s 1e-5 s of the radius"),
    ("oblique_impact", dict(impact_angle=75.0, restitution=0.3), 1e-8, "the same"),
    ("oblique_impact", dict(method="MD", md_dt_factor=0.02), 6e-3, "friction acts at the radius less the overlap, 3.9 m/s cos 50 degrees/omega of "
     "2.5 mm, 1.3 % at most; half of it in the mean"),
    ("tube", {}, 1e-9, "the tolerance of 1e-12 times the 20 weights"),
    ("tube", dict(disks=7, tube_width=2.5), 1e-9, "the same"),
    ("tube", dict(method="MD"), 2e-3, "geometry that changes with the overlaps: the steepness of 20 contacts, each by some 20 m g/(k_n R) = 1e-4"),
    ("mesh_floor", {}, 1e-12, "round-off of 2000 steps"),
    ("mesh_floor", dict(seed=3, corners=300), 1e-12, "the same"),
    ("mesh_floor", dict(method="MD"), 1e-4, "two contacts at an edge, whose normals differ by a sag m g/k_n over R: (5e-6)^(1/2) R of the way, some "
     "100 edges"),
    ("valley", {}, 1e-6, "it touches 1e-6 steps after the middle of one, 1e-6 1 m/s 1e-3 s of the radius of 1e-2 m"),
    ("valley", dict(slope=60.0), 1e-6, "the same"),
    ("filling", dict(method="MD", kn=2e6), 0.032, "the same; its springs are compressed by at most 1e-2 of a radius"),
]


def number(row):
    scene, changes, *_ = row
    return scene + "".join(f"-{name}={value}" for name, value in changes.items())


@pytest.fixture(scope="module")
def measured(yade60):
    """{row: {quantity: [measured, exact, error]}} of all rows, run one after the other in one YADE."""
    rows = {number(row): {"scene": row[0]} | row[1] for row in ROWS}
    return yade60.code(f"""
from yade_scripts import parameters, results, run, scenes
found = {{}}
for name, row in json.loads({json.dumps(json.dumps(rows))}).items():
    full = parameters.complete(row)
    scene = scenes.build(full, "results")
    scenes.method(full).run(scene)
    found[name] = {{known.name: [known.measure(), known.exact, abs(known.measure() - known.exact) / known.scale] for known in scene.known}}
print(json.dumps(found))
""")


@pytest.mark.parametrize("row", ROWS, ids=number)
def test_known_answer(measured, row):
    assert measured[number(row)]
    for name, (found, exact, error) in measured[number(row)].items():
        assert error <= row[2], f"{name} = {found}, exact {exact}; expected within {row[2]:.1g}: {row[3]}"


def test_incline_is_not_at_rest_everywhere(measured):
    """The exact value itself: a slope beyond the friction angle must give g (sin t - mu cos t), downhill."""
    _, exact, _ = measured["incline-slope=-35.0"]["acceleration"]
    t = math.radians(35)
    assert exact == pytest.approx(-G * (math.sin(t) - 0.3 * math.cos(t)), rel=1e-14)


@pytest.mark.parametrize("method, tolerance", [("CD", 1e-9), ("MD", 2e-3)])
def test_sliding_into_rolling_dissipates_a_third_of_the_energy(yade60, method, tolerance):
    """m v0^2/6, from 2/3 v0 at the end. MD's slips are summed at speeds of half a step to a step and a half before, while the slip ends within 0.34
    s: each step is 4e-4 of the work. The tangential spring swings on undamped and keeps 1e-4."""
    with yade60.run(disks=1, scene="slide_to_roll", method=method) as file:
        history = file["history"]
        assert history["kinetic_energy"][0] == pytest.approx(MASS / 2, rel=1e-9)
        assert history["dissipated_energy"][-1] == pytest.approx(MASS / 6, rel=tolerance)
        assert np.isnan(history["gamma"][:]).all() and schema.problems(file) == []


def test_springs_slide_too_far_by_the_speed_they_let_pass(measured):
    """The whole error of the block above the friction angle, as the scene derives it; 3 %: the steps' first order, 1e-5 of 1.7e-3."""
    *_, error = measured["friction_angle-method=MD-margin=0.1-kn=200000000.0"]["above"]
    assert error == pytest.approx((2 * 1.1 / 0.1 - math.pi) / omega(2e8, 0.5), rel=0.03)


def test_springs_sink_by_their_compression(measured):
    """The whole error of the heavy disk on springs: M g/k_n and (M + m) g/k_n."""
    sinking, *_ = measured["heavy_on_light-method=MD-kn=200000000.0"]["sinking"]
    assert sinking == pytest.approx(201 * MASS * G / 2e8, rel=1e-6)


def test_springs_strain_by_the_stiffness_matrix(measured):
    """The exact value is not zero, so the test means something."""
    gamma, exact, _ = measured["elastic_step-method=MD"]["gamma"]
    assert exact < -1e-6 and gamma == pytest.approx(exact, rel=6e-3)


def test_errors_and_where_they_come_from_are_in_the_file(yade60):
    with yade60.run(disks=3, scene="arch", cd_dt=1e-4) as file:
        for known in file["known"].values():
            assert known.attrs["scale"] > 0 and known.attrs["source"] and known.attrs["unit"] == "m"
            assert abs(known[()] - known.attrs["exact"]) < 1e-6 * known.attrs["scale"]


def test_a_run_ends_with_what_is_known(yade60):
    """A scene of rigid contacts warns of nothing."""
    done = yade60.script("run.py", "scene=slide_to_roll", "speed=0.5")
    assert "ContactDynamics:" not in done.stdout + done.stderr
    said = done.stdout.splitlines()
    assert said[-3].startswith("final_speed: 0.3333 m/s, exact 0.3333 m/s, error ") and said[-1].endswith(": finished")


@pytest.mark.parametrize("row, words", [
    (dict(scene="stopping_distance", speed=5.0), "so that the block stops"), (dict(scene="zeno", drop=2.0), "beyond the time of rest"),
    (dict(scene="zeno", restitution=1.0), "restitution below 1"), (dict(scene="cradle", period=1e-3), "to reach each other"),
    (dict(scene="cradle", restitution=0.5, disks=9, period=5.0), "none catches up"), (dict(scene="groove", slope=-10.0), "for a groove"),
    (dict(scene="groove", method="MD", friction=0.9, slope=60.0), "history decides"), (dict(scene="groove", friction=0.59, slope=30.0), "would slip"),
    (dict(scene="arch", friction=0.2), "side disks are apart"), (dict(scene="yield_ramp", yield_strain=0.1), "at most collapse_strain"),
    (dict(scene="pyramid", rows=0), "an integer in"), (dict(scene="hopper", disks=100), "wider than 0.8 of the silo"),
    (dict(scene="two_grain_path", friction=0.0), "needs friction"), (dict(scene="two_grain_path", records_per_cycle=10), "multiple of 4"),
    (dict(scene="two_grain_path", path_angle=1.0), "smaller path_angle"), (dict(scene="frozen_packing", network_seed=0), "frozen_packing: needs"),
    (dict(scene="frozen_packing", warm_start=False), "frozen_packing: needs"), (dict(scene="slide_to_roll", period=0.05), "rolls only after"),
    (dict(method="CD", network_seed=1, warm_start=False), "set warm_start = True"),
    (dict(scene="stack", gravity=0.0), "above 0 in the scene stack"), (dict(scene="groove", friction=0.0), "above 0 in the scene groove")])
def test_rows_without_a_known_answer_are_refused(row, words):
    with pytest.raises(parameters.ParameterError, match=words):
        parameters.complete(row)


def test_the_known_restitution_is_that_of_the_dashpots_in_the_run():
    """exp(-pi beta/sqrt(1 - beta^2)) for beta = 0.1 times 3, and none beyond critical damping."""
    rows = (dict(scene="bounce", method="MD", beta_n=0.1, damping_factor=factor) for factor in (3.0, 20.0))
    assert [parameters.restitution(parameters.complete(row)) for row in rows] == [pytest.approx(0.37231, rel=1e-4), 0]


@pytest.mark.parametrize("row", [dict(scene="drum", gravity=0.5), dict(scene="filling", radius_mean=0.02)])
def test_a_flow_on_another_scale_has_no_known_answer(O, row, tmp_path):
    assert not scenes.build(parameters.complete(row), tmp_path).known


def test_known_scale_must_be_a_size():
    assert scenes.Known("a", "m", -2.0, float).scale == 2 and scenes.Known("a", "m", 0.0, float).scale == 1
    with pytest.raises(ValueError, match="scale = 0"):
        scenes.Known("a", "m", 1.0, float, scale=0)


@pytest.fixture
def known_as(monkeypatch):
    """A function that gives the scene incline other Known, by change(Known) -> list of Known."""
    def give(change, build=scenes.module("incline").build):
        def built(full, folder):
            scene = build(full, folder)
            scene.known = change(*scene.known)
            return scene
        monkeypatch.setattr(scenes.module("incline"), "build", built)
    return give


@pytest.mark.parametrize("measure, words", [
    (lambda: 1 / 0, "failed: known 'acceleration': ZeroDivisionError: division by zero"), (lambda: math.nan, "failed: known 'acceleration' is nan"),
    (lambda: None, "failed: known 'acceleration': TypeError")])
def test_a_run_that_cannot_be_measured_has_failed_and_says_why(O, known_as, tmp_path, measure, words):
    known_as(lambda known: [dataclasses.replace(known, measure=measure)])
    assert run.execute({"scene": "incline"}, tmp_path) == 1
    path = results.path_of(parameters.complete({"scene": "incline"}), tmp_path)
    assert results.status(path).startswith(words) and list(tmp_path.glob("*.h5")) == [path]


@pytest.mark.parametrize("name", ["v/v0", ""])
def test_names_that_no_file_can_hold_are_refused(O, known_as, name):
    known_as(lambda known: [dataclasses.replace(known, name=name)])
    with pytest.raises(parameters.ParameterError, match="take a name without '/'"):
        scenes.build(parameters.complete({"scene": "incline"}), "results")


def test_two_known_of_one_name_are_refused(O, known_as):
    known_as(lambda known: [known, known])
    with pytest.raises(parameters.ParameterError, match="incline returns more than one Known of the name acceleration"):
        scenes.build(parameters.complete({"scene": "incline"}), "results")
