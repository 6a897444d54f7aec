"""Do springs and rigid contacts give the same profile of velocity in a turning drum?"""
import numpy as np

from analysis import style, summary
from analysis.studies import flows
from yade_scripts.results.reader import AGAIN, ResultError

TITLE = "Profile of velocity in a drum"
QUESTION = ("In a turning drum a layer below the surface flows down, and the bed under it turns with the drum. Do rigid contacts and springs give "
            "the same profile of velocity, and which steps, tolerances and stiffnesses suffice for it?")
ORDER = 20.5  # in the report, after the flows, whose runs it reads

ROWS = {"quick": flows.rows_of("drum", flows.SMALL, [flows.COARSER, flows.COARSEST], 1),
        "full": [row for row in flows.ROWS["full"] if (row["scene"], row["disks"]) == ("drum", flows.SMALL)
                 and not flows.STRICT.items() <= row.items()]}
SHOWN = {"MD": (2e6, 5e6, 2e7), "CD": ((4e-3, 1e-2), (4e-3, 1e-3))}  # settings that are drawn beside the rigid answer


def _key(run):
    row = run.parameters
    return (run.method, *((row["cd_dt"], row["tolerance"], row["gap_correction"]) if run.method == "CD" else (row["md_dt_factor"], row["kn"], 0.0)))


def _mean(values):
    """Return the mean over the first axis and its standard error, without what is NaN."""
    count = np.isfinite(values).sum(axis=0)
    return np.nanmean(values, axis=0), np.nanstd(values, axis=0, ddof=1) / np.sqrt(count) if len(values) > 1 else np.full(values.shape[1:], np.nan)


def _speeds(group):
    """Return the depths of the layers [R] and the speeds in them [omega R], a row a run: from the axis to the last layer but one. The layers above
    and the last one are filled in part."""
    if lacking := [run for run in group if "speed" not in run.extra]:
        raise ResultError(lacking[0].path, "it has no profile of velocity: an earlier version of the scene made it", AGAIN)
    depth = group[0].extra["depth"]
    full = (depth > 0) & (depth < depth[-1])
    return depth[full], np.array([run.extra["speed"][full] for run in group])


def _flowing(depth, speed):
    """Return the depth below the axis [R] down to which a bed flows down: where the speed changes its sign; NaN if it does not."""
    down = np.flatnonzero(speed > 0)
    return float(np.interp(0, -speed[down[-1]:down[-1] + 2], depth[down[-1]:down[-1] + 2])) if len(down) else np.nan


def _rigid(settings):
    """Return the key of the rigid answer: rigid contacts with the smallest step and tolerance, without gap correction."""
    return min(key for key in settings if key[0] == "CD" and key[3] == 0)


def summarize(runs):
    """Return one row a setting, over the seeds.

    surface: speed down the slope in the first layer below the axis, over omega R. flowing: depth of the flowing layer below the axis, over R.
    *_deviation: standard errors. apart: root mean square over the layers of the difference from the rigid answer, over the surface's speed of that.
    p: share of random exchanges of runs between the setting and the rigid answer that make a difference at least as large; if it is small, chance
    does not explain the difference. seconds: processor time, median.
    """
    settings = summary.groups(runs, _key)
    exact = _speeds(settings[_rigid(settings)])[1]
    rows = []
    for key, group in settings.items():
        depth, speeds = _speeds(group)
        row = dict(zip(("method", "step", "setting", "gap_correction", "seeds"), (*key, len(group))))
        for name, values in ("surface", speeds[:, 0]), ("flowing", np.array([_flowing(depth, speed) for speed in speeds])):
            row[name], row[f"{name}_deviation"] = map(float, _mean(values))
        is_rigid = key == _rigid(settings)
        rows.append(row | {"apart": _apart(speeds, exact) / exact[:, 0].mean(), "p": np.nan if is_rigid else _chance(speeds, exact),
                           "is_rigid_answer": is_rigid, "seconds": float(np.median([run.values("processor_time")[-1] for run in group]))})
    return rows


def _apart(some, others):
    """Return the root mean square over the layers of the difference between the mean profiles of two lists of runs."""
    return float(np.sqrt(np.mean((some.mean(axis=0) - others.mean(axis=0))**2)))


def _chance(some, others, exchanges=1999):
    """Return the share of random exchanges of runs between two lists that make a difference at least as large as theirs."""
    dice, whole, found = np.random.default_rng(1), np.concatenate([some, others]), _apart(some, others)
    drawn = [dice.permutation(whole) for _ in range(exchanges)]
    return (1 + sum(_apart(mixed[:len(some)], mixed[len(some):]) >= found for mixed in drawn)) / (1 + exchanges)


