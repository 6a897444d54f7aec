"""Strain, dissipation and contacts of a run from cycle to cycle, and its regime: shakedown, ratcheting or collapse.

The accumulated permanent strain is gamma at the end of a cycle, where the load is back at P0; its change over a cycle is the strain
rate of Fig. 3. Everything here is per cycle, counted from 1.
"""

from dataclasses import dataclass

import numpy as np

from analysis import observables
from yade_scripts.results.reader import ResultError
from yade_scripts import parameters

SHAKEDOWN, RATCHETING, COLLAPSE, SHORT = "shakedown", "ratcheting", "collapse", "too short"
# Below that a run is too short for any verdict; below the second, for one by its decay, whose shorter octave is then four cycles: one
# slip does not make a trend.
FEWEST_CYCLES, FEWEST_FOR_DECAY = 8, 16
# The standard deviation of a normal distribution over its median absolute deviation.
MAD_TO_SIGMA = 1.4826


@dataclass(frozen=True)
class Rule:
    """The limits between the regimes. They were set with trial runs in view.

    practical: "practically no accumulation" (paper, section 3) is that so many cycles at the late rate would neither double the strain
    nor add `elastic` P0/k_n. At the lowest load springs keep rates of 1e-10 a cycle in cycles that repeat to all digits, and CD creeps
    by its tolerance; nobody would call either ratcheting who runs thousands of cycles.
    significant: times its standard error a change must be to count. decay: p above which a rate n^-p counts as ending; the strain stays
    bounded for p > 1.
    """

    practical: float = 1000
    elastic: float = 1
    significant: float = 3
    decay: float = 1


RULE = Rule()


@dataclass(frozen=True)
class Cycles:
    """One array each, over the completed cycles.

    number: 1, 2, ... permanent: gamma at the end [1]; `start` is gamma at the beginning of the first. rate: change of gamma over the
    cycle [1]. dissipated: energy over P0 V0 [1]. sliding_mean, sliding_max: share of the contacts at the Coulomb limit. contacts:
    2M/N at the end of the cycle, walls' contacts included.
    """

    number: np.ndarray
    start: float
    permanent: np.ndarray
    rate: np.ndarray
    dissipated: np.ndarray
    sliding_mean: np.ndarray
    sliding_max: np.ndarray
    contacts: np.ndarray

    def rates(self, windows):
        """Return the mean strain rate in each window of cycles (first, last), from gamma at its ends."""
        gamma = np.concatenate([[self.start], self.permanent])
        return np.array([(gamma[last] - gamma[first - 1]) / (last - first + 1) for first, last in windows])


def sliding_share(run):
    """Return sliding contacts over contacts that carry a force, at each sample; 0 where there is no contact."""
    contacts = run.values("contacts")
    return run.values("sliding_contacts") / np.maximum(contacts, 1)


def ends(run):
    """Return the numbers of the samples at which a cycle begins or ends, the first included."""
    cycle = run.values("cycle")
    if len(cycle) < 2:
        return np.arange(len(cycle))
    whole = np.round(cycle)
    near = np.abs(cycle - whole) < np.diff(cycle).max() / 4
    # Of several samples near one whole number the first, were the last step of a cycle sampled twice.
    return np.flatnonzero(near)[np.unique(whole[near], return_index=True)[1]]


def of(run):
    """Return the Cycles of a run; ResultError if not one is complete."""
    at = ends(run)
    if len(at) < 2:
        raise ResultError(run.path, "no cycle is complete", "run longer")
    gamma, sliding = run.values("gamma")[at], sliding_share(run)
    parts = [slice(first, last + 1) for first, last in zip(at[:-1], at[1:])]
    scale = observables.work_scale(run)
    return Cycles(
        number=np.arange(1, len(at)), start=float(gamma[0]), permanent=gamma[1:], rate=np.diff(gamma),
        dissipated=np.diff(run.values("dissipated_energy")[at]) / scale,
        sliding_mean=np.array([sliding[part].mean() for part in parts]),
        sliding_max=np.array([sliding[part].max() for part in parts]),
        contacts=2 * run.values("contacts")[at[1:]] / run.parameters["disks"])


