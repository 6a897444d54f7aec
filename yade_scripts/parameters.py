"""Every parameter of every run: name, default, unit, allowed values, meaning. Needs no YADE.

A row (a line of a table, or name=value arguments) overrides defaults; `complete` checks it and fills in the rest. All units are SI. The sample is
`depth` deep, so a 2D stress [N/m] is a stress [Pa] times `depth`. Equations, figures and "the paper" refer to Garcia-Rojo, McNamara and
Herrmann (ECCOMAS 2004), which does not give many of these values (see each meaning); the values used are stored with the result.

This file has the parameters that several scenes have. The file of a scene has the scene's own parameters and defaults; these parameters are allowed
only in rows of that scene.

`/usr/bin/python3 -m yade_scripts.parameters` prints the list.
"""
import difflib
import hashlib
import json
import math

import cd_engine
from yade_scripts import commands, declared, scenes
from yade_scripts.errors import ParameterError
from yade_scripts.parameter import Parameter

MOST_STEPS = 1e12  # from one sample to the next: twelve days, if a step takes a microsecond

# Version of what the defaults mean, here and in the scenes: part of the name of every run.
MEANING = 2

PLANAR_SOLVERS = ("newton",)  # of method_cd

SPRING_TOLERANCE = cd_engine.SPRING_TOLERANCES["bodies"]  # default of `tolerance` where cd_contacts = springs

