"""Other force networks for grains that do not move: the walk over a frozen packing, and starts of the biaxial test from it."""
import numpy as np
import pytest

from yade_scripts.theory import statics
from analysis.studies import indeterminacy


@pytest.fixture(scope="module")
def walk(yade60):
    return yade60.load(scene="frozen_packing", records_per_cycle=60)


def balance(run):
    """Loads of the walls [N] under P0."""
    return statics.wall_loads(run.snapshots[0], (run.pressure, run.pressure), run.attributes["depth"])


def test_every_network_of_the_walk_is_admissible(walk):
    """By statics of its own. 1e-6 of the mean force: the tolerance 1e-10 times what a resultant gathers of it, measured 3e-8."""
    found = statics.violations(walk.snapshots[0], walk.extra["normal"], walk.extra["tangential"], balance(walk))
    assert walk.extra["converged"].all() and found.shape == (60, 3)
    assert found.max() < 1e-6
    cold = statics.violations(walk.snapshots[0], walk.extra["cold_normal"], walk.extra["cold_tangential"], balance(walk))
    assert cold.max() < 1e-6


def test_friction_leaves_the_forces_open(walk):
    """As many freedoms as unknowns less equations; an ambiguity far above the solver's floor of 1e-6."""
    loaded = (walk.extra["normal"] > 0).any(axis=0)
    row, = indeterminacy.summarize([walk])
    assert row["dimension"] == statics.degrees_of_freedom(walk.snapshots[0], loaded)[2] > 10
    assert 0.05 < row["eta"] < 0.5 and row["used"] == 60


def test_the_walk_stays_within_what_linear_programmes_allow(walk):
    normal, snapshot = walk.extra["normal"], walk.snapshots[0]
    slack = 1e-6 * normal.mean()  # as above
    for contact in range(0, normal.shape[1], 12):
        least, largest = statics.force_range(snapshot, balance(walk), contact)
        assert least - slack <= normal[:, contact].min() and normal[:, contact].max() <= largest + slack
        assert least - slack <= snapshot["force_normal"][contact] <= largest + slack


def test_frozen_means_not_a_bit_has_moved(walk):
    first, last = walk.snapshots[0], walk.snapshots[-1]
    for name in ("position", "angle", "box"):
        np.testing.assert_array_equal(first[name], last[name])
    assert not walk.history["gamma"].any() and not walk.history["kinetic_energy"].any()


def test_without_friction_near_the_rigid_limit_forces_are_determinate(yade60):
    """Isostatic: as many unknowns as equations. eta is then the solver's floor: tolerance 1e-10, measured 1e-6 and below."""
    run = yade60.load(scene="frozen_packing", records_per_cycle=20, friction=0, stiffening=1000)
    row, = indeterminacy.summarize([run])
    assert row["dimension"] == 0 and row["eta"] < 1e-5


@pytest.fixture(scope="module")
def others(yade60):
    """Short CD loads from the springs' own network and from two others."""
    row = dict(method="CD", records_per_cycle=4, period=0.1, tolerance=1e-9)
    return [yade60.load(**row, network_seed=seed) for seed in (0, 1, 2)]


def test_a_run_starts_from_another_network_of_the_same_grains(others):
    own, *rest = (run.snapshots[0] for run in others)
    for other in rest:
        np.testing.assert_array_equal(own["position"], other["position"])
        np.testing.assert_array_equal(own["angle"], other["angle"])
        assert np.abs(other["force_normal"] - own["force_normal"][:len(other["force_normal"])]).max() > 0.1 * own["force_normal"].mean()
    np.testing.assert_array_less(1e-3, np.abs(rest[0]["force_normal"] - rest[1]["force_normal"]).max())


def test_the_other_network_is_admissible_where_the_run_starts(others):
    """At the load of the middle of the first step, 2 dt/t0 dSigma/2 above P0 on walls y; tolerance 1e-9 of the impulses."""
    for run in others[1:]:
        first, row = run.snapshots[0], run.parameters
        sigma2 = run.pressure * (1 + row["delta_sigma"] * row["cd_dt"] / row["period"])
        found = statics.violations(first, first["force_normal"], first["force_tangential"],
                                   statics.wall_loads(first, (run.pressure, sigma2), run.attributes["depth"]))
        assert found.max() < 1e-5


def test_networks_survive_the_warm_start(others):
    """After the first steps the forces are still those of the own network, not again the springs': memory is what the study varies."""
    own, other = others[0], others[1]
    start, later = (np.abs(own.snapshots[k]["force_normal"].sum() - other.snapshots[k]["force_normal"].sum()) for k in (0, 1))
    assert later > 0.1 * start


def test_no_network_found_is_a_failed_run(yade60):
    with yade60.run(method="CD", network_seed=1, max_iterations=1, period=0.1, records_per_cycle=2) as file:
        assert file.attrs["status"].startswith("failed: network_seed = 1: no admissible network found")
