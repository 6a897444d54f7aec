"""What a mean of a flow costs by either method: what the studies of flows share."""
import math

import numpy as np
import pandas

from analysis import publish, style, summary
from yade_scripts.tables import product

QUANTITY = {"hopper": "rate", "drum": "slope", "filling": "height", "collapse": "front"}
WORDS = {"hopper": "discharge of a silo", "drum": "slope of a drum", "filling": "height of a filling", "collapse": "front of a collapse"}
PERIOD = {"hopper": 1.5, "drum": 3.0, "filling": 1.0, "collapse": 1.5}  # s, of 500 disks
SMALL, WITHIN = 500, 0.02
OVERLAP = 0.1  # of the mean radius: more would be another material
LEAST = 3  # seeds of a setting that is judged
FINEST = dict(method="CD", cd_dt=2.5e-4, tolerance=1e-3)
FINE = dict(method="CD", cd_dt=1e-3, tolerance=1e-3)
COARSER = dict(method="CD", cd_dt=2e-3, tolerance=1e-3)
COARSEST = dict(method="CD", cd_dt=4e-3, tolerance=1e-3)
COARSE = dict(method="CD", cd_dt=2e-3, tolerance=1e-2)
PROPOSED = dict(method="CD", cd_dt=5e-4, tolerance=1e-4)  # about what cd_engine.timeStep() gives here, and the tolerance of engines() in flow
STRICT = PROPOSED | {"tolerance": 1e-6, "max_iterations": 20000}
DEFAULT = STRICT | {"flow_tolerance": 1e-4}  # of cd_engine.engines()
DAMPED = dict(method="MD", md_dt_factor=0.3, md_energies=False)  # beta_n = 0.9: impacts do not rebound, as in CD, but the stable step is short
SOFT, MIDDLE, HARDER, STIFF = (DAMPED | {"kn": kn} for kn in (2e6, 5e6, 1e7, 2e7))
BETA = 0.2  # damping of the springs that are drawn full: less than beta_n = 0.9, so that the stable step is longer
LIGHT = DAMPED | dict(md_dt_factor=0.6, beta_n=BETA)
IMPLICIT = dict(method="CD", cd_contacts="springs", cd_dt=1e-3)
RIGID, FEW, SPRINGS, MD = "rigid contacts", "rigid contacts, few sweeps", "springs in CD", "springs (MD)"
KINDS = (RIGID, FEW, SPRINGS, MD)
LOOK = {RIGID: dict(color=style.COLOUR["CD"], marker="s"), FEW: dict(color=style.COLOUR["CD"], marker="v"),
        SPRINGS: dict(color=style.GREEN, marker="D"), MD: dict(color=style.COLOUR["MD"], marker="o")}


def rows_of(scene, disks, settings, seeds):
    """Return rows of a scene whose times and slot grow with its size, so that it stays the same flow."""
    size = disks / SMALL
    more = {"slot": 10 * math.sqrt(size)} if scene == "hopper" else {}
    more |= {"column_aspect": 2.0, "radius_spread": 0.2} if scene == "collapse" else {}
    return [row for setting in settings
            for row in product(**dict(scene=scene, disks=disks, period=round(PERIOD[scene] * size**0.25, 3), seed=seeds) | more | setting)]


def _setting(run):
    """Return the columns of the table that tell the setting of a run."""
    row, cd = run.parameters, run.method == "CD"
    soft = not cd or row["cd_contacts"] == "springs"
    sweeps = row["fixed_iterations"] if cd else 0
    return {"scene": row["scene"], "disks": row["disks"], "method": run.method,
            "kind": MD if not cd else SPRINGS if soft else FEW if sweeps else RIGID,
            "step": row["cd_dt"] if cd else row["md_dt_factor"],
            "setting": row["kn"] if soft else sweeps or max(row["tolerance"], row["flow_tolerance"]),
            "gap_correction": row["gap_correction"] if cd else 0.0, "at_rest": row["tolerance"] if cd else 0.0,
            "beta_n": row["beta_n"] if soft else math.nan}


def arguments(row):
    """Return the arguments of a run, as on a command line, that give a row of the table its setting."""
    spring = f"kn={row['setting']:g} beta_n={row['beta_n']:g}"
    if row["kind"] == MD:
        return f"{spring} md_dt_factor={row['step']:g}"
    if row["kind"] == SPRINGS:
        return f"cd_contacts=springs {spring} cd_dt={row['step']:g}"
    if row["kind"] == FEW:
        return f"cd_dt={row['step']:g} fixed_iterations={row['setting']:g}"
    flow = "" if row["at_rest"] == row["setting"] else f" flow_tolerance={row['setting']:g}"
    return f"cd_dt={row['step']:g} tolerance={row['at_rest']:g}{flow} gap_correction={row['gap_correction']:g}"