REGISTRY = {p.name: p for p in (
    Parameter("scene", "biaxial", "1", "what is simulated", choices=scenes.names()),
    Parameter("method", "MD", "1", "MD: springs and dashpots; CD: contacts solved implicitly, rigid unless cd_contacts says otherwise",
              choices=("MD", "CD")),
    # The sample; the paper: 400 disks, k_n = 2 MPa, mu = 0.1, P0 = 6e-4 k_n (caption of Fig. 3).
    Parameter("disks", 400, "1", "number of disks", low=1, high=100000, prepare=True),
    Parameter("seed", 1, "1", "seed of radii, positions and velocities of the packing", low=0, high=2**31 - 1, prepare=True),
    Parameter("radius_mean", 0.01, "m", "mean radius; the paper does not give it, and in the quasi-static limit no dimensionless result depends on "
              "it", above=0, high=1e3, prepare=True),
    Parameter("radius_spread", 0.3, "1", "radii are uniform within radius_mean (1 +- radius_spread); not in the paper",
              low=0, high=0.9, prepare=True),
    Parameter("depth", 1.0, "m", "length of the cylinders that the disks stand for; not read where grains are spheres", above=0, high=1e3,
              prepare=True),
    Parameter("density", 2600.0, "kg/m^3", "density of the disks, whose mass is rho pi R^2 depth and inertia m R^2/2; not in the paper",
              above=0, high=1e6, prepare=True),
    Parameter("kn", 2e6, "N/m", "normal stiffness k_n of a contact, eq. 5; the paper has 2 MPa, at a depth of 1 m", above=0, high=1e15, prepare=True),
    Parameter("kt_over_kn", 0.5, "1", "tangential over normal stiffness, eq. 6; not given in the paper or in other work of its authors; 0.5 is a "
              "common choice. It shifts gamma, so vary it", above=0, high=1, prepare=True),
    Parameter("pressure_ratio", 6e-4, "1", "confining pressure P0 = pressure_ratio kn/depth, kn before stiffening; of spheres over the mean diameter "
              "instead of depth", above=0, high=0.01, prepare=True),
    Parameter("friction", 0.1, "1", "Coulomb coefficient mu between disks", low=0, high=2, prepare=True),
    Parameter("preparation_friction", 0.0, "1", "mu while the packing is compacted; 0 gives dense, robust samples", low=0, high=2, prepare=True),
    Parameter("wall_friction", 0.0, "1", "mu between disks and walls once the packing is compacted; not in the paper", low=0, high=2, prepare=True),
    Parameter("stiffening", 1.0, "1", "once the packing is compacted, kn is multiplied by this at constant P0: the same grains, stiffer",
              low=1, high=1e4, prepare=True),
    Parameter("beta_n", 0.1, "1", "damping of the normal contact, gamma = 2 beta_n sqrt(k_n m_eff) in eq. 5; not in the paper",
              low=0, high=0.9, prepare=True),
    # The loading.
    Parameter("loading", "triangle", "1", "sigma2(t): triangle (linear up and down, Fig. 4), cosine (eq. 7), ramp (eq. 1)",
              choices=("triangle", "cosine", "ramp")),
    Parameter("delta_sigma", 0.2, "1", "amplitude dSigma of eq. 7: sigma2 rises to P0 (1 + dSigma)", above=0, high=10),
    Parameter("stress_path", "constant", "1", "sigma1 while sigma2 changes: constant (sigma1 = P0, eq. 1) or mean (sigma1 = 2 P0 - sigma2, so that "
              "(sigma1 + sigma2)/2 stays P0); the paper does not say which one its Fig. 3 uses", choices=("constant", "mean")),
    Parameter("ramp_rate", 0.1, "1/s", "alpha of eq. 1, read by loading=ramp only", above=0, high=1e3),
    Parameter("period", 1.0, "s", "t0 of eq. 7; a run simulates cycles times t0. At delta_sigma = 0.2 MD's gamma at 1 s and at 4 s agrees within 1 % "
              "under a cosine, 4 % under a triangle; nearer the static limit take longer periods", above=0, high=1e6),
    Parameter("cycles", 1, "1", "number of periods that are simulated", low=1, high=10**6),
    Parameter("records_per_cycle", 200, "1", "samples of the history in a period; even, so that one falls on the load maximum", low=2, high=10**5),
    Parameter("collapse_strain", 0.2, "1", "a run counts as collapsed and ends when |gamma| exceeds this", above=0, high=10),
    # Walls.
    Parameter("wall_mass_ratio", 20.0, "1", "mass of a wall that is pushed by a force, in mean disk masses; heavy walls swing after the kinks of a "
              "triangle", above=0, high=1e6),
    Parameter("md_walls", "servo", "1", "servo: TriaxialStressController moves the walls; force: free walls pushed by forces, as in CD",
              choices=("servo", "force"), method="MD"),
    Parameter("tangential_law", "standard", "1", "tangential law of the springs: standard (Cundall-Strack, eq. 6), avoid_ratcheting (YADE's "
              "avoidGranularRatcheting), path_independent (McNamara et al. 2008: slip as in avoid_ratcheting; the force (R1 + R2)/d T, d the "
              "distance of the centres, acts at the arms R1 and R2, so that a closed path leaves no force and costs no energy)",
              choices=("standard", "avoid_ratcheting", "path_independent"), method="MD"),
    Parameter("tangential_damping", 0.0, "1", "eq. 6's gamma over that of eq. 5, 1 as the paper writes them; YADE's viscous law has no tangential "
              "dashpot. Not used in the preparation; lowers the stable step", low=0, high=2, method="MD"),
    # Time stepping.
    Parameter("md_dt_factor", 0.2, "1", "largest MD step in units of sqrt(m_min/k_n)", above=0, high=1, method="MD"),
    Parameter("md_load_every", 5, "1", "MD steps between updates of the servo's goals", low=1, high=1000, method="MD"),
    Parameter("damping_factor", 1.0, "1", "beta_n is multiplied by this once a packing is prepared: the same packing, with other dashpots",
              low=0, high=1000, method="MD"),
    Parameter("md_energies", True, "1", "sum the work of friction and dashpots in every step; without it a step costs 5 to 10 % less, and the "
              "dissipated energy is unknown (NaN)", method="MD"),
    Parameter("cd_dt", 1e-3, "s", "largest CD step", above=0, high=1, method="CD"),
    Parameter("cd_contacts", "rigid", "1", "rigid; springs: Contact Dynamics with the springs and dashpots of the row (kn, kt_over_kn, beta_n), "
              "solved at the end of each step; restitution and gap_correction have no effect, and tolerance is "
              "relative to the motion of a step, by default 0.1",
              choices=("rigid", "springs"), method="CD"),
    # The contact solver: attributes of ContactDynamics.
    Parameter("method_cd", "auto", "1", "contact solver", choices=("nsgs", "accelerated", "newton", "auto"), method="CD"),
    Parameter("tolerance", 1e-8, "1", "a CD step counts as solved when its errors (residual, also weighted by W_nn, and bodyError) are at most this",
              above=0, high=1, method="CD"),
    Parameter("flow_tolerance", 0.0, "1", "if larger than tolerance: the tolerance of CD steps after bodies have flowed or collided", low=0, high=1,
              method="CD"),
    Parameter("max_iterations", 20000, "1", "sweeps and factorizations after which a CD step counts as not converged",
              low=1, high=2**31 - 1, method="CD"),
    Parameter("fixed_iterations", 0, "1", "if positive: exactly so many plain sweeps a step without any test, whatever method_cd says (CD that is "
              "left unconverged)", low=0, high=2**31 - 1, method="CD"),
    Parameter("warm_start", True, "1", "start each CD step from the contact forces of the step before", method="CD"),
    Parameter("solver_seed", 0, "1", "if positive: the sweeps visit the contacts in a random order drawn from this seed",
              low=0, high=2**31 - 1, method="CD"),
    Parameter("restitution", 0.0, "1", "Newton's coefficient of normal restitution", low=0, high=1, method="CD"),
    Parameter("gap_correction", 0.0, "1", "share of an overlap, beyond the reference, that a CD step pushes out; with 1 and warm_start=False, "
              "unconverged CD is an elastic medium (Unger and Kertesz 2002)", low=0, high=1, method="CD"),
    Parameter("allowed_overlap", 0.0, "1", "overlap that gap_correction leaves, as a share of the smaller disk's radius; 1e-3 keeps piles at rest",
              low=0, high=1, method="CD"),
    Parameter("reference_overlaps", True, "1", "True: gaps are measured from the overlaps that the springs left, so that rigid contacts open as soon "
              "as they are unloaded; False: from geometric contact, so that they open where the springs would", method="CD"),
    Parameter("network_seed", 0, "1", "if positive: start from another admissible force network; this seed draws the random perturbation of the "
              "contact forces that leads to it", low=0, high=2**31 - 1, method="CD"),
    Parameter("network_perturbation", 1.0, "1", "amplitude of network_seed's perturbation (uniform), over the mean normal force",
              above=0, high=1e3, method="CD"),
    # Small scenes.
    Parameter("gravity", 0.0, "m/s^2", "gravitational acceleration, along -y", low=0, high=1e6),
    Parameter("slope", 30.0, "degree", "slope of the incline and of the walls of the groove", low=-89, high=89),
    Parameter("path_depth", 0.01, "1", "in two_grain_path: change of the overlap along the closed path, over the mean radius", above=0, high=0.1),
    Parameter("path_angle", 0.1, "rad", "in two_grain_path: angle by which the line of centres turns", above=0, high=1),
    Parameter("speed", 1.0, "m/s", "initial speed of the disk that is thrown, in slide_to_roll, stopping_distance, bounce, cradle and thin_wall",
              above=0, high=1e3),
)}


