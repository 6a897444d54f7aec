"""The paper's statements, in its order, beside what the studies measure: each judged by numbers alone.

A judge gets the rows of one study's summary and returns (verdict, measured in words). Quotations are of Garcia-Rojo, McNamara and
Herrmann (2004); where they say less than they seem to, the judge's sentence says what was counted.
"""

from dataclasses import dataclass
from typing import Callable

import numpy as np

from analysis import cycles, schema
from analysis.studies import fig3, summary

AGREES, PARTLY, DISAGREES, OPEN = "agrees", "agrees in part", "disagrees", "open"


@dataclass(frozen=True)
class Point:
    """One statement: its words, where they stand, the study that measures it, and the judge."""

    quote: str
    where: str
    study: str
    judge: Callable


def of_study(name, rows):
    """The judged points of a study as plain data; a judge that finds too few rows leaves its point open."""
    return [dict(zip(("verdict", "measured"), point.judge(rows)), quote=point.quote, where=point.where, order=number)
            for number, point in enumerate(POINTS) if point.study == name]


# Shares of the runs above which a statement holds, and below which it does not.
MOST, FEW = 0.8, 0.2


def _verdict(holding, all_of):
    """Of so many runs in which a statement holds."""
    if not all_of:
        return OPEN
    return AGREES if holding >= MOST * all_of else DISAGREES if holding <= FEW * all_of else PARTLY


def _where(rows, **wanted):
    return [row for row in rows if all(row.get(name) == value for name, value in wanted.items())]


def _shakes_down(rows):
    lowest = min(row["dSigma"] for row in rows)
    low = [row for row in _where(rows, method="MD", dSigma=lowest) if row["regime"] != cycles.SHORT]
    held = sum(row["regime"] == cycles.SHAKEDOWN for row in low)
    return _verdict(held, len(low)), (f"MD at dSigma = {lowest:g}: {held} of {len(low)} runs shake down, at a late rate of "
                                      f"{summary.spread(abs(row['late rate']) for row in low)} a cycle.")


def _sliding_vanishes(rows):
    still = _where(rows, method="MD", regime=cycles.SHAKEDOWN)
    name = "sliding at most, last cycle"
    gone = sum(row[name] == 0 for row in still)
    return _verdict(gone, len(still)), (
        f"Of {len(still)} MD runs that shake down, {gone} have no sliding contact left. At most {summary.spread(100 * row[name] for row in still)} % "
        f"of the contacts still slide within the last cycle (in the first {summary.spread(100 * row['sliding at most, first cycle'] for row in still)} %), "
        f"at its quietest {summary.spread(100 * row['sliding at least, last cycle'] for row in still)} %: they slide to and fro and dissipate "
        f"{summary.spread(row['dissipated/P0V0, last cycle'] for row in still)} P0 V0 a cycle without straining the sample.")


def _ratchets(rows):
    found = _where(rows, method="MD", regime=cycles.RATCHETING)
    judged = [row for row in _where(rows, method="MD") if row["regime"] != cycles.SHORT]
    constant = sum(cycles.is_constant(row["last quarter's rate over the one before"]) for row in found)
    return _verdict(constant, len(found)) if judged else OPEN, (
        f"{len(found)} of {len(judged)} MD runs ratchet, at {summary.spread(abs(row['late rate']) for row in found)} a cycle; in {constant} of them "
        f"the rate is constant (within a factor of 2 from the third to the last quarter of the cycles). From one cycle to the next their sliding contacts differ by "
        f"{summary.spread(100 * row['sliding, change of a cycle'] for row in found)} % (rms).")


def _collapses(rows):
    by_preparation = summary.groups([row for row in _where(rows, method="MD") if row["dSigma"] >= 0.4], lambda row: row["preparation friction"])
    counts = {friction: (sum(row["regime"] == cycles.COLLAPSE for row in same), len(same)) for friction, same in by_preparation.items()}
    held, total = (sum(part) for part in zip(*counts.values())) if counts else (0, 0)
    words = "; ".join(f"prepared with mu = {friction:g}: {some} of {of} runs" for friction, (some, of) in counts.items())
    return _verdict(held, total), f"MD at dSigma of 0.40 and more collapses as follows. {words[:1].upper()}{words[1:]}."


