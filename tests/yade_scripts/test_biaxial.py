"""Runs of the biaxial test with 60 disks: boundary conditions, energy, and runs that must fail."""
import numpy as np
import pytest
from scipy.integrate import trapezoid

from analysis import observables, slip
from yade_scripts import parameters

QUICK = dict(loading="cosine", period=1.0, records_per_cycle=50)


def test_servo_and_force_loaded_walls_agree(yade60):
    """Two ways to put the same stress on the same packing. At t0 = 1 s the walls' inertia changes gamma by 2 % (400 disks)."""
    servo, force = (yade60.run(method="MD", md_walls=walls, **QUICK)["history"] for walls in ("servo", "force"))
    for history in (servo, force):
        assert np.abs(history["sigma2"][:] - history["sigma2_goal"][:]).max() < 2e-3 * 1200
        assert np.abs(history["sigma1"][:] - 1200).max() < 2e-3 * 1200
        assert history["sigma2_goal"][:].max() == pytest.approx(1440, rel=1e-4)
    assert servo["gamma"][:].min() < -1e-4
    assert force["gamma"][:].min() == pytest.approx(servo["gamma"][:].min(), rel=0.05)


def test_energy_of_md_is_balanced(yade60):
    """Dissipation never falls by more than the work done in a step, and over the closed cycle it is the area of the loops."""
    history = yade60.run(method="MD", md_walls="servo", **QUICK)["history"]
    dissipated, work, stored = (history[name][:] for name in ("dissipated_energy", "wall_work", "stored_energy"))
    assert np.diff(dissipated).min() > -1e-3 * dissipated[-1]
    assert dissipated[-1] == pytest.approx(work[-1] - (stored[-1] - stored[0]), rel=1e-3)
    volume = 0.1565 * 0.1547  # sides of the packing [m] times the depth of 1 m
    loops = -sum(trapezoid(history[f"sigma{k}"][:], history[f"strain{k}"][:]) for k in (1, 2)) * volume
    assert work[-1] == pytest.approx(loops, rel=0.02)


def test_contact_dynamics_hardly_strains_below_yield(yade60):
    """Rigid grains below yield: what strain there is comes from the solver's tolerance, and falls with it."""
    coarse, fine = (yade60.run(method="CD", tolerance=tolerance, cd_dt=2e-3, **QUICK)["history"] for tolerance in (1e-5, 1e-8))
    assert fine["unconverged_steps"][-1] == 0 and fine["residual_max"][:].max() <= 1e-8
    assert 0 < np.abs(fine["gamma"][:]).max() < 0.05 * np.abs(coarse["gamma"][:]).max() < 1e-5
    assert fine["dissipated_energy"][-1] == pytest.approx(fine["wall_work"][-1] - fine["kinetic_energy"][-1], rel=1e-6)
    assert np.abs(fine["sigma2"][:] - fine["sigma2_goal"][:]).max() < 1e-3 * 1200


def test_a_collapse_is_a_result(yade60):
    """Without friction the sample cannot carry sigma2 = 2 P0: it gives way until the strain passes collapse_strain."""
    row = dict(method="MD", friction=0, delta_sigma=1, period=2)
    file = yade60.run(**row)
    assert file.attrs["finished"] and file.attrs["outcome"].startswith("collapsed: ")
    assert abs(file["history/gamma"][-1]) > 0.2 and file["history/cycle"][-1] < 0.5
    assert len(file["snapshots"]) > 2 and file["snapshots/0"].attrs["time"] == 0
    assert file[f"snapshots/{len(file['snapshots']) - 1}"].attrs["cycle"] == file["history/cycle"][-1]  # where it gave way
    assert not list((yade60.folder / "results").glob("*.partial.h5"))


@pytest.mark.parametrize("walls", [dict(md_load_every=1), dict(md_walls="force")])
@pytest.mark.parametrize("law, dashpots", [("standard", 0.0), ("path_independent", 0.0), ("standard", 1.0), ("path_independent", 1.0)])
def test_energy_balance_of_springs_closes(yade60, law, dashpots, walls):
    """Work of the walls = stored + kinetic + friction + dashpots, each summed by itself, to a thousandth of what is dissipated."""
    file = yade60.run(method="MD", loading="cosine", period=1, tangential_law=law, tangential_damping=dashpots, **walls)
    history = {name: values[:] for name, values in file["history"].items()}
    gone = history["dissipated_energy"]
    missing = history["wall_work"] - gone - sum(history[name] - history[name][0] for name in ("kinetic_energy", "stored_energy"))
    assert 1e-5 < history["friction_dissipation"][-1] < gone[-1]
    assert np.abs(missing).max() < 1e-3 * gone[-1]


def test_without_sums_the_motion_is_the_same(yade60):
    """md_energies=False: every bit of the motion as with the sums; the dissipated energy is unknown."""
    row = dict(method="MD", loading="cosine", period=0.5, md_walls="force")
    summed, quiet = (yade60.run(**row, md_energies=sums)["history"] for sums in (True, False))
    for name in ("gamma", "sigma2", "kinetic_energy", "stored_energy", "wall_work"):
        assert np.array_equal(summed[name][:], quiet[name][:]), name
    assert all((np.diff(history["processor_time"][:]) > 0).all() for history in (summed, quiet))  # though samples do not count
    assert all(np.isnan(quiet[name][:]).all() and np.isfinite(summed[name][:]).all() for name in ("friction_dissipation", "dissipated_energy"))


