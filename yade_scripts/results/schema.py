"""The fields of a result file: every name, unit and meaning.

The recorder writes according to these tables and the reader checks against them. One run is one HDF5 file. Its root attributes describe the run,
`/history/<name>` is a 1-D array for each quantity (all of the same length, unit in the attribute `unit`), `/snapshots/<k>/` is the whole sample at
one instant. A finished run may also hold `/known/<name>`, a measured number with the attributes of KNOWN, and `/extra/<name>`, arrays that
only its scene has, with `unit` and `doc`.

Conventions: axis 1 is x and axis 2 is y; of spheres, which are loaded along z, too, what is said of axis 1 is the mean of x and z, vectors have three
columns, and tangential forces and rotations are vectors. Stress is compression positive and measured on the walls. Strain is extension positive.
Equations are those of Garcia-Rojo, McNamara and Herrmann (2004).
"""
from dataclasses import dataclass

import numpy as np

SCHEMA_VERSION = 4
METHODS = ("MD", "CD")
STATUS_FINISHED = "finished"
STATUS_FAILED, STATUS_UNSTABLE = "failed: ", "unstable: "  # followed by the reason; of cd_engine.watch
OUTCOME_COMPLETED, OUTCOME_FAILED = "completed", "failed"
OUTCOME_UNSTABLE = "unstable: "  # followed by the step that would do
OUTCOME_COLLAPSED = "collapsed: "  # followed by what was seen; the sample gave way, which is a result


@dataclass(frozen=True)
class Field:
    """One quantity of a result file. `methods` are those whose files hold it."""
    name: str
    unit: str
    doc: str
    methods: tuple = METHODS


def _table(*fields):
    return {field.name: field for field in fields}


HISTORY = _table(
    Field("time", "s", "time since the start of the loading"),
    Field("cycle", "1", "time over the period of the loading; whole at the end of a cycle"),
    Field("sigma1", "Pa", "stress on the x walls, force over area"),
    Field("sigma2", "Pa", "stress on the y walls, force over area"),
    Field("strain1", "1", "L_x/L_x0 - 1; eq. 2 writes L_x/L_x0, which leaves gamma the same"),
    Field("strain2", "1", "L_y/L_y0 - 1; eq. 3 likewise"),
    Field("gamma", "1", "strain2 - strain1, eq. 4; negative when the sample shortens along y"),
    Field("contacts", "1", "contacts that carry a force, walls included"),
    Field("sliding_contacts", "1", "contacts at the Coulomb limit, see is_sliding"),
    Field("kinetic_energy", "J", "translation and rotation of the disks and of moving walls"),
    Field("dissipated_energy", "J", "dissipated since the start by friction, damping and impacts; NaN without md_energies"),
    Field("unbalanced_force", "1", "mean resultant on a body over mean contact force"),
    Field("max_penetration", "m", "largest overlap; in CD that of the last step, beyond the reference overlap of the start"),
    Field("wall_clock", "s", "computing time since the start of the run"),
    Field("processor_time", "s", "processor time since the start of the run, of all threads, without samples and measurements of known quantities"),
    Field("iterations", "1", "sweeps and factorizations of the step, the most on one island", methods=("CD",)),
    Field("residual", "1", "error e of the step's contact problem", methods=("CD",)),
    Field("sigma1_goal", "Pa", "sigma1 the loading asks for"),
    Field("sigma2_goal", "Pa", "sigma2 the loading asks for, eq. 1 or 7"),
    Field("wall_work", "J", "work of the wall loads on the sample since the start"),
    Field("stored_energy", "J", "elastic energy of the contacts; 0 for rigid ones"),
    Field("friction_dissipation", "J", "part of dissipated_energy that went into slips; the rest went into dashpots; NaN without md_energies and "
          "where contacts with walls slip under another law than those between disks", methods=("MD",)),
    Field("residual_max", "1", "largest error e of all steps so far", methods=("CD",)),
    Field("unconverged_steps", "1", "steps beyond the tolerance since the start", methods=("CD",)),
)

# Arrays with a row for each disk, the contact fields with one for each contact; the box has four numbers, around spheres six.
SNAPSHOT = _table(
    Field("position", "m", "centres of the disks"),
    Field("angle", "rad", "orientation of each disk, from -pi to pi; a packing keeps that of its preparation"),
    Field("radius", "m", "radius of each disk"),
    Field("body_ids", "1", "YADE's id of each disk"),
    Field("contact_ids", "1", "ids of the two bodies, walls included"),
    Field("contact_point", "m", "where the force acts"),
    Field("contact_normal", "1", "unit vector from the first to the second body"),
    Field("contact_friction", "1", "friction coefficient mu of the contact"),
    Field("force_normal", "N", "R, compression positive"),
    Field("force_tangential", "N", "T on the second body, along the normal turned by +90 degrees"),
    Field("box", "m", "inner faces of the walls x-, x+, y-, y+; NaN where there is no box"),
)

KNOWN = _table(
    Field("unit", "", "unit of the number and of the next two"),
    Field("exact", "", "exact value"),
    Field("scale", "", "the error is divided by this"),
    Field("source", "", "where the exact value comes from"),
    Field("deviation", "", "standard deviation of one run where `exact` is a mean over runs, else 0"),
)


def has_failed(status):
    """Tell whether a run of this status has ended without a result."""
    return status.startswith((STATUS_FAILED, STATUS_UNSTABLE))