def _differs(rows):
    name = f"regime after {fig3.COMPARED}"
    pairs = summary.pairs(rows, ("preparation friction", "dSigma", "seed"))
    return _verdict(sum(md[name] != cd[name] for md, cd in pairs), len(pairs)), fig3.paired(rows)


def _weaker_in_cd(rows):
    ratios = [abs(md["largest |gamma|"] / cd["largest |gamma|"]) for md, cd in summary.pairs(rows, ("seed",)) if cd["largest |gamma|"]]
    return _verdict(sum(ratio > 1 for ratio in ratios), len(ratios)), (
        f"On the same packing MD strains {summary.spread(ratios)} times as far as CD.")


def _dissipates_more(rows):
    pairs = summary.pairs(rows, ("seed",))
    held = sum(md["dissipated/P0V0"] > cd["dissipated/P0V0"] and abs(md["remanent gamma"]) > abs(cd["remanent gamma"]) for md, cd in pairs)
    return _verdict(held, len(pairs)), (
        f"Both hold on {held} of {len(pairs)} packings: dissipated {summary.spread(md['dissipated/P0V0'] for md, _ in pairs)} P0 V0 in MD against "
        f"{summary.spread(cd['dissipated/P0V0'] for _, cd in pairs)} in CD, remanent |gamma| {summary.spread(abs(md['remanent gamma']) for md, _ in pairs)} "
        f"against {summary.spread(abs(cd['remanent gamma']) for _, cd in pairs)}.")


def _precision(rows):
    solved = sorted(_where(rows, effort="tolerance"), key=lambda row: row["value"])
    if len(solved) < 2:
        return OPEN, "Fewer than two tolerances have finished."
    best, worst = solved[0], solved[-1]
    falling = all(small["largest"] < large["largest"] for small, large in zip(solved, solved[1:]))
    return AGREES if falling else PARTLY, (
        f"From a tolerance of {worst['value']:.0e} to one of {best['value']:.0e} CD's largest |gamma| falls from {summary.number(worst['largest'])} to "
        f"{summary.number(best['largest'])}: " + ("it is the precision throughout." if falling else "not at every step of the way."))


def _drifts(rows):
    md = _where(rows, method="MD")
    first, last = ([row[f"load at |gamma| = {threshold}"] for row in md] for threshold in ("0.0001", "0.01"))
    early = sum(a < 1 + 0.5 * (b - 1) for a, b in zip(first, last))
    expanding = sum(row["least volume strain"] > -1e-5 for row in md)
    slow = _verdict(early, len(md))
    return PARTLY if slow == AGREES and _verdict(expanding, len(md)) != AGREES else slow, (
        f"It strains from the start: MD passes |gamma| = 1e-4 at {summary.spread(first, 3)} P0, long before 1e-2 at {summary.spread(last, 3)} P0. But the "
        f"area shrinks at first in {len(md) - expanding} of {len(md)} runs, by at most {summary.spread(-row['least volume strain'] for row in md)}; gamma < 0 "
        "throughout, which is a sample that shortens along the axis with the rising load.")


def _sudden(rows):
    pairs = summary.pairs(rows, ("seed", "preparation friction", "ramp rate"))
    name = "largest jump of gamma before yield"
    held = sum(md[name] > cd[name] for md, cd in pairs)
    return _verdict(held, len(pairs)), (
        f"Largest change of gamma from sample to sample before |gamma| = 0.01: MD {summary.spread(md[name] for md, _ in pairs)}, CD "
        f"{summary.spread(cd[name] for _, cd in pairs)}; MD jumps further than CD on {held} of {len(pairs)} packings.")


