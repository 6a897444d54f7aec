"""Quantities computed from a run: strains, energies, loops, contact forces.

Strains are extension positive and gamma = strain2 - strain1 (eqs. 2-4), so a sample that shortens
along the loaded axis 2 has gamma < 0. SI units.
"""
import numpy as np
from scipy.integrate import trapezoid

from yade_scripts.results import schema
from yade_scripts.errors import ResultError

# A disk whose contacts carry less than this share of the mean normal force counts as a rattler.
RATTLER_SHARE = 1e-3


def loop_width(strain, stress):
    """Return the largest distance in strain between loading and unloading at one stress; loading is up to the maximum."""
    top = int(np.argmax(stress))
    if top in (0, len(stress) - 1):
        return 0.0
    up, down = _rising(stress[:top + 1], strain[:top + 1]), _rising(stress[:top - 1:-1], strain[:top - 1:-1])
    levels = np.union1d(up[0], down[0])
    levels = levels[(levels >= max(up[0][0], down[0][0])) & (levels <= min(up[0][-1], down[0][-1]))]
    return float(np.abs(np.interp(levels, *up) - np.interp(levels, *down)).max(initial=0.0))


def _rising(stress, strain):
    """Return the points at which the stress passes all its values before, as np.interp needs them."""
    highest = np.maximum.accumulate(np.concatenate([[-np.inf], stress[:-1]]))
    keep = stress > highest
    return stress[keep], strain[keep]


def stiffness(gamma, stress, share=0.2):
    """Return the initial slope d sigma2 / d(-gamma) [Pa] by least squares over the first `share` of the load's rise."""
    top = int(np.argmax(stress))
    limit = stress[0] + share * (stress[top] - stress[0])
    part = slice(0, max(3, int(np.argmax(stress[:top + 1] >= limit)) + 1))
    shortening = -(gamma[part] - gamma[0])
    # Regressing strain on stress: the stress is imposed, the strain carries the noise.
    compliance = np.polyfit(stress[part] - stress[0], shortening, 1)[0]
    return 1 / compliance if compliance else np.inf


def start_volume(run):
    """Return L_x0 L_y0 depth [m^3] when the loading begins, around spheres L_x0 L_y0 L_z0."""
    sides = np.diff(run.snapshots[0]["box"].reshape(-1, 2)).ravel()
    return np.prod(sides) * (float(run.attributes["depth"]) if len(sides) == 2 else 1.0)


def wall_work(run):
    """Return the work [J] of the walls on the sample, from stress and strain alone.

    -sigma1 dL_x L_y - sigma2 dL_y L_x, times depth, by the trapezoidal rule. Around spheres x and z are taken to strain alike.
    """
    strain1, strain2 = run.values("strain1"), run.values("strain2")
    across = len(run.snapshots[0]["box"]) // 2 - 1  # directions: 1 around disks, 2 around spheres
    power1 = across * trapezoid(run.values("sigma1") * (1 + strain2) * (1 + strain1)**(across - 1), strain1)
    power2 = trapezoid(run.values("sigma2") * (1 + strain1)**across, strain2)
    return -(power1 + power2) * start_volume(run)


def change(run, name, part=slice(None)):
    """Return the last minus the first value of a history field over the samples `part`: of an energy [J], what was added."""
    values = run.values(name)[part]
    return values[-1] - values[0]


def work_scale(run):
    """Return P0 V0 [J], by which energies are divided to compare samples."""
    return run.pressure * start_volume(run)


def work_error(run):
    """Compare the work of the walls by stress and strain against that summed at every step by force and path: difference over the largest work.

    Two ways to the same number; they differ by the trapezoidal rule over the samples and, under force-loaded walls, by the work that
    went into the walls' own motion.
    """
    summed = run.values("wall_work")
    largest = np.abs(summed).max()
    return (wall_work(run) - (summed[-1] - summed[0])) / largest if largest else np.nan