def windows(count, growth=1.15):
    """Return windows (first, last) of cycles that cover 1 .. count, each about `growth` times as late as the one before."""
    found, first = [], 1
    while first <= count:
        last = min(count, max(first, round(first * growth)))
        found.append((first, last))
        first = last + 1
    return found


@dataclass(frozen=True)
class Regime:
    """How a run under repeated loading ends; the numbers are NaN where the run is too short.

    late_rate: mean change of gamma per cycle over the last half of the cycles. noise: standard deviation of the rate there, robust,
    which is that of a difference of two readings of gamma. decay: p of a rate that falls as n^-p in the late cycles.
    """

    name: str
    late_rate: float
    decay: float
    noise: float


def regime(run):
    """Return the Regime of a run, by a rule that sees gamma at the ends of the cycles only.

    collapse: the sample gave way, or at its late rate reaches collapse_strain within as many cycles again.
    shakedown: the late change is within the noise or has another sign than the one before; or the rate falls faster than 1/n - then
    the strain stays bounded, since the sum of n^-p does for p > 1; or 1000 cycles at the late rate would add neither the strain so
    far nor P0/k_n. (The numbers are those of RULE.)
    ratcheting: everything else; the strain grows without bound, at a constant rate if p is 0.
    """
    collapsed, found = run.collapsed, None
    try:
        found = of(run)
    except ResultError:
        if not collapsed:
            raise
    count = len(found.number) if found else 0
    if count < FEWEST_CYCLES:
        return Regime(COLLAPSE if collapsed else SHORT, np.nan, np.nan, np.nan)
    half = count // 2
    rate = (found.permanent[-1] - found.permanent[half - 1]) / (count - half)
    late = found.rate[half:]
    noise = MAD_TO_SIGMA * float(np.median(np.abs(late - np.median(late))))
    # Two comparisons, the less favourable of which counts: a slip in the earlier window alone would pass for a decay.
    decay = min(_decay(found, count // 4, half, count), _decay(found, half, half + (count - half) // 2, count))
    within_noise = abs(rate) * (count - half) <= RULE.significant * noise
    name = COLLAPSE if collapsed else _name(run, found, rate, within_noise or decay > RULE.decay)
    return Regime(name, rate, decay, noise)


def late_rate(found):
    """Return the mean change of gamma a cycle over the last half of the cycles; NaN where there are fewer than two, or none (None)."""
    count = len(found.number) if found else 0
    return float(found.rates([(count // 2 + 1, count)])[0]) if count > 1 else np.nan


def last_quarter(run):
    """Return the strain rate of the last quarter of the cycles over that of the quarter before; NaN where there is none. 1: a constant rate."""
    try:
        found = of(run)
    except ResultError:
        return np.nan
    count = len(found.number)
    if count < FEWEST_CYCLES:
        return np.nan
    before, last = found.rates([(count // 2 + 1, 3 * count // 4), (3 * count // 4 + 1, count)])
    return float(last / before) if before else np.nan


def _decay(found, first, middle, last):
    """Return p of a rate that falls as n^-p, from gamma after three numbers of cycles; infinite if the strain stops or turns back."""
    early, late = found.rates([(first + 1, middle), (middle + 1, last)])
    if early * late <= 0:
        return np.inf if early else -np.inf
    return float(-np.log(late / early) / np.log((middle + last) / (first + middle)))


def _name(run, found, rate, ends):
    count, strain = len(found.number), abs(found.permanent[-1])
    if abs(rate) * RULE.practical < max(strain, RULE.elastic * run.pressure * run.parameters["depth"] / parameters.stiffness(run.parameters)):
        return SHAKEDOWN
    if count < FEWEST_FOR_DECAY:
        return SHORT
    if ends:
        return SHAKEDOWN
    return COLLAPSE if run.parameters["collapse_strain"] - strain < abs(rate) * count else RATCHETING