def _rests(rows):
    cd = _where(rows, method="CD")
    first, last = ([row[f"load at |gamma| = {threshold}"] for row in cd] for threshold in ("0.0001", "0.01"))
    resting = sum(a > 1 + 0.5 * (b - 1) for a, b in zip(first, last))
    expanded = sum(row["volume strain at the end"] > 0 for row in cd)
    return _verdict(min(resting, expanded), len(cd)), (
        f"CD stays below |gamma| = 1e-4 up to {summary.spread(first, 3)} P0 and passes 1e-2 at {summary.spread(last, 3)} P0; the contacts that slide "
        f"reach the bound 2M - 3N at {summary.spread((row['load where sliding reaches the bound'] for row in cd), 3)} P0. In the end the area has grown in "
        f"{expanded} of {len(cd)} runs.")


def _unaltered(rows):
    pairs = summary.pairs(rows, ("seed", "preparation friction", "ramp rate"))
    held = sum(cd["load at |gamma| = 0.01"] > md["largest load"] for md, cd in pairs)
    return _verdict(held, len(pairs)), (
        f"When MD collapses, at {summary.spread((md['largest load'] for md, _ in pairs), 3)} P0, CD has passed |gamma| = 0.01 in {len(pairs) - held} of "
        f"{len(pairs)} packings, at {summary.spread((cd['load at |gamma| = 0.01'] for _, cd in pairs), 3)} P0.")


def _no_collapse(rows):
    cd = _where(rows, method="CD")
    whole = sum(row["outcome"] == schema.OUTCOME_COMPLETED for row in cd)
    further = summary.finite(row["largest load"] / row["load at |gamma| = 0.0001"] for row in cd)
    # Load that rises by another twentieth after the first motion was carried by a sample that had given way and not collapsed.
    carried = int(np.sum(further > 1.05))
    verdict = _verdict(whole, len(cd))
    return PARTLY if verdict == DISAGREES and carried else verdict, (
        f"After |gamma| = 1e-4 the load rises by another {summary.spread(100 * (further - 1))} % before the end, in steps of expansion and rest "
        f"(by more than 5 % in {carried} of {len(cd)} runs); in the end {len(cd) - whole} of {len(cd)} CD runs collapse, at most at "
        f"{summary.spread((row['largest load'] for row in cd), 3)} P0. The paper does not say how far its ramp went.")


def _resistant(rows):
    pairs = summary.pairs(rows, ("seed", "preparation friction", "ramp rate"))
    names = [f"load at |gamma| = {threshold}" for threshold in ("0.0001", "0.001", "0.01")] + ["largest load"]
    ratio = {name: summary.finite(cd[name] / md[name] for md, cd in pairs) for name in names}
    # "Much more": at least a tenth more load before collapse.
    collapsed = [(md, cd) for md, cd in pairs if md["outcome"] != schema.OUTCOME_COMPLETED]
    much = sum(cd["largest load"] > 1.1 * md["largest load"] for md, cd in collapsed)
    words = "; ".join(f"{name} {summary.spread(values, 3)}" for name, values in ratio.items())
    return _verdict(much, len(collapsed)), (
        f"CD's loads over MD's on the same packing: {words}. Of {len(collapsed)} packings that collapse in MD, CD carries more than a tenth more than MD "
        f"did on {much}; what differs is the strain on the way.")


def _jumps(rows):
    cd, md = _where(rows, method="CD"), _where(rows, method="MD")
    apart = summary.finite(row["networks apart at start"] for row in cd)
    motion = [row["motion over R, median"] for row in cd]
    changes = {method: summary.spread(100 * row["force change, median"] for row in own) for method, own in (("CD", cd), ("MD", md)) if own}
    held = int(np.sum(apart > 0.05))
    return _verdict(held, len(apart)), (
        f"It can: {len(apart)} networks that are {summary.spread(100 * apart)} % of the mean force (rms) from the springs' own carry the same packing, and no "
        f"grain moves by more than {summary.spread(motion)} R from snapshot to snapshot below the limit. Left to itself it follows the load as MD does: "
        + "; ".join(f"{method}'s forces change by {words} %" for method, words in changes.items()) + " from snapshot to snapshot.")


