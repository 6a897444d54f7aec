"""What a mean of a flow costs by either method, with 500 disks."""
import math

import numpy as np
import pandas

from analysis import publish, style, summary
from yade_scripts.tables import product

TITLE = "Flows of 500 disks: what does an answer within 2 % cost?"
QUESTION = ("A silo that runs empty, a drum that turns, a box that is filled and a column that collapses, of 500 disks: what does it cost to find "
            "the rate, the slope, the height or the front within 2 % of the rigid answer, by rigid contacts and by springs?")
ORDER = 20  # in the report

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
SPRINGS = dict(method="MD", md_dt_factor=0.3, md_energies=False)
SOFT, MIDDLE, HARDER, STIFF = (SPRINGS | {"kn": kn} for kn in (2e6, 5e6, 1e7, 2e7))


def rows_of(scene, disks, settings, seeds):
    """Return rows of a scene whose times and slot grow with its size, so that it stays the same flow."""
    size = disks / SMALL
    more = {"slot": 10 * math.sqrt(size)} if scene == "hopper" else {}
    more |= {"column_aspect": 2.0, "radius_spread": 0.2} if scene == "collapse" else {}
    return [row for setting in settings
            for row in product(**dict(scene=scene, disks=disks, period=round(PERIOD[scene] * size**0.25, 3), seed=seeds) | more | setting)]


COMPARED = [FINEST, PROPOSED, FINE, COARSER, COARSEST, COARSE, MIDDLE, HARDER, STIFF]  # with more seeds where one run differs much from another
BEYOND = [FINEST | {"cd_dt": 1.25e-4}, SPRINGS | {"kn": 1e8}]  # of the collapse, where springs of 2e7 N/m have not converged
EXACT = FINEST | {"tolerance": 1e-4}  # of the drum, where the profile of velocity tests the rigid answer
OTHERS = [COARSE | {"gap_correction": 0.1}, COARSE | {"cd_dt": 4e-3}, DEFAULT, SOFT]
SEEDS = {"hopper": range(1, 37), "drum": range(1, 37), "filling": range(1, 13), "collapse": range(1, 37)}  # of 500 disks
ROWS = {"quick": rows_of("filling", SMALL, [COARSE, SOFT], 1),
        "full": [row for scene in QUANTITY for row in rows_of(scene, SMALL, COMPARED, SEEDS[scene])
                 + rows_of(scene, SMALL, OTHERS, range(1, 13)) + rows_of(scene, SMALL, [STRICT], (1, 2))]
        + rows_of("collapse", SMALL, BEYOND, SEEDS["collapse"]) + rows_of("drum", SMALL, [EXACT], SEEDS["drum"])}


def _key(run):
    row = run.parameters
    cd = run.method == "CD"
    flow = max(row["tolerance"], row["flow_tolerance"])
    setting = (row["cd_dt"], flow, row["gap_correction"], row["tolerance"]) if cd else (row["kn"], row["md_dt_factor"], 0.0, 0.0)
    return (row["scene"], row["disks"], run.method, *setting)


def summarize(runs):
    """Return one row a scene, size and setting, over the seeds.

    error: of the mean, relative to the rigid answer; error_deviation: standard error of that difference. seconds: processor time, median.
    setting: stiffness, or the tolerance of the steps in which disks flow; at_rest: that of the others. sweeps: mean of the sampled steps. overlap:
    largest overlap over the mean radius. unsolved: share of the steps that missed their tolerance.
    """
    rows = [_row(key, group) for key, group in summary.groups(runs, _key).items()]
    for row in rows:
        same = [other for other in rows if (other["scene"], other["disks"], other["method"]) == (row["scene"], row["disks"], "CD")]
        rigid = min(same, key=lambda other: (other["step"], other["setting"]), default=None)
        row["is_rigid_answer"] = row is rigid
        row["error"] = row["value"] / rigid["value"] - 1 if rigid else math.nan
        row["error_deviation"] = math.hypot(row["deviation"], rigid["deviation"]) / rigid["value"] if rigid and row is not rigid else 0.0
    return rows


def _row(key, group):
    scene, disks, method, first, second, gap, at_rest = key
    values = np.array([float(run.extra[QUANTITY[scene]]) for run in group])
    steps = [run.values("time")[-1] / run.parameters["cd_dt"] for run in group]
    cd = method == "CD"
    return {"scene": scene, "disks": disks, "method": method, "step": first if cd else second, "setting": second if cd else first,
            "gap_correction": gap, "at_rest": at_rest, "seeds": len(group), "value": float(values.mean()),
            "deviation": float(values.std(ddof=1) / math.sqrt(len(values))) if len(values) > 1 else math.nan,
            "seconds": float(np.median([run.values("processor_time")[-1] for run in group])),
            "overlap": float(max(run.values("max_penetration").max() / run.parameters["radius_mean"] for run in group)),
            "sweeps": float(np.mean([run.values("iterations")[1:].mean() for run in group])) if cd else math.nan,
            "unsolved": sum(run.values("unconverged_steps")[-1] for run in group) / sum(steps) if cd else 0.0}