def settings(row):
    """Return the setting of a row in words."""
    step = f"step {1e3 * row['step']:g} ms"
    corrected = f", gapCorrection {row['gap_correction']:g}" if row["gap_correction"] else ""
    if row["kind"] in (MD, SPRINGS):
        stiffness = f"{row['setting']:.0e}".replace("e+0", "e")
        return f"{stiffness} N/m, beta_n = {row['beta_n']:g}" + (f", {step}" if row["kind"] == SPRINGS else "")
    return f"{row['setting']:.0f} sweeps, {step}" if row["kind"] == FEW else f"tolerance {row['setting']:g}, {step}{corrected}"


def summarize(runs):
    """Return one row a scene, size and setting, over the seeds.

    error: of the mean, relative to the rigid answer; error_deviation: standard error of that difference. seconds: processor time, median.
    setting: stiffness of springs [N/m], number of sweeps where it is given, or the tolerance of the steps in which disks flow; at_rest: that of the
    others. sweeps: mean of the sampled steps. overlap: largest overlap over the mean radius. unsolved: share of the steps that missed their
    tolerance.
    """
    rows = [_row(group) for group in summary.groups(runs, lambda run: tuple(map(str, _setting(run).values()))).values()]
    for row in rows:
        same = [other for other in rows if (other["scene"], other["disks"], other["kind"]) == (row["scene"], row["disks"], RIGID)]
        rigid = min(same, key=lambda other: (other["step"], other["setting"]), default=None)
        row["is_rigid_answer"] = row is rigid
        row["error"] = row["value"] / rigid["value"] - 1 if rigid else math.nan
        row["error_deviation"] = math.hypot(row["deviation"], rigid["deviation"]) / rigid["value"] if rigid and row is not rigid else 0.0
    return sorted(rows, key=lambda row: (row["scene"], row["disks"], KINDS.index(row["kind"]), row["beta_n"], row["step"], row["setting"]))


def _row(group):
    named = _setting(group[0])
    values = np.array([float(run.extra[QUANTITY[named["scene"]]]) for run in group])
    cd = named["method"] == "CD"
    steps = [run.values("time")[-1] / run.parameters["cd_dt"] for run in group]
    return named | {
        "seeds": len(group), "value": float(values.mean()),
        "deviation": float(values.std(ddof=1) / math.sqrt(len(values))) if len(values) > 1 else math.nan,
        "seconds": float(np.median([run.values("processor_time")[-1] for run in group])),
        "overlap": float(max(run.values("max_penetration").max() / run.parameters["radius_mean"] for run in group)),
        "sweeps": float(np.mean([run.values("iterations")[1:].mean() for run in group])) if cd else math.nan,
        "unsolved": sum(run.values("unconverged_steps")[-1] for run in group) / sum(steps) if cd else 0.0}


def reaching(rows, scene, disks, kind, within=WITHIN):
    """Return the rows of a kind that come `within` of the rigid answer and whose disks do not overlap by more than OVERLAP.

    A row counts only if all finer settings are within it, too, since an error can be small by chance.
    """
    mine = [row for row in rows if (row["scene"], row["disks"], row["kind"]) == (scene, disks, kind) and is_judged(row)]
    return [row for row in mine if row["overlap"] <= OVERLAP and not row["is_rigid_answer"]
            and all(abs(other["error"]) <= within for other in mine if _is_as_fine(other, row))]


def cheapest(rows, scene, disks, kind, within=WITHIN):
    """Return the cheapest row of a kind that comes `within` of the rigid answer, or else that with the smallest error; None if there are none."""
    if good := reaching(rows, scene, disks, kind, within):
        return min(good, key=lambda row: row["seconds"])
    return min(reaching(rows, scene, disks, kind, math.inf), key=lambda row: abs(row["error"]), default=None)


def is_judged(row):
    """Tell whether a setting takes part in the comparison; the others, of two seeds or with a second tolerance, tell their cost only."""
    return row["seeds"] >= LEAST and (row["kind"] != RIGID or row["at_rest"] == row["setting"])


def _is_as_fine(other, row):
    """Tell whether another setting of the same kind and damping is as fine or finer: no larger step (of CD), tolerance and gap correction; no softer
    springs, no fewer sweeps."""
    if row["beta_n"] == row["beta_n"] != other["beta_n"]:
        return False
    larger, smaller = (row, other) if row["kind"] == RIGID else (other, row)
    return (other["method"] == "MD" or other["step"] <= row["step"]) and smaller["setting"] <= larger["setting"] \
        and other["gap_correction"] <= row["gap_correction"]