def _because_of_indeterminacy(rows):
    cd = _where(rows, method="CD")
    name = "load at 0.0001"
    networks = [row for row in cd if row["network"] > 0]
    if not networks:
        return OPEN, "No ramp from another network has finished."
    place = (networks[0]["preparation mu"], networks[0]["seed"])
    same = summary.finite(row[name] for row in cd if (row["preparation mu"], row["seed"]) == place)
    ratio = summary.finite(row[name] / row["limit load"] for row in cd)
    # The load would have to depend on which of the admissible networks the run starts from: by a per cent at least.
    matters = np.ptp(same) >= 0.01 * same.mean()
    return (AGREES if matters else DISAGREES), (
        f"From {len(same)} different networks of one packing CD yields at {summary.spread(same, 4)} P0: the network {'matters' if matters else 'does not matter'}. "
        "The critical load "
        f"is {summary.spread(ratio, 4)} times the static limit of the contacts' geometry and friction, which knows no network.")


POINTS = (
    Point("If the loadings are low enough, the excitations shakedown in the material. [...] there will be practically no accumulation of permanent "
          "strain.", "section 3, Fig. 3", "fig3", _shakes_down),
    Point("This is related to the disappearance of sliding contacts in the sample.", "section 3, Fig. 3", "fig3", _sliding_vanishes),
    Point("the strain rate does not apparently diminish, leading to a fast failure of the material. This incremental collapse can be seen in cases "
          "dSigma = 0.40 and dSigma = 0.50 of the figure.", "section 3, Fig. 3", "fig3", _collapses),
    Point("For loads above the shakedown limit but far from collapse, the material accumulates permanent strain at a constant but very small rate. This "
          "behavior is associated to a quasi-periodic response of the sliding contacts [...].", "section 3, Fig. 3", "fig3", _ratchets),
    Point("The perturbation that the loading exerts on the system is much weaker in the CD simulation", "section 3, Fig. 4", "fig4", _weaker_in_cd),
    Point("and related to the precision of the method.", "section 3, Fig. 4", "tolerance", _precision),
    Point("But note also that the energy dissipated is bigger in the MD cycle, and so is the remanent strain at the end of the process.",
          "section 3, Fig. 4", "fig4", _dissipates_more),
    Point("In the MD simulation, the system starts expanding slowly.", "section 3, Fig. 5", "fig5", _drifts),
    Point("A sudden compression is perceived [...], after which the deformation rate seems to grow [...]. In the CD simulation, the response is smoother "
          "than in the MD case.", "section 3, Fig. 5", "fig5", _sudden),
    Point("This leads to a collapse of the sample at the end of the simulation. In this range of values, however, the CD simulated sample seems to remain "
          "unaltered.", "section 3, Fig. 5", "fig5", _unaltered),
    Point("At a first stage, the system seems not to be affected by the imposed loading. There is however a critical load, beyond which, the system "
          "expands.", "section 3, Fig. 5", "fig5", _rests),
    Point("this expansion is carried out without any collapse or breakage of the physical structure of the grains.", "section 3, Fig. 5", "fig5",
          _no_collapse),
    Point("The response of the material is more apparent in the MD simulation, while CD is much more resistant to collapse.", "section 4", "fig5",
          _resistant),
    Point("A different behavior of the plastic response of a system simulated by a MD algorithm and a CD algorithm has been shown.", "section 4", "fig3",
          _differs),
    Point("This behavior is probably related to the indeterminacy of the forces in the CD method.", "section 4", "critical_load",
          _because_of_indeterminacy),
    Point("The system can jump from one force configuration to another without any movement of the particles.", "section 4", "critical_load", _jumps),
)