def reaching(rows, scene, disks, method, within=WITHIN):
    """Return the rows of a method that come `within` of the rigid answer and whose disks do not overlap by more than OVERLAP.

    A row counts only if all finer settings are within it, too, since an error can be small by chance.
    """
    mine = [row for row in rows if (row["scene"], row["disks"], row["method"]) == (scene, disks, method) and _is_judged(row)]
    return [row for row in mine if row["overlap"] <= OVERLAP and not row["is_rigid_answer"]
            and all(abs(other["error"]) <= within for other in mine if _is_as_fine(other, row))]


def cheapest(rows, scene, disks, method, within=WITHIN):
    """Return the cheapest row of a method that comes `within` of the rigid answer, or else that with the smallest error; None if there are none."""
    if good := reaching(rows, scene, disks, method, within):
        return min(good, key=lambda row: row["seconds"])
    return min(reaching(rows, scene, disks, method, math.inf), key=lambda row: abs(row["error"]), default=None)


def _is_judged(row):
    """Tell whether a setting takes part in the comparison; the others, of two seeds or with a second tolerance, tell their cost only."""
    return row["seeds"] >= LEAST and (row["method"] == "MD" or row["at_rest"] == row["setting"])


def _is_as_fine(other, row):
    """Tell whether another setting of the same method is as fine or finer: stiffer springs; no larger step, tolerance and gap correction."""
    if row["method"] == "MD":
        return other["setting"] >= row["setting"]
    return all(other[name] <= row[name] for name in ("step", "setting", "gap_correction"))


def measured(table):
    """Return the published rows that were measured, without those that failed."""
    found = publish.finished(table)
    return found.assign(is_rigid_answer=found.is_rigid_answer.astype(bool))


def gains(rows, disks):
    """Return {scene: cost of the cheapest springs over that of the cheapest rigid contacts}, both within 2 % of the rigid answer, or else the
    nearest."""
    pairs = {scene: [cheapest(rows, scene, disks, method) for method in ("MD", "CD")] for scene in QUANTITY}
    return {scene: md["seconds"] / cd["seconds"] for scene, (md, cd) in pairs.items() if md and cd}


def drawn_gains(rows, disks, draws=2000):
    """Return a table of gains, a column a scene, if the means are drawn again: from Student's t distribution with the standard error and the number
    of seeds of each. Where no other rigid contacts are within 2 % then, the rigid answer gives their cost; where no springs are, the gain is
    infinite: stiffer ones, if any suffice, would cost more.
    """
    dice, found = np.random.default_rng(1), []
    known = [row for row in rows if row["disks"] == disks and _is_judged(row)]
    for _ in range(draws):
        drawn = [row | {"value": row["value"] + row["deviation"] * dice.standard_t(row["seeds"] - 1)} for row in known]
        rigid = {row["scene"]: row for row in drawn if row["is_rigid_answer"]}
        drawn = [row | {"error": row["value"] / rigid[row["scene"]]["value"] - 1} for row in drawn]
        least = {method: {scene: min((row["seconds"] for row in reaching(drawn, scene, disks, method)), default=other(scene)) for scene in QUANTITY}
                 for method, other in (("MD", lambda scene: math.inf), ("CD", lambda scene: rigid[scene]["seconds"]))}
        found.append({scene: least["MD"][scene] / least["CD"][scene] for scene in QUANTITY})
    return pandas.DataFrame(found)


def spread(drawn):
    """Return what `drawn_gains` tells of each scene: quantiles of 2.5, 50 and 97.5 %, and the percentage of the draws in which no springs count."""
    low, middle, high = (drawn.quantile(part, interpolation="lower") for part in (0.025, 0.5, 0.975))
    return low, middle, high, 100 * np.isinf(drawn).mean()


