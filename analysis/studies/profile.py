"""Do springs and rigid contacts give the same profile of velocity in a turning drum?"""
import numpy as np
import pandas

from analysis import style, summary
from analysis.flow_costs import COARSE, COARSER, COARSEST, FINE, FINEST, HARDER, MIDDLE, PROPOSED, SMALL, SOFT, STIFF, rows_of
from yade_scripts.results.reader import AGAIN, ResultError

TITLE = "Profile of velocity in a drum"
QUESTION = "Do rigid contacts and springs give the same profile, and which settings suffice?"
ORDER = 32  # in the report
PART = "engine"

COMPARED = [FINEST, PROPOSED, FINE, COARSER, COARSEST, COARSE, MIDDLE, HARDER, STIFF, FINEST | {"tolerance": 1e-4}]
OTHERS = [COARSE | {"gap_correction": 0.1}, COARSE | {"cd_dt": 4e-3}, SOFT]
ROWS = {"quick": rows_of("drum", SMALL, [COARSER, COARSEST], 1),
        "full": rows_of("drum", SMALL, COMPARED, range(1, 37)) + rows_of("drum", SMALL, OTHERS, range(1, 13))}
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
    style.finish(fig, path, f"{SMALL} disks, mean over the seeds; bars: standard error of the difference. Labels: step and tolerance, "
                 "or stiffness.", runs)


def quantities(table):
    rigid, = table[table.is_rigid_answer].itertuples()
    settings = table.set_index(["step", "setting", "gap_correction"]).sort_index()

    def of(setting, gap=0.0):
        return settings.loc[(setting["cd_dt"], setting["tolerance"], gap) if setting["method"] == "CD" else
                            (setting["md_dt_factor"], setting["kn"], 0.0)]

    fine, coarser, middle, harder, stiff, longest = map(of, (
        FINE, COARSER, MIDDLE, HARDER, STIFF, COARSEST))
    rough, soft = pandas.DataFrame([fine, coarser]), pandas.DataFrame([middle, harder, stiff])
    corrected, longest_rough = of(COARSE, 0.1), of(COARSEST | {"tolerance": 1e-2})
    chances = table.p.dropna().sort_values().to_numpy()
    holm = np.minimum(np.maximum.accumulate(chances * np.arange(len(chances), 0, -1)), 1)
    assert holm[0] > 0.05 and chances[0] == longest_rough.p
    return locals()
