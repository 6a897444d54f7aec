"""Computes how far contacts slip: from the relative motion of the surfaces, not from how near the forces are to Coulomb's limit.

A contact at the limit need not slip: in a packing at rest a quarter of the contacts may be at the limit and not slip (study `continued`).
"""
import numpy as np

from yade_scripts import parameters


def between(first, second, tangential_stiffness):
    """Return {ids: slip [m]} between two snapshots, of the contacts between disks that are loaded in both and have friction.

    The sign is along the normal turned by +90 degrees. The slip is the relative displacement of the surfaces minus the change of the spring's
    stretch, which is 0 for rigid contacts (infinite tangential_stiffness, [N/m]). First order in the motion between the snapshots.
    """
    disk = {body: k for k, body in enumerate(first["body_ids"].tolist())}
    places = [{tuple(ids): k for k, ids in enumerate(snapshot["contact_ids"].tolist()) if snapshot["force_normal"][k] > 0}
              for snapshot in (first, second)]
    found = [ids for ids, k in places[0].items() if ids in places[1] and first["contact_friction"][k] > 0 and all(body in disk for body in ids)]
    if not found:
        return {}
    old, new = (np.array([place[ids] for ids in found]) for place in places)
    one, two = np.array([[disk[body] for body in ids] for ids in found]).T
    normal = first["contact_normal"][old] + second["contact_normal"][new]
    tangent = np.stack([-normal[:, 1], normal[:, 0]], axis=1) / np.linalg.norm(normal, axis=1)[:, None]
    moved = second["position"] - first["position"]
    turned = (second["angle"] - first["angle"] + np.pi) % (2 * np.pi) - np.pi
    arms = [np.linalg.norm(first["contact_point"][old] - first["position"][body], axis=1) for body in (one, two)]
    surfaces = np.sum((moved[two] - moved[one]) * tangent, axis=1) - arms[0] * turned[one] - arms[1] * turned[two]
    # The force on the second disk is against the stretch of the spring.
    stretch = (first["force_tangential"][old] - second["force_tangential"][new]) / tangential_stiffness
    return dict(zip(found, surfaces - stretch))


def work(run, first, second):
    """Return the work against friction between two snapshots [J]: the sum of mu times the mean normal force times the slip."""
    before, after = ({tuple(ids): k for k, ids in enumerate(snapshot["contact_ids"].tolist())} for snapshot in (first, second))
    return sum(first["contact_friction"][before[ids]] * (first["force_normal"][before[ids]] + second["force_normal"][after[ids]]) / 2 * abs(slip)
               for ids, slip in between(first, second, stiffness_of(run)).items())


def stiffness_of(run):
    """Return the tangential stiffness of the contacts of a run [N/m]; infinite for rigid ones."""
    rigid = run.method == "CD" and run.parameters["cd_contacts"] == "rigid"
    return np.inf if rigid else run.parameters["kt_over_kn"] * parameters.stiffness(run.parameters)


def of(run):
    """Return what `over` does, from snapshot to snapshot of the whole run."""
    return over(run, zip(run.snapshots[:-1], run.snapshots[1:]))


def over(run, pairs):
    """Return (slip of a contact over pairs of snapshots of a run, in mean radii; number of contacts that share the slip).

    The absolute slips between snapshots are added up for each contact, then averaged over the contacts. The number of contacts that share the slip is
    (sum of s)^2 over the sum of s^2: 1 if one contact slips alone, and the number of contacts if all slip equally.
    """
    total = {}
    for first, second in pairs:
        for ids, slip in between(first, second, stiffness_of(run)).items():
            total[ids] = total.get(ids, 0.0) + abs(slip)
    values = np.array(list(total.values()))
    if not values.any():
        return 0.0, 0.0
    return float(values.mean() / run.parameters["radius_mean"]), float(values.sum()**2 / (values**2).sum())