def registry(scene):
    """Return the parameters that rows of a scene may have: {name: Parameter}, the general ones first. A name may not be there twice."""
    file = scenes.module(scene)
    own = {parameter.name: parameter for parameter in file.PARAMETERS}
    if twice := REGISTRY.keys() & own:
        raise ParameterError(f"{file.__file__}: PARAMETERS repeats {', '.join(sorted(twice))}, which every scene has: take another name, or set its "
                             "default in DEFAULTS")
    if unknown := [name for name in file.POSITIVE if name not in REGISTRY | own]:
        raise ParameterError(f"{file.__file__}: POSITIVE names {', '.join(unknown)}, which are no parameters of the scene")
    return REGISTRY | own


def _registries():
    """Return [(scene, its parameters)] of all scenes whose files can be read; another scene's fault is told by a row of that scene."""
    return [(scene, registry(scene)) for scene in declared.readable(scenes.names(), registry, [])]


def defaults(scene):
    """Return the row of a scene if the user sets nothing: the general defaults, replaced by the scene's own where it has some."""
    usual, file = {name: parameter.default for name, parameter in registry(scene).items()} | {"scene": scene}, scenes.module(scene)
    try:
        return usual | _checked(file.DEFAULTS, scene)
    except ParameterError as error:
        raise ParameterError(f"{file.__file__}: DEFAULTS: {error}") from None


def complete(row):
    """Return the full row: `row`, checked, over the defaults of the scene and of the registry. Raise ParameterError if it cannot be run."""
    scene = REGISTRY["scene"].check(row.get("scene", REGISTRY["scene"].default))
    usual, checked = defaults(scene), _checked(row, scene)
    if "springs" in (checked.get("cd_contacts"), usual["cd_contacts"]):
        usual["tolerance"] = SPRING_TOLERANCE
    full = usual | checked
    _check_together(full)
    return full


def _checked(part, scene):
    """Return a part of a row of a scene with its values checked."""
    legal = registry(scene)
    for name in part:
        if name not in legal:
            raise ParameterError(f"unknown parameter {name!r} (value {part[name]!r}); {_hint(name, legal, scene)}")
    return {name: legal[name].check(value) for name, value in part.items()}


def _hint(name, legal, scene):
    """Return a hint for a name that is not legal in a scene: the command or the scenes that have it, or names that look like it."""
    if name == "accuracy":
        return "it belongs to another command: yade -n -x yade_scripts/accuracy.py"
    if others := [other for other, own in _registries() if name in own]:
        return f"scene {scene} has none of that name, {' and '.join(others)} {'has' if len(others) == 1 else 'have'}"
    near = difflib.get_close_matches(name, legal, n=3)
    return f"did you mean {' or '.join(near)}?" if near else "for the list of all parameters: /usr/bin/python3 -m yade_scripts.parameters"


