"""The triaxial test with 60 spheres: stresses on all sides, one cycle by three methods, the static limit, and what the scene refuses."""
import numpy as np
import pytest

from analysis import observables
from yade_scripts import parameters
from yade_scripts.errors import ParameterError
from yade_scripts.theory import cone_limits

CYCLE = dict(scene="triaxial", loading="cosine", delta_sigma=0.1, records_per_cycle=50)
METHODS = {"MD": dict(method="MD", md_walls="force"), "springs": dict(method="CD", cd_contacts="springs"), "rigid": dict(method="CD")}


@pytest.fixture(scope="module")
def cycles(yade60):
    return {name: yade60.load(**CYCLE | row) for name, row in METHODS.items()}


def test_the_packing_rests_under_one_stress(cycles):
    """Prepared to 1e-7 of P0 on each of six walls, and the forces on each sphere balance: their sum over all contacts, by the stored arrays alone."""
    run = cycles["MD"]
    packing = run.snapshots[0]
    assert packing["position"].shape == (60, 3) and packing["box"].shape == (6,)
    x, y, z = np.diff(packing["box"].reshape(3, 2)).ravel()
    force = packing["force_normal"][:, None] * packing["contact_normal"] + packing["force_tangential"]  # on the second body
    for axis, area in enumerate((y * z, x * z, x * y)):
        for wall in (2 * axis, 2 * axis + 1):
            on_wall = sum(f[axis] * (1 if ids[1] == wall else -1) for ids, f in zip(packing["contact_ids"], force) if wall in ids)
            assert abs(on_wall) == pytest.approx(run.pressure * area, rel=1e-6)
    resultant = np.zeros((66, 3))
    np.add.at(resultant, packing["contact_ids"][:, 1], force)
    np.add.at(resultant, packing["contact_ids"][:, 0], -force)
    assert np.abs(resultant[6:]).max() < 1e-5 * packing["force_normal"].mean()


def test_springs_strain_alike_in_both_methods_and_rigid_grains_rest(cycles):
    """The same springs under the same slow load. A step of CD is a 375th of the cycle: its strain lags by less than 2 % in the plane, too."""
    largest = {name: np.abs(run.values("gamma")).max() for name, run in cycles.items()}
    assert largest["springs"] == pytest.approx(largest["MD"], rel=0.02)
    assert largest["rigid"] < 1e-3 * largest["MD"]
    assert cycles["rigid"].values("unconverged_steps")[-1] == 0


def test_stresses_are_those_asked_for(cycles):
    """sigma1 is the mean of x and z."""
    for run in cycles.values():
        assert np.abs(run.values("sigma2") - run.values("sigma2_goal")).max() < 0.01 * run.pressure
        assert np.abs(run.values("sigma1") - run.pressure).max() < 0.01 * run.pressure
        assert run.values("sigma2_goal").max() == pytest.approx(1.1 * run.pressure, rel=1e-3)


def test_servo_and_force_loaded_walls_agree(yade60, cycles):
    """YADE's TriaxialStressController holds all three stresses; free walls have inertia, 2 % of gamma in the plane."""
    servo = yade60.load(**CYCLE, method="MD", md_walls="servo")
    assert np.abs(servo.values("sigma1") - servo.pressure).max() < 5e-3 * servo.pressure
    assert np.abs(servo.values("gamma")).max() == pytest.approx(np.abs(cycles["MD"].values("gamma")).max(), rel=0.05)


def test_work_of_the_walls_is_stored_kept_or_dissipated(cycles):
    """Rigid contacts store nothing. By springs in CD the numerical damping is part of what is lost; MD's springs sum friction and dashpots step by
    step, to the order of the step."""
    for name, error in (("rigid", 1e-6), ("springs", 1e-6), ("MD", 1e-3)):
        run = cycles[name]
        held, lost = run.values("stored_energy") + run.values("kinetic_energy"), run.values("dissipated_energy")[-1]
        assert run.values("wall_work")[-1] - (held[-1] - held[0]) == pytest.approx(lost, rel=error), name


def test_work_by_stress_and_strain_is_that_by_force_and_path(cycles):
    """But for the trapezoidal rule, and since x and z do not strain quite alike. Rigid grains strain too little to compare."""
    for name in ("springs", "MD"):
        assert observables.work_error(cycles[name]) == pytest.approx(0, abs=0.02), name


def test_rigid_grains_wait_for_the_static_limit(yade60):
    """The limit bounds the load from above. 60 spheres between smooth walls: once the load exceeds it, the sample must strain."""
    run = yade60.load(scene="triaxial", loading="ramp", cycles=8, records_per_cycle=50, method="CD")
    below, above = cone_limits.limit_load(run.snapshots[0], run.pressure)
    load, gamma = run.values("sigma2_goal") / run.pressure, np.abs(run.values("gamma"))
    assert 1.05 < below <= above < below * (1 + 2 * cone_limits.SHARPNESS)  # the load grows less than friction does
    # A tenth of a per cent of strain takes the walls' mass a time in which this ramp rises by 0.05.
    assert gamma[load < 0.9 * below].max() < 1e-5 and gamma[load > above + 0.05].min() > 1e-4


@pytest.mark.parametrize("row, words", [(dict(stress_path="mean"), "stress_path = mean"), (dict(network_seed=1, method="CD"), "network_seed = 1"),
                                        (dict(tangential_law="path_independent"), "tangential_law = path_independent")])
def test_what_it_cannot_do_is_refused(row, words):
    with pytest.raises(ParameterError, match=words):
        parameters.complete(dict(scene="triaxial") | row)
