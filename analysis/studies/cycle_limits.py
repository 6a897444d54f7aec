"""The limits of load cycles, computed from the packing alone, beside what springs and rigid grains do below and above each."""
import numpy as np
import pandas

from analysis import cycles, limits, slip, style, summary
from analysis.style import plt
from yade_scripts.tables import product

TITLE = "Below which load does slip stop?"
QUESTION = "Limits from linear programmes, beside springs of MD and of Contact Dynamics and rigid contacts, at loads below and above them."
ORDER = 3.2  # in the report
CYCLES = 20
LOADING = dict(loading="cosine", records_per_cycle=20, wall_mass_ratio=1.0, cycles=CYCLES)
# Slow for springs of k_n (study influence), at 200 steps a half cycle. MD has the cycles and the step of Fig. 3, which make it affordable.
SPRINGS = dict(method="CD", cd_contacts="springs", cd_dt=5e-3, period=2.0, **LOADING)
RIGID = dict(method="CD", cd_dt=5e-3, period=2.0, tolerance=1e-8, **LOADING)
MD = dict(method="MD", md_dt_factor=0.3, md_walls="force", period=0.5, **LOADING)
LOADS = {"constant": (0.0002, 0.0005, 0.002, 0.01, 0.03, 0.1, 0.2, 0.4, 0.6), "mean": (0.0002, 0.0005, 0.002, 0.01, 0.03, 0.1, 0.2, 0.3)}
# (alternating, shakedown, ratchet) of the dense packings 1 to 5, rounded (`python3 -m analysis limits`): for loads just below and above.
BOUNDS = {
    "constant": ((0.00117, 0.0892, 0.1032), (0.0054, 0.0219, 0.0296), (0.00513, 0.0909, 0.1045), (0.00343, 0.0909, 0.1018),
                 (0.0011, 0.0341, 0.0495)),
    "mean": ((0.000567, 0.0454, 0.0527), (0.00284, 0.0105, 0.0142), (0.0013, 0.0554, 0.0671), (0.00193, 0.0483, 0.0562),
             (0.000494, 0.0145, 0.0212))}
KINDS = {"MD": "springs (MD)", "springs": "springs (CD)", "rigid": "rigid contacts (CD)"}
LIMITS = ("alternating", "shakedown", "ratchet", "static")


def _rows(seeds, setting, loads=LOADS, **others):
    return [row for path, several in loads.items() for row in product(stress_path=path, delta_sigma=several, seed=seeds, **others, **setting)]


def _near(seeds, setting):
    """Return rows at 0.9 and 1.1 times the alternating limit, at 0.9 times the shakedown limit, up to the ratchet limit and at 1.1 times that."""
    return [row for path, packings in BOUNDS.items() for seed in seeds for alternating, shakedown, ratchet in (packings[seed - 1],)
            for load in (0.9 * alternating, 1.1 * alternating, 0.9 * shakedown, np.sqrt(shakedown * ratchet), 1.1 * ratchet)
            for row in product(stress_path=path, delta_sigma=float(f"{load:.3g}"), seed=seed, **setting)]


ROWS = {"quick": _rows((1,), SPRINGS, {"constant": (0.002, 0.1)}) + _rows((1,), RIGID, {"constant": (0.1,)}),
        "full": _rows(range(1, 6), SPRINGS) + _rows(range(1, 4), SPRINGS, preparation_friction=0.1)
        + _rows(range(1, 6), RIGID, {"constant": (0.1, 0.2, 0.4), "mean": (0.1,)})  # below the static limit; above it: Fig. 3
        + _rows((1, 2), MD) + _near(range(1, 6), SPRINGS) + _near((1, 2), RIGID) + _near((1, 2), MD)}


def kind(run):
    """Return a key of KINDS."""
    return "MD" if run.method == "MD" else "springs" if run.parameters["cd_contacts"] == "springs" else "rigid"


@summary.each
def summarize(run):
    """Return the row of a run: the limits of its packing as dSigma, how far a contact slips, on average, in the first and the last unloading [mean
    radii], and the strain of the first cycle and a cycle in the second half of them."""
    found, own = cycles.of(run), limits.of_cycles(run)
    row = {"medium": kind(run)} | summary.columns(run, "stress path", "preparation friction", "dSigma", "seed", "collapses after")
    row |= {name: getattr(own, name) for name in ("first_slip", "alternating", "shakedown", "ratchet", "opening", "static")}
    stands = len(found.number) == run.parameters["cycles"]
    first, last = (slip.over(run, [pair])[0] for pair in (run.snapshots[1:3], run.snapshots[-2:])) if stands else (np.nan, np.nan)
    row |= {"slip, first unloading": first, "slip, last unloading": last}
    return row | summary.columns(run, "first cycle", "late rate", "unsolved steps")