def _check_together(full):
    scene = scenes.module(full["scene"])
    if full["method"] not in scene.METHODS:
        raise ParameterError(f"method = {full['method']!r}: the scene {full['scene']} runs by {' and '.join(scene.METHODS)} only, since {scene.ONLY}")
    largest = full["radius_mean"] * (1 + full["radius_spread"])
    if scene.IN_SPACE and full["depth"] != REGISTRY["depth"].default:
        raise ParameterError(f"depth = {full['depth']}: has no effect in the scene {full['scene']}, whose grains are spheres; leave it out")
    if full["depth"] <= 2 * largest and not scene.IN_SPACE:
        raise ParameterError(f"depth = {full['depth']} m: must exceed the largest disk's diameter, {2 * largest:g} m, "
                             "otherwise the spheres touch the front and back walls")
    if full["gravity"] and not scene.DEFAULTS.get("gravity"):
        raise ParameterError(f"gravity = {full['gravity']}: the scene {full['scene']} has no gravity: set gravity = 0; a scene with gravity "
                             "declares it in DEFAULTS")
    highest = highest_load(full)
    if full["stress_path"] == "mean" and highest >= 2:
        raise ParameterError(f"stress_path = mean: sigma2 would rise to {highest:g} P0, where sigma1 = 2 P0 - sigma2 would be zero or negative; "
                             "take " + ("a smaller ramp_rate or period" if full["loading"] == "ramp" else "delta_sigma below 1"))
    if full["records_per_cycle"] % 2:
        raise ParameterError(f"records_per_cycle = {full['records_per_cycle']}: must be even, so that one sample falls on the load maximum")
    for name in scene.POSITIVE:
        if not full[name] > 0:
            raise ParameterError(f"{name} = {full[name]}: must be above 0 in the scene {full['scene']}")
    if full["method"] == "CD":
        steps(full, full["cd_dt"])
        if scene.IN_SPACE and full["method_cd"] in PLANAR_SOLVERS:
            raise ParameterError(f"method_cd = {full['method_cd']}: solves planar scenes only, and the scene {full['scene']} is in space: take auto")
    scene.check(full)


def from_text(name, text):
    """Return the value of name=text of a command line or a table in the type of the parameter, or the text itself if it does not convert."""
    text = text.strip()
    if len(text) >= 2 and text[0] == text[-1] and text[0] in "'\"":
        return text[1:-1]
    # A name has the same type of value in every scene that declares it.
    parameter = REGISTRY.get(name) or next((own[name] for _, own in _registries() if name in own), None)
    if parameter is None or isinstance(parameter.default, str):
        return text
    if isinstance(parameter.default, bool):
        return {"true": True, "1": True, "false": False, "0": False}.get(text.lower(), text)
    try:
        return float(text) if not text.lstrip("+-").isdigit() else int(text)
    except ValueError:
        return text


def from_arguments(arguments):
    """Return the row given by name=value arguments."""
    row = {}
    for argument in arguments:
        name, equals, text = argument.partition("=")
        if not equals:
            raise ParameterError(f"{argument!r}: arguments are name=value, such as seed=3")
        if name in row:
            raise ParameterError(f"{name} is given twice")
        row[name] = from_text(name, text)
    return row


def preparation(full):
    """Return {name: value} of the parameters of the prepared packing that are not defaults. Scenes with equal values share a packing."""
    return {name: full[name] for name, parameter in REGISTRY.items() if parameter.prepare and full[name] != parameter.default}


def digest(values, length=12):
    """Return a hash of a dictionary of parameters, as hexadecimal digits; it is the same in every process."""
    return hashlib.sha256(json.dumps(values, sort_keys=True, allow_nan=False).encode()).hexdigest()[:length]


def read_by_method(full):
    """Return the parameters of a full row that its method reads."""
    legal = registry(full["scene"])
    return {name: value for name, value in full.items() if legal[name].method in (None, full["method"])}


def result_name(full):
    """Return the stem of the result file: scene, method, hash of what differs from the defaults among the parameters that this method reads.

    A new parameter whose default keeps the old behaviour therefore leaves every name as it is. If you change what a default means, raise
    MEANING, which gives all runs new names.
    """
    usual = defaults(full["scene"])
    asked = {name: value for name, value in read_by_method(full).items() if name not in ("scene", "method") and value != usual[name]}
    return f"{full['scene']}-{full['method']}-{digest(asked | {'meaning': MEANING})}"