@pytest.mark.parametrize("walls", ["force", "servo"])
def test_damping_of_the_loading_leaves_the_packing_alone(yade60, walls):
    """damping_factor: the same prepared packing, another loss of energy in dashpots while it is loaded."""
    row = dict(method="MD", loading="cosine", period=0.2, md_walls=walls)
    usual, strong = (yade60.run(**row, damping_factor=factor) for factor in (1.0, 5.0))
    assert strong.attrs["finished"]
    assert usual.attrs["state_sha256"] == strong.attrs["state_sha256"]
    assert np.array_equal(usual["snapshots/0/position"][:], strong["snapshots/0/position"][:])
    in_dashpots = [file["history/dissipated_energy"][-1] - file["history/friction_dissipation"][-1] for file in (usual, strong)]
    assert in_dashpots[1] > 2 * in_dashpots[0] > 0


def test_slip_times_the_force_is_what_friction_dissipates(yade60):
    """Two ways to one number: increments of motion and force between snapshots, and the sum that the law makes in every step."""
    run = yade60.load(method="MD", period=1.0, delta_sigma=0.3)
    stiffness, work = run.parameters["kt_over_kn"] * parameters.stiffness(run.parameters), 0.0
    for first, second in zip(run.snapshots[:-1], run.snapshots[1:]):
        limit = {tuple(ids): mu * force for ids, mu, force in zip(first["contact_ids"].tolist(), first["contact_friction"], first["force_normal"])}
        work += sum(limit[ids] * abs(value) for ids, value in slip.between(first, second, stiffness).items())
    # 40 snapshots: the limit changes by a fortieth between them, and a slip to and fro within one interval does not show.
    assert work == pytest.approx(observables.change(run, "friction_dissipation"), rel=0.1)


def test_a_load_the_walls_cannot_follow_is_a_failure(yade60):
    """In 20 ms sound has hardly crossed the sample, heavy walls have not moved: no collapse, and no result."""
    row = dict(method="MD", md_walls="force", wall_mass_ratio=1e5, period=0.02, delta_sigma=0.5)
    done = yade60.script("run.py", "disks=60", *(f"{name}={value}" for name, value in row.items()))
    assert done.returncode == 1
    assert "wall stress off its goal" in done.stderr and "Traceback" not in done.stderr
    file = yade60.run(**row)
    assert file.attrs["status"].startswith("failed: wall stress off") and file.attrs["outcome"] == "failed" and not file.attrs["finished"]
    assert len(file["history/time"]) > 5


def test_stiffer_contacts_same_grains(yade60):
    """Settled again under the same P0: overlaps shrink by the factor, the solid fraction falls by little more than the overlaps took."""
    soft, stiff = (yade60.prepare("disks=60", f"stiffening={factor}")[1] for factor in (1, 30))
    assert stiff["sigma"] == pytest.approx(soft["sigma"], rel=1e-6)
    # The mean overlap is about P0/k_n = 6e-4 of a diameter, hence 1.2e-3 in area; a few grains find a new place.
    assert 0 < soft["solid_fraction"] - stiff["solid_fraction"] < 3e-3


def test_walls_with_friction_carry_shear(yade60):
    state, _ = yade60.prepare("disks=60", "wall_friction=0.3")
    friction, shear = yade60.code(f"""
from yade import O
O.load({str(state)!r})
contacts = [i for i in O.interactions if i.isReal and i.id1 < 6]
print([max(i.phys.tangensOfFrictionAngle for i in contacts), max(i.phys.shearForce.norm() for i in contacts)])
""")
    assert friction == pytest.approx(0.1)  # the smaller of wall and disk
    assert shear > 0


def test_locked_walls_are_no_shakedown(yade60):
    """The trap of the servo: with strong dashpots and its usual damping the walls flip for ever and gamma stays. It must fail;
    the damping that walls.servo chooses keeps the same row sound."""
    locked, sound = yade60.code("""
from yade import O
from yade_scripts import parameters, scenes
from yade_scripts.running import recorder, wall_check
said = []
for damping in (0.25, None):
    full = parameters.complete({"method": "MD", "disks": 60, "beta_n": 0.5, "period": 0.4, "records_per_cycle": 40})
    scene = scenes.build(full, "results")
    if damping is not None:
        scene.load.controller.stressDamping = damping
    sampler = recorder.Recorder(f"locked-{damping}.h5", full, scene)
    scene.observer = sampler.sample
    try:
        scenes.method(full).run(scene)
        said.append("finished")
    except wall_check.StressError as error:
        said.append(str(error))
print(json.dumps(said))
""")
    assert "wall stress off its goal" in locked
    assert sound == "finished"


def test_row_of_a_yade_batch_table(yade60):
    table = yade60.folder / "table.txt"
    table.write_text("description disks method period records_per_cycle wrong\na 60 MD 0.02 2 1\n")
    done = yade60.script("run.py", YADE_BATCH=f"{table}:2")
    assert done.returncode == 2 and "unknown parameter 'wrong'" in done.stderr
    table.write_text("description disks method period records_per_cycle\na 60 'MD' 0.03 2\n")
    done = yade60.script("run.py", YADE_BATCH=f"{table}:2")
    assert done.returncode == 0, done.stderr
    with yade60.run(method="MD", period=0.03, records_per_cycle=2) as file:
        assert file.attrs["finished"]