COLOUR = {"MD": style.COLOUR["MD"], "springs": style.GREEN, "rigid": style.COLOUR["CD"]}
MARKER = {"MD": "o", "springs": "s", "rigid": "D"}


def draw(runs, rows, path):
    """Draw slip and strain of late cycles against the load over each limit."""
    fig, axes = plt.subplots(2, len(LIMITS), figsize=(13, 6.6), sharey="row", sharex="col")
    table = pandas.DataFrame(rows)
    stands = table["collapses after"].isna()
    for column, limit in zip(axes.T, LIMITS):
        for axis, name in zip(column, ("slip, last unloading", "late rate")):
            for medium, own in table[stands].groupby("medium"):
                for friction, part in own.groupby("preparation friction"):
                    axis.plot(part.dSigma / part[limit], part[name].abs(), ls="", marker=MARKER[medium], ms=2.5 if friction else 5,
                              mfc="none" if medium == "MD" else COLOUR[medium], color=COLOUR[medium], label=None if friction else KINDS[medium])
            top = table.loc[stands, name].abs().max()
            for medium, own in table[~stands].groupby("medium"):
                axis.plot(own.dSigma / own[limit], np.full(len(own), 3 * top), "x", ms=5, color=COLOUR[medium])
            axis.axvline(1, color="k", lw=0.7, ls=":")
            axis.set(xscale="log", yscale="log")
        column[1].set_xlabel(rf"$\Delta\sigma$ over the {limit} limit")
    axes[0, 0].set_ylabel("slip of a contact in the last unloading / R")
    axes[1, 0].set_ylabel(r"$|\Delta\gamma|$ a cycle, late cycles")
    axes[0, 0].legend(fontsize=7)
    style.finish(fig, path, f"Each point is a run of {CYCLES} cycles. Small points: loose packings. A cross at the top: a collapse. Late cycles: "
                 "their second half. Above the shakedown limit (Melan) slip cannot stop while all contacts stay "
                 "closed; above the ratchet limit (Koiter) strain can grow by a mechanism.", runs)


def quantities(table):
    first, last, late = "slip, first unloading", "slip, last unloading", "late rate"
    stands = table[table["collapses after"].isna()]
    springs, rigid = stands[stands.medium != "rigid"], stands[stands.medium == "rigid"]
    below = springs[springs.dSigma < springs.alternating]
    between = springs[(springs.dSigma > springs.alternating) & (springs.dSigma < springs.static)]
    dense_between, loose_between = (between[(between["preparation friction"] > 0) == loose] for loose in (False, True))
    packings = table.drop_duplicates(["stress path", "preparation friction", "seed"])
    held = packings[packings["stress path"] == "constant"]
    dense_held, loose_held = held[held["preparation friction"] == 0], held[held["preparation friction"] > 0]
    dense_mean = packings[(packings["stress path"] == "mean") & (packings["preparation friction"] == 0)]
    below_md, below_cd = (below[below.medium == medium] for medium in ("MD", "springs"))
    worst_cd = below_cd.loc[below_cd[last].idxmax()]
    loose_mean = packings[(packings["stress path"] == "mean") & (packings["preparation friction"] > 0)]

    def by_load(rows):
        """Return the rows of springs in CD from the alternating to Melan's limit, from Koiter's to half the static limit, and from there on."""
        own = rows[rows.medium == "springs"]
        near = own.dSigma >= 0.5 * own.static
        return own[own.dSigma < own.shakedown], own[(own.dSigma > own.ratchet) & ~near], own[near]

    def near_of(medium):
        """Return (median slip in the last unloading, runs) of dense packings just below Melan's limit, up to Koiter's, and just above that."""
        own = stands[(stands.medium == medium) & (stands["preparation friction"] == 0)]
        below, above = (own.dSigma / own.shakedown).between(0.85, 0.95), (own.dSigma / own.ratchet).between(1.05, 1.15)
        parts = below, own.dSigma.between(own.shakedown, own.ratchet), above
        return [(own[part][last].median(), int(part.sum())) for part in parts]

    near, near_md = near_of("springs"), near_of("MD")
    assert min(count for _, count in near) >= 10 and min(count for _, count in near_md) >= 4
    beyond_md = springs[(springs.medium == "MD") & (springs.dSigma / springs.alternating).between(1.05, 1.15)]
    rates = [[(part[late].abs().median(), len(part)) for part in by_load(rows)] for rows in (dense_between, loose_between)]

    rigid_below = rigid[rigid.dSigma < 0.9 * rigid.static]
    paper = dense_between[(dense_between["stress path"] == "mean") & (dense_between.dSigma == 0.1)]  # the lowest load of the paper's Fig. 3
    return locals() | {"cycles": CYCLES, "kept": lambda rows: rows[last] / rows[first]}