def has_springs(full):
    """Return whether the contacts of a run have springs: MD's, or those in Contact Dynamics."""
    return full["method"] == "MD" or full["cd_contacts"] == "springs"


def stiffness(full):
    """Return k_n [N/m] of the run, stiffening included."""
    return full["kn"] * full["stiffening"]


def damping(full):
    """Return the damping ratio beta_n of the springs of the run."""
    return full["beta_n"] * (full["damping_factor"] if full["method"] == "MD" else 1)


def in_space(full):
    """Return whether the grains are spheres that move in space."""
    return scenes.module(full["scene"]).IN_SPACE


def pressure(full):
    """Return P0 [Pa]: pressure_ratio kn over the depth of disks, over the mean diameter of spheres."""
    return full["pressure_ratio"] * full["kn"] / (2 * full["radius_mean"] if in_space(full) else full["depth"])


def sphere_mass(full):
    """Return the mass [kg] of a sphere of the mean radius."""
    return full["density"] * 4 / 3 * math.pi * full["radius_mean"]**3


def sphere_sags(full):
    """Return how far [m] a sphere's weight compresses a spring of the row; 0 for rigid contacts."""
    return sphere_mass(full) * full["gravity"] / stiffness(full) if has_springs(full) else 0.0


def volume(full):
    """Return the volume [m^3] of the grains, as if all had the mean radius."""
    if in_space(full):
        return full["disks"] * 4 / 3 * math.pi * full["radius_mean"]**3
    return full["disks"] * math.pi * full["radius_mean"]**2 * full["depth"]


def highest_load(full):
    """Return the largest sigma2/P0 of the loading."""
    return 1 + (full["ramp_rate"] * full["period"] * full["cycles"] if full["loading"] == "ramp" else full["delta_sigma"])


def width(full, aspect):
    """Return the width [m] of a box that all disks fill to `aspect` times its width at a solid fraction of 0.8."""
    area = full["disks"] * math.pi * full["radius_mean"]**2 * (1 + full["radius_spread"]**2 / 3)  # expected, of radii that are uniform
    return math.sqrt(area / (0.8 * aspect))


def steps(full, largest):
    """Return (number of steps between two samples, step [s]): the longest step up to `largest` [s] with samples on whole steps.

    Raise ParameterError if these are more than MOST_STEPS steps.
    """
    interval = full["period"] / full["records_per_cycle"]
    if (needed := interval / largest) > MOST_STEPS:
        name = "cd_dt" if full["method"] == "CD" else "md_dt_factor"
        raise ParameterError(f"{name} = {full[name]:g} means {needed:.2g} steps from one sample to the next; raise it, so that there are at most "
                             f"{MOST_STEPS:g}")
    every = math.ceil(needed * (1 - 1e-12))
    return every, interval / every


def restitution(full):
    """Return the normal restitution of a contact: Newton's in CD; in MD that of eq. 5 over half a period, exp(-pi beta/sqrt(1 - beta^2)), or 0 from
    beta = 1 on, where the disks do not separate any more."""
    if not has_springs(full):
        return full["restitution"]
    beta = damping(full)
    return math.exp(-math.pi * beta / math.sqrt(1 - beta**2)) if beta < 1 else 0.0


def _lines(parameter):
    return f"{parameter.name:22} {parameter.default!s:>10} [{parameter.unit}]  {parameter.allowed()}\n{'':24}{parameter.doc}"


def listing():
    """Return a text with all parameters: the general ones, then for each scene its own and the defaults that it changes."""
    lines = [_lines(parameter) for parameter in REGISTRY.values()]
    for name in scenes.names():
        scene = scenes.module(name)
        methods = " and ".join(scene.METHODS) if len(scene.METHODS) > 1 else f"{scene.METHODS[0]} only, since {scene.ONLY}"
        lines += ["", f"scene={name}: {scene.TITLE} ({methods})"]
        lines += [f"{'':24}{scene.HORIZON}", f"{'':24}Left out: {scene.LEFT_OUT}."]
        lines += [f"{'':24}defaults: " + ", ".join(f"{key}={value}" for key, value in scene.DEFAULTS.items())] * bool(scene.DEFAULTS)
        lines += [_lines(parameter) for parameter in scene.PARAMETERS]
    return "\n".join(lines)


if __name__ == "__main__":
    commands.parser(__doc__, prog="python3 -m yade_scripts.parameters").parse_args()
    raise SystemExit(commands.command("parameters")(lambda arguments: print(listing()))())
