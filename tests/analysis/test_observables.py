"""Observables on curves and networks whose answers are known."""

import numpy as np
import pytest

from analysis import observables
from yade_scripts.results import reader, schema
from tests.analysis.conftest import SIDE, history, lattice, write

# Areas by polygons and widths by interpolation differ from the smooth curve's by about (2 pi/points)^2.
POINTS = 2001
SMOOTH = (2 * np.pi / POINTS)**2 * 2


SHARE = np.linspace(0, 1, 201)  # of the made-up history


def changed(path, method="MD", **columns):
    """A run of the made-up history with other columns."""
    return reader.load(write(path, method, history(method) | columns))


def ellipse(a, b):
    """A closed ellipse of half axes a (strain) and b (stress), counter-clockwise from its lowest point."""
    angle = np.linspace(0, 2 * np.pi, POINTS) - np.pi / 2
    return a * np.cos(angle), b * np.sin(angle)


def test_loop_width_of_an_ellipse():
    assert observables.loop_width(*ellipse(3e-4, 0.1)) == pytest.approx(6e-4, rel=SMOOTH)


def test_loop_width_of_an_elastic_path_is_zero():
    stress = 1 - np.abs(np.linspace(-1, 1, 101))
    assert observables.loop_width(-1e-3 * stress, stress) == pytest.approx(0, abs=1e-18)


def test_loop_width_needs_an_unloading():
    stress = np.linspace(0, 1, 11)
    assert observables.loop_width(stress, stress) == 0


def test_numbers_of_the_made_up_cycle(md):
    run = reader.load(md)
    assert observables.change(run, "dissipated_energy") == pytest.approx(2e-3)
    assert observables.stress_error(run) == pytest.approx(1.2e-4)


def test_wall_work_of_an_isotropic_compression_is_exact(tmp_path):
    """At constant pressure the work is P0 times the loss of area, whatever the path."""
    run = changed(tmp_path / "run.h5", strain1=-0.1 * SHARE, strain2=-0.2 * SHARE, sigma2=np.full(len(SHARE), 1200.0))
    assert observables.wall_work(run) == pytest.approx(1200 * SIDE**2 * (1 - 0.9 * 0.8), rel=1e-12)


def test_wall_work_of_the_made_up_cycle(md):
    """sigma1 = P0 and strain1 = -strain2, so the work is the integral of sigma2 - P0 over gamma/2, to first order in strain."""
    expected = -0.5e-3 * 1200 * 0.2 * SIDE**2 * (-2 / 3 + 3 / 8)
    assert observables.wall_work(reader.load(md)) == pytest.approx(expected, rel=1e-3)


def test_stiffness_of_a_linear_response():
    stress = np.concatenate([np.linspace(1000, 1200, 50), np.linspace(1200, 1000, 50)])
    gamma = -(stress - 1000) / 5e6
    assert observables.stiffness(gamma, stress) == pytest.approx(5e6, rel=1e-9)
    assert observables.stiffness(0 * gamma, stress) == np.inf


def test_snapshot_at_the_load_maximum(md):
    snapshot, load_ratio = observables.snapshot_at_load_maximum(reader.load(md))
    assert (snapshot["time"], load_ratio) == (0.5, pytest.approx(1.2 * (1 + 1e-4)))  # of the goal


def test_no_snapshot_at_the_load_maximum(tmp_path):
    run = reader.load(write(tmp_path / "run.h5", snapshots={time: lattice(5, "MD") for time in (0.0, 1.0)}))
    with pytest.raises(reader.ResultError, match="no snapshot near the load maximum"):
        observables.snapshot_at_load_maximum(run)


def test_sliding_needs_friction_and_a_force():
    mu = np.array([0.1, 0.1, 0.1, 0.1, 0.0, 0.1])
    normal = np.array([10.0, 10.0, 10.0, 0.0, 10.0, -1.0])
    tangential = np.array([1.0, -1.0, 0.999, 0.0, 0.0, 0.1])
    np.testing.assert_array_equal(schema.is_sliding(normal, tangential, mu), [True, True, False, False, False, False])


def test_rattlers_carry_nothing():
    snapshot = dict(body_ids=np.array([6, 7, 8, 9]), contact_ids=np.array([[6, 7], [2, 6], [7, 8]]),
                    force_normal=np.array([5.0, 5.0, 1e-6]))
    np.testing.assert_array_equal(observables.rattlers(snapshot), [False, False, True, True])
    snapshot["force_normal"] = np.zeros(3)
    assert observables.rattlers(snapshot).all()


def test_forces_are_matched_by_bodies():
    first = dict(contact_ids=np.array([[1, 2], [2, 3], [5, 6]]), force_normal=np.array([1.0, 2.0, 0.0]))
    second = dict(contact_ids=np.array([[3, 2], [4, 1], [5, 6]]), force_normal=np.array([20.0, 30.0, 0.0]))
    np.testing.assert_array_equal(observables.matched_forces(first, second), [[1, 0, 2], [0, 30, 20]])



def energies(folder, method, name, dissipated):
    """A run in which the walls do 1 J of work, 0.25 J are stored, 0.05 J move, and the history field `name` counts `dissipated` J."""
    return changed(folder / f"{method}.h5", method, wall_work=SHARE, stored_energy=0.25 * SHARE, kinetic_energy=0.05 * SHARE,
                   **{name: dissipated * SHARE})


def test_balance_error_takes_what_was_summed_where_it_happened(tmp_path):
    assert observables.balance_error(energies(tmp_path, "CD", "dissipated_energy", 0.7)) == pytest.approx(0, abs=1e-15)
    assert observables.balance_error(energies(tmp_path, "CD", "dissipated_energy", 0.6)) == pytest.approx(0.1)
    assert observables.balance_error(energies(tmp_path, "MD", "dissipated_energy", 0.6)) == pytest.approx(0.1)
    assert np.isnan(observables.balance_error(energies(tmp_path, "MD", "friction_dissipation", np.nan)))  # then the rest is no check


def test_work_error_compares_two_ways_to_the_work(tmp_path):
    """Isotropic compression at P0 by a tenth of the area does the work P0 dA; the history states a tenth more."""
    run = changed(tmp_path / "run.h5", strain1=-0.1 * SHARE, strain2=0 * SHARE, sigma2=np.full(len(SHARE), 1200.0),
                  wall_work=1.1 * 1200 * SIDE**2 * 0.1 * SHARE)
    assert observables.work_error(run) == pytest.approx(-0.1 / 1.1, rel=1e-9)
    assert observables.work_scale(run) == pytest.approx(1200 * SIDE**2)


def test_critical_load_is_interpolated(tmp_path):
    run = changed(tmp_path / "run.h5", gamma=-0.01 * SHARE, sigma2_goal=1200 * (1 + SHARE))
    # A straight line, which interpolation meets exactly.
    assert observables.critical_load(run, 0.00333) == pytest.approx(1.333, rel=1e-12)
    assert np.isnan(observables.critical_load(run, 0.02))


def test_coordination_leaves_rattlers_out():
    """A triangle of disks, one of which also leans on a wall; a fourth disk carries nothing."""
    snapshot = dict(body_ids=np.array([6, 7, 8, 9]), contact_ids=np.array([[6, 7], [7, 8], [6, 8], [2, 6], [8, 9]]),
                    force_normal=np.array([1.0, 1.0, 1.0, 1.0, 0.0]))
    assert observables.coordination(snapshot) == pytest.approx(7 / 3)