def draw(runs, rows, path):
    """Draw the error with its uncertainty against the cost, one panel a scene."""
    table = pandas.DataFrame(rows)
    names, methods = [scene for scene in QUANTITY if scene in set(table.scene)], [name for name in ("CD", "MD") if name in set(table.method)]
    fig, panels = style.plt.subplots(1, len(names), figsize=(max(4.5, 2.9 * len(names)), 3.9), sharey=True, squeeze=False)
    for axes, scene in zip(panels[0], names):
        axes.axhspan(-100 * WITHIN, 100 * WITHIN, color="#EEEEEE", zorder=0)
        for method in methods:
            own = table[(table.scene == scene) & (table.method == method)]
            style.points(axes, own[own.is_rigid_answer], "seconds", "error", method)
            part = own[~own.is_rigid_answer]
            axes.errorbar(part.seconds, 100 * part.error, 100 * part.error_deviation.fillna(0), ls="", ms=4.5, mfc="none",
                          marker=style.MARKER[method], color=style.COLOUR[method], elinewidth=0.7)
        axes.set(xscale="log", xlabel="processor time of a run [s]", title=WORDS[scene])
    panels[0][0].set_ylabel("error, relative to rigid grains [%]")
    style.legend(panels[0][-1], [dict(ls="", mfc="none", marker=style.MARKER[method], color=style.COLOUR[method], label=style.WORDS[method])
                                 for method in methods], fontsize=7)
    style.finish(fig, path, f"{table.disks.max()} disks. Each point: one setting; bars: standard error over the seeds, where there are several. "
                 "Filled: the rigid answer. Grey: 2 %.", runs)


ANSWER = """
In the silo, the drum and the filling the cheapest springs that count cost 5.8, 5.3 and 9.0 times as much as the cheapest rigid contacts. A setting
counts if its mean, and that of all finer settings, lies within 2 % of the result of the finest rigid contacts (the rigid answer) and no disks overlap
by more than 0.1 radii. The means have standard errors of up to 1.9 % (12 or 36 seeds), and which settings count depends on them. So we draw the means
again with these errors (Student's t distribution); where no coarser rigid contacts count in a draw, the cost of the rigid answer is taken. The
medians of the factors are then 4.4, 3.3 and 9.0, and in 97.5 % of the draws the factors are at least 1.0, 0.6 and 9.0. In 23 % of the draws in the
silo and in 4.0 % in the drum no springs count, so these factors have no upper limit; in the filling 97.5 % of the factors are at most 14.0.

In the collapse no springs count: those of 1e8 N/m, the stiffest, are still off by 2.3 % (standard error 0.7 %) and cost 3.5 times as much as the
cheapest rigid contacts that count. In 64 % of the draws no springs count, either. Stiffer springs come nearer: from the softest to the stiffest the
largest overlap falls from 0.082 to 0.0071 radii and the error from 4.1 to 2.3 %. How much would remain without any overlap depends on the
extrapolation: 2.6 % (0.7 %) along a line in the overlap, 1.7 % (0.9 %) along one in its square root. So whether anything but the stiffness differs is
open. Rigid contacts have converged there to about 1 %: steps of 0.25 ms, and steps of 0.5 ms with a tolerance of 1e-4, differ by 0.4 % from steps of
0.125 ms (standard errors 0.6 and 0.7 %).

Which steps and tolerances suffice? With a tolerance of 1e-3 steps of 1 ms give errors of 0.0 to 2.2 %, steps of 2 ms 0.6 to 2.8 % and steps of 4 ms
0.1 to 5.4 %, largest in the collapse. With 1e-2 in place of 1e-3 disks overlap by up to 0.13 radii in steps of 2 ms, not 0.03, and the time is 0.67
to 0.85 times as long. A gapCorrection of 0.1 then costs 1.8 to 4.4 times as much, and the slope of the drum is off by 7.6 %: a smaller step is a
better use of the time. The rigid answers are solved to 1e-3 and in the drum to 1e-4, only 1.3 and 2.3 decades below the 2 % that is read off. It
seems to suffice: steps of 0.5 ms to 1e-4 differ from the rigid answers by 0.1 to 1.2 %, about as much as their standard errors (0.2 to 1.3 %).

Where does the time go? A step of 2 ms takes 28 to 84 sweeps to 1e-3 and 6 to 24 to 1e-2. Steps of 0.5 ms, about what timeStep() proposes, take 72 to
274 sweeps to 1e-4, and a run costs 0.7 to 1.7 times as much as the cheapest springs that count in the silo, the drum and the filling. To 1e-6 the
same steps take 803 to 3674 sweeps and 6.0 to 14.5 times as long (two seeds), and in the drum 0.53 % of them miss it. The default of
cd_engine.engines(), 1e-4 after disks have flowed or collided and 1e-6 when all rest, takes 1.14 to 1.28 times as long as 1e-4 in every step (not
measured at the same time); so with it and steps of 0.5 ms rigid contacts cost 0.89 to 1.93 times as much as the cheapest springs that count.

Times are processor times without samples and measurements, and without sums of the springs' energies, on one of two cores, while other runs used the
other core.
"""
GIVEN = ("2", "500", "12", "97.5", "1e8", "0.25", "0.5", "1e-4", "0.125", "1e-3", "1", "4", "1e-2", "1e-6", "2.3")