def relative_error(measured, exact, scale, deviation=0.0):
    """Return for a known number |measured - exact|/scale; if `exact` is a mean, the error is at least its standard deviation."""
    return max(abs(measured - exact), deviation) / scale


SNAPSHOT_ATTRIBUTES = _table(
    Field("time", "s", "time since the start of the loading"),
    Field("cycle", "1", "time over the period of the loading"),
)

ROOT_ATTRIBUTES = _table(
    Field("schema_version", "1", "version of these tables"),
    Field("scene", "", "name of the scene"),
    Field("method", "", "MD or CD"),
    Field("parameters", "", "JSON of the full row, defaults included"),
    Field("state_sha256", "", "SHA-256 of the prepared packing; empty if the scene has none"),
    Field("git_commit", "", "commit of this project; ends in -dirty if files had changed or the engine was built of others"),
    Field("yade_version", "", "version of YADE"),
    Field("seed", "1", "seed of the packing"),
    Field("finished", "", "True if the run reached its end"),
    Field("status", "", "'finished', or 'failed: ' or 'unstable: ' and the reason"),
    Field("outcome", "", "'completed', 'collapsed: ' and what was seen, 'unstable: ' and the step that would do, or 'failed'"),
    Field("pressure", "Pa", "P0, the pressure before the loading"),
    Field("depth", "m", "length of the cylinders that the disks stand for, along z; no meaning for spheres"),
)

# How a run was interrupted and resumed; a file may lack these.
CHECKPOINT_ATTRIBUTES = _table(
    Field("checkpoint_samples", "1", "samples between two checkpoints; 0: none"),
    Field("resumed", "1", "how often the run was interrupted and resumed from a checkpoint"),
)

# A Coulomb test in floating point: both methods set |T| = mu R exactly where a contact slides, so any margin between rounding (1e-16) and
# the change of T/R in one step would do.
SLIDING_MARGIN = 1e-6


def is_sliding(force_normal, force_tangential, friction):
    """Return the mask of the contacts with |T| >= mu R, R > 0 and mu > 0 (Coulomb's condition, section 2.2).

    Forces in N. A frictionless contact has no Coulomb limit to reach and never counts.
    """
    limit = np.asarray(friction) * np.asarray(force_normal)
    return (limit > 0) & (np.abs(force_tangential) >= limit * (1 - SLIDING_MARGIN))


# History fields that may be NaN: there is no contact force to divide by, or a law does not sum its friction. Without a loaded box stresses and
# strains are undefined, too.
MAY_BE_UNDEFINED = {"unbalanced_force", "dissipated_energy", "friction_dissipation"}
OF_A_BOX = {"sigma1", "sigma2", "sigma1_goal", "sigma2_goal", "strain1", "strain2", "gamma"}


def problems(file):
    """Return the reasons why an open file is not a result file, as sentences; none if it is one. The file of a failed run is valid."""
    attributes, history, snapshots = dict(file.attrs), dict(file.get("history", {})), dict(file.get("snapshots", {}))
    if missing := [name for name in ROOT_ATTRIBUTES if name not in attributes]:
        return [f"it lacks the attributes {', '.join(missing)}"]
    if attributes["schema_version"] != SCHEMA_VERSION:
        return [f"its schema version is {attributes['schema_version']}, this program reads {SCHEMA_VERSION}"]
    if attributes["method"] not in METHODS:
        return [f"its method is {attributes['method']!r}, not one of {', '.join(METHODS)}"]
    needed = [name for name, field in HISTORY.items() if attributes["method"] in field.methods]
    if missing := [name for name in needed if name not in history]:
        return [f"/history lacks {', '.join(missing)}"]
    found = [f"/history/{name} is in {unit!r}, expected {HISTORY[name].unit!r}" for name, column in history.items()
             if name in HISTORY and (unit := column.attrs.get("unit")) != HISTORY[name].unit]
    if len({column.shape for column in history.values()}) > 1:
        found.append("the fields of /history differ in length")
    if attributes["finished"] and not len(history["time"]):
        found.append("it says that it has finished, but its history is empty")
    found += [f"/snapshots/{number} lacks {name}" for number, group in snapshots.items()
              for name in [*SNAPSHOT, *SNAPSHOT_ATTRIBUTES] if name not in group and name not in group.attrs]
    found += [f"/known/{name} lacks {key}" for name, number in file.get("known", {}).items() for key in KNOWN if key not in number.attrs]
    return found or (_undefined(history, snapshots) if attributes["finished"] else [])


def _undefined(history, snapshots):
    """Name what is NaN or infinite in a run that has finished, whether the tables above know it or not."""
    boxed = np.isfinite(history["gamma"][()]).any()
    may_be = MAY_BE_UNDEFINED | (set() if boxed else OF_A_BOX | {"box"})
    found = []
    for name, column in history.items():
        if name not in may_be and len(wrong := np.flatnonzero(~np.isfinite(column[()]))):
            found.append(f"/history/{name} is {column[wrong[0]]} at sample {wrong[0]} ({len(wrong)} of {len(column)} samples)")
    return found + [f"/snapshots/{number}/{name} is not finite"
                    for number, group in snapshots.items() for name, values in [*group.items(), *group.attrs.items()]
                    if name not in may_be and np.asarray(values).dtype.kind == "f" and not np.isfinite(values).all()]