def draw(runs, rows, path):
    """Draw the profiles, and their differences from the rigid answer."""
    settings = summary.groups(runs, _key)
    rigid = _rigid(settings)
    exact, exact_error = _mean(_speeds(settings[rigid])[1])
    fig, (whole, apart) = style.plt.subplots(1, 2, figsize=(7.6, 4.0), sharey=True)
    shown = {key: group for key, group in settings.items()
             if key == rigid or key[3] == 0 and (key[2] if key[0] == "MD" else key[1:3]) in SHOWN[key[0]]}
    colours = style.shades([key for key in shown if key != rigid]) | {rigid: "k"}
    for key, group in shown.items():
        depth, speeds = _speeds(group)
        speed, error = _mean(speeds)
        words = f"{1e3 * key[1]:g} ms, {key[2]:g}" if key[0] == "CD" else f"{key[2]:g} N/m"
        look = dict(color=colours[key], marker=style.MARKER[key[0]], ms=3.5, lw=1, mfc="none",
                    label=f"{key[0]}, {words}" + " (rigid answer)" * (key == rigid))
        whole.plot(speed, depth, **look)
        apart.errorbar(speed - exact, depth, xerr=np.hypot(error, exact_error) if key != rigid else None, elinewidth=0.7, **look)
    whole.plot([0, -1], [0, 1], color="0.6", ls="--", lw=1, label="turns with the drum")
    whole.invert_yaxis()
    whole.set(xlabel=r"velocity down the slope / $\omega R$", ylabel="depth below the axis / R")
    apart.set(xlabel=r"difference from the rigid answer / $\omega R$")
    whole.legend(fontsize=7)
    style.finish(fig, path, f"{flows.SMALL} disks, mean over the seeds; bars: standard error of the difference. Labels: step and tolerance, "
                 "or stiffness.", runs)


ANSWER = """
Yes, as far as these runs can tell. In the rigid answer (rigid contacts, steps of 0.25 ms, tolerance 1e-4) disks flow down at 2.19 omega R just below
the axis (standard error 0.04), and the flowing layer ends 0.336 R below the axis (0.003). From this profile the same steps with a tolerance of 1e-3
differ by 0.2 % of that speed (root mean square over the layers), springs of 5e6 to 2e7 N/m by 0.5 to 0.8 %, and rigid contacts with steps of 1 or 2
ms and 1e-3 by 1.0 to 1.2 %. Chance explains that: if runs of the rigid answer and of one of these settings are exchanged at random, the difference is
at least as large in 18 to 99 % of the cases. A run of rigid contacts in steps of 2 ms takes 0.71 s, one with springs of 5e6 N/m 3.8 s, 5.3 times as
long.

Three settings differ by so much that chance makes it in less than 1 % of the cases: steps of 4 ms, by 2.2 % with a tolerance of 1e-3 and by 2.9 %
with 1e-2, and a gapCorrection of 0.1, by 5.7 %, with a surface that is 16 % slower (3.0 %). Steps of 0.5 ms to 1e-4 differ by 1.7 %; chance makes
that in 4 % of the cases. As 12 settings are compared, these shares have to be corrected (Holm's method). They are then 8 and 10 % for the steps of 4
ms and 0.6 % for the gapCorrection: only this one surely differs. The two settings of 4 ms deviate in opposite directions: the flowing layer ends
0.328 R below the axis with 1e-3 and 0.358 R with 1e-2. Differences of up to 1.2 % cannot be told from chance with these runs.
"""
GIVEN = ("0.25", "1e-4", "1e-3", "5e6", "2e7", "1", "2", "4", "1e-2", "0.1")


def numbers(table):
    rigid, = table[table.is_rigid_answer].itertuples()
    settings = table.set_index(["step", "setting", "gap_correction"]).sort_index()

    def of(setting, gap=0.0):
        return settings.loc[(setting["cd_dt"], setting["tolerance"], gap) if setting["method"] == "CD" else
                            (setting["md_dt_factor"], setting["kn"], 0.0)]

    def apart(*these):
        return [100 * of(setting).apart for setting in these]

    same, rough, soft = (flows.FINEST,), (flows.FINE, flows.COARSER), (flows.MIDDLE, flows.HARDER, flows.STIFF)
    chance = [100 * of(setting).p for setting in same + rough + soft]
    pushed, proposed, cd, md = of(flows.COARSE, 0.1), of(flows.PROPOSED), of(flows.COARSER).seconds, of(flows.MIDDLE).seconds
    longest, longest_rough = (of(flows.COARSEST | {"tolerance": tolerance}) for tolerance in (1e-3, 1e-2))
    assert sorted(table.p.dropna())[:3] == sorted([longest.p, longest_rough.p, pushed.p]) and 0.01 > sorted(table.p.dropna())[2]
    chances = table.p.dropna().sort_values().to_numpy()
    holm = np.maximum.accumulate(chances * np.arange(len(chances), 0, -1))
    assert chances[0] == pushed.p
    return {"2.19": rigid.surface, "0.04": rigid.surface_deviation, "0.336": rigid.flowing, "0.003": rigid.flowing_deviation,
            "0.2": apart(*same), "0.5": [min(apart(*soft)), 1e3 * flows.PROPOSED["cd_dt"]], "0.8": max(apart(*soft)), "1.0": min(apart(*rough)),
            "1.2": max(apart(*rough)), "18": min(chance), "99": max(chance), "0.71": cd, "3.8": md, "5.3": md / cd, "2.2": 100 * longest.apart,
            "2.9": 100 * longest_rough.apart, "5.7": 100 * pushed.apart, "16": 100 * (1 - pushed.surface / rigid.surface),
            "3.0": 100 * np.hypot(pushed.surface_deviation, rigid.surface_deviation) / rigid.surface, "1.7": 100 * proposed.apart,
            "12": len(table) - 1, "8": 100 * holm[1], "10": 100 * holm[2], "0.6": 100 * holm[0],
            "0.328": longest.flowing, "0.358": longest_rough.flowing}