def numbers(table):
    table = measured(table)
    rows, cd = table.to_dict("records"), table[table.method == "CD"]
    gain = gains(rows, SMALL)
    low, middle, high, open_above = spread(drawn_gains(rows, SMALL))
    springs = {scene: cheapest(rows, scene, SMALL, "MD") for scene in QUANTITY}
    assert np.isinf(high[["hopper", "drum"]]).all()
    column = table[table.scene == "collapse"]
    exact, soft_to_stiff = column[column.is_rigid_answer].iloc[0], column[column.method == "MD"].sort_values("setting")
    left = []
    for overlap in (soft_to_stiff.overlap, np.sqrt(soft_to_stiff.overlap)):
        line, spread_of = np.polyfit(overlap, soft_to_stiff.value, 1, w=1 / soft_to_stiff.deviation, cov="unscaled")
        left.append((100 * (line[1] / exact.value - 1), 100 * math.hypot(math.sqrt(spread_of[1, 1]), exact.deviation) / exact.value))
    others = [scene for scene in QUANTITY if scene != "collapse"]
    assert [scene for scene in QUANTITY if not reaching(rows, scene, SMALL, "MD")] == ["collapse"]
    assert all(reaching(rows, scene, SMALL, "CD") for scene in QUANTITY) and springs["collapse"]["setting"] == 1e8

    def of(setting, gap=0.0):
        flow = max(setting["tolerance"], setting.get("flow_tolerance", 0))
        own = (cd.step == setting["cd_dt"]) & (cd.setting == flow) & (cd.at_rest == setting["tolerance"]) & (cd.gap_correction == gap)
        return cd[own].set_index("scene")

    def beside(setting):
        return (setting.seconds / pandas.Series({scene: row["seconds"] for scene, row in springs.items()}))[others]

    fine, coarser, coarsest, coarse, proposed, strict, default = map(of, (FINE, COARSER, COARSEST, COARSE, PROPOSED, STRICT, DEFAULT))
    off = [100 * own.error.abs() for own in (fine, coarser, coarsest)]
    assert all(error.idxmax() == "collapse" for error in off) and strict.unsolved.idxmax() == "drum" and set(strict.seeds) == {2}
    against, corrected = beside(proposed), of(COARSE, 0.1)
    dearer = corrected.seconds / coarse.seconds
    judged = table[~table.is_rigid_answer & table.apply(_is_judged, axis=1)]
    return {"5.8": gain["hopper"], "5.3": gain["drum"], "9.0": [gain["filling"], middle["filling"], low["filling"]],
            "0.1": [OVERLAP, off[2].min(), 100 * proposed.error.abs().min()], "1.9": 100 * judged.error_deviation.max(), "36": judged.seeds.max(),
            "4.4": [middle["hopper"], dearer.max()], "3.3": middle["drum"], "1.0": low["hopper"],
            "0.6": [low["drum"], off[1].min(), 100 * of(FINEST).error_deviation["collapse"]],
            "23": open_above["hopper"], "4.0": open_above["drum"], "14.0": high["filling"], "2.3": 100 * springs["collapse"]["error"],
            "0.7": [100 * springs["collapse"]["error_deviation"], left[0][1], against.min(), 100 * proposed.error_deviation["collapse"]],
            "3.5": gain["collapse"], "64": open_above["collapse"], "0.082": soft_to_stiff.overlap.iloc[0], "0.0071": soft_to_stiff.overlap.iloc[-1],
            "4.1": 100 * soft_to_stiff.error.iloc[0], "2.6": left[0][0], "1.7": [left[1][0], against.max()], "0.9": left[1][1],
            "0.4": [100 * abs(own.error["collapse"]) for own in (of(FINEST), proposed)],
            "0.0": off[0].min(), "2.2": off[0].max(),
            "2.8": off[1].max(), "5.4": off[2].max(), "0.13": coarse.overlap.max(), "0.03": coarser.overlap.max(),
            **summary.stated("0.67 0.85", coarse.seconds / coarser.seconds), "1.8": dearer.min(),
            "7.6": 100 * abs(corrected.error["drum"]),
            "1.3": [math.log10(0.02 / 1e-3), 100 * proposed.error_deviation.max()], "1.2": 100 * proposed.error.abs().max(),
            "0.2": 100 * proposed.error_deviation.min(),
            **summary.stated("28 84", coarser.sweeps), **summary.stated("6 24", coarse.sweeps), **summary.stated("72 274", proposed.sweeps),
            **summary.stated("803 3674", strict.sweeps), **summary.stated("6.0 14.5", strict.seconds / proposed.seconds),
            "0.53": 100 * strict.unsolved.max(), **summary.stated("1.14 1.28", default.seconds / proposed.seconds),
            **summary.stated("0.89 1.93", beside(default))}