def balance_error(run, part=slice(None)):
    """Return (work of the walls - stored - kinetic - dissipated energy) over the largest work, in the samples `part`.

    The dissipation is computed independently: by the engine in CD; from friction and dashpots in every step in MD. NaN if the friction was not
    summed, since `dissipated_energy` is then computed from this balance.
    """
    if run.method == "MD" and not np.isfinite(run.history["friction_dissipation"]).all():
        return np.nan
    largest = np.abs(run.values("wall_work")[part]).max()
    found = sum(change(run, name, part) for name in ("stored_energy", "kinetic_energy", "dissipated_energy"))
    missing = change(run, "wall_work", part) - found
    return missing / largest if largest else np.nan


def load(run):
    """Return sigma2/P0 asked for, sample by sample."""
    return run.values("sigma2_goal") / run.pressure


def critical_load(run, threshold):
    """Return sigma2/P0 at which |gamma| first exceeds `threshold`, interpolated between samples; NaN if it never does."""
    gamma = np.abs(run.values("gamma"))
    if not len(above := np.flatnonzero(gamma > threshold)):
        return np.nan
    around = slice(max(0, above[0] - 1), above[0] + 1)
    return float(np.interp(threshold, gamma[around], load(run)[around]))


def stress_error(run):
    """Return the largest |sigma - goal| / P0 over both directions and all samples."""
    return max(np.abs(run.values(name) - run.values(f"{name}_goal")).max() for name in ("sigma1", "sigma2")) / run.pressure


def unconverged_steps(run):
    """Return the steps of a CD run that missed the tolerance, counted over all steps."""
    return int(run.values("unconverged_steps")[-1])


def snapshot_at_load_maximum(run):
    """Return the snapshot at the largest load, and the prescribed sigma2/P0 there, about which the measured stress may oscillate."""
    time, sigma2 = run.values("time"), run.values("sigma2_goal")
    loads = [np.interp(snapshot["time"], time, sigma2) for snapshot in run.snapshots]
    best = int(np.argmax(loads))
    if loads[best] < sigma2.max() - 0.02 * np.ptp(sigma2):
        raise ResultError(run.path, f"no snapshot near the load maximum, the nearest has sigma2 = {loads[best]:.6g} Pa of "
                          f"{sigma2.max():.6g} Pa", "run it again")
    return run.snapshots[best], loads[best] / run.pressure


def sliding(snapshot):
    return schema.is_sliding(snapshot["force_normal"], snapshot["force_tangential"], snapshot["contact_friction"])


def rattlers(snapshot):
    """Return the mask of the disks that carry no contact force, or a negligible one (RATTLER_SHARE)."""
    force = snapshot["force_normal"]
    loaded = force > RATTLER_SHARE * force[force > 0].mean() if (force > 0).any() else force > 0
    return ~np.isin(snapshot["body_ids"], snapshot["contact_ids"][loaded])


def matched_forces(first, second):
    """Return the normal forces [N] of two snapshots, contact by contact, over the contacts that carry in either.

    Contacts are matched by the ids of their bodies; one that the other snapshot lacks has force 0 there.
    """
    tables = [{tuple(sorted(ids)): force for ids, force in zip(snapshot["contact_ids"].tolist(), snapshot["force_normal"])}
              for snapshot in (first, second)]
    keys = sorted(tables[0].keys() | tables[1].keys())
    forces = np.array([[table.get(key, 0.0) for key in keys] for table in tables])
    return forces[:, (forces > 0).any(axis=0)]


def coordination(snapshot):
    """Return the mean number of loaded contacts on a disk that is no rattler; contacts with walls count once, those between disks twice."""
    loaded, held = snapshot["force_normal"] > 0, ~rattlers(snapshot)
    touching = np.isin(snapshot["contact_ids"][loaded], snapshot["body_ids"][held]).sum()
    return touching / held.sum() if held.any() else 0.0