def measured(table):
    """Return the published rows that were measured, without those that failed."""
    found = publish.finished(table)
    if "kind" not in found:  # published before Contact Dynamics had springs
        found = found.assign(kind=found.method.map({"CD": RIGID, "MD": MD}), beta_n=found.method.map({"CD": math.nan, "MD": 0.9}))
    return found.assign(is_rigid_answer=found.is_rigid_answer.astype(bool))


def of_setting(table, setting, gap_correction=0.0):
    """Return the rows of a setting of rigid contacts solved to a tolerance, by scene."""
    flow = max(setting["tolerance"], setting.get("flow_tolerance", 0))
    asked = {"kind": RIGID, "step": setting["cd_dt"], "setting": flow, "at_rest": setting["tolerance"], "gap_correction": gap_correction}
    return table[(table[list(asked)] == pandas.Series(asked)).all(axis=1)].set_index("scene")


def gains(rows, disks, kind=RIGID):
    """Return {scene: cost of the cheapest of MD's springs over that of the cheapest of a kind}, both within 2 % of the rigid answer, or else the
    nearest."""
    pairs = {scene: [cheapest(rows, scene, disks, one) for one in (MD, kind)] for scene in QUANTITY}
    return {scene: md["seconds"] / cd["seconds"] for scene, (md, cd) in pairs.items() if md and cd}


def drawn_gains(rows, disks, kind=RIGID, draws=2000):
    """Return a table of gains, a column a scene, if the means are drawn again: from Student's t distribution with the standard error and the number
    of seeds of each. Where nothing else of the kind is within 2 % then, the rigid answer gives its cost; where no springs are, the gain is
    infinite: stiffer ones, if any suffice, would cost more.
    """
    dice, found = np.random.default_rng(1), []
    known = [row for row in rows if row["disks"] == disks and is_judged(row)]
    for _ in range(draws):
        drawn = [row | {"value": row["value"] + row["deviation"] * dice.standard_t(row["seeds"] - 1)} for row in known]
        rigid = {row["scene"]: row for row in drawn if row["is_rigid_answer"]}
        drawn = [row | {"error": row["value"] / rigid[row["scene"]]["value"] - 1} for row in drawn]
        least = {one: {scene: min((row["seconds"] for row in reaching(drawn, scene, disks, one)), default=other(scene)) for scene in QUANTITY}
                 for one, other in ((MD, lambda scene: math.inf), (kind, lambda scene: rigid[scene]["seconds"]))}
        found.append({scene: least[MD][scene] / least[kind][scene] for scene in QUANTITY})
    return pandas.DataFrame(found)


def spread(drawn):
    """Return what `drawn_gains` tells of each scene: quantiles of 2.5, 50 and 97.5 %, and the share of the draws in which no springs count."""
    low, middle, high = (drawn.quantile(part, interpolation="lower") for part in (0.025, 0.5, 0.975))
    return low, middle, high, np.isinf(drawn).mean()


def draw(runs, rows, path):
    """Draw the error with its uncertainty against the cost, one panel a scene."""
    table = pandas.DataFrame(rows)
    names, kinds = [scene for scene in QUANTITY if scene in set(table.scene)], [kind for kind in KINDS if kind in set(table.kind)]
    fig, panels = style.plt.subplots(1, len(names), figsize=(max(4.5, 2.9 * len(names)), 3.9), sharey=True, squeeze=False)
    for axes, scene in zip(panels[0], names):
        axes.axhspan(-100 * WITHIN, 100 * WITHIN, color=style.GREY["EE"], zorder=0)
        for _, row in table[table.scene == scene].iterrows():
            full = row.is_rigid_answer or row.beta_n == BETA
            axes.errorbar(row.seconds, 100 * row.error, 100 * np.nan_to_num(row.error_deviation), ls="", elinewidth=0.7, zorder=3 if full else 2,
                          **LOOK[row.kind], **(dict(ms=8, mec="k") if row.is_rigid_answer else dict(ms=4.5, mfc=None if full else "none")))
        axes.set(xscale="log", xlabel="processor time of a run [s]", title=WORDS[scene])
    panels[0][0].set_ylabel("error, relative to rigid grains [%]")
    style.legend(panels[0][-1], [dict(ls="", mfc="none", label=kind, **LOOK[kind]) for kind in kinds], fontsize=7)
    more = f" Filled circles and diamonds: springs with beta_n = {BETA:g}; open: more damping." if (table.beta_n == BETA).any() else ""
    style.finish(fig, path, f"{table.disks.max()} disks. Each point: one setting; bars: standard error over the seeds, where there are several. "
                 f"With an edge: the rigid answer. Grey: 2 %.{more}", runs)
