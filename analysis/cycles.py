"""Strain, dissipation and contacts of a run from cycle to cycle.

The accumulated permanent strain is gamma at the end of a cycle, where the load is back at P0; its change over a cycle is the strain
rate of Fig. 3. Everything here is per cycle, counted from 1. Only rates are computed: whether a falling rate will reach zero cannot be known from
the cycles that were run.
"""
from dataclasses import dataclass

import numpy as np

from analysis import observables


@dataclass(frozen=True)
class Cycles:
    """One array each, over the completed cycles.

    number: 1, 2, ... permanent: gamma at the end [1]; `start` is gamma at the beginning of the first. rate: change of gamma over the
    cycle [1]. dissipated: energy over P0 V0 [1]. sliding_max: largest share of the contacts at the Coulomb limit. contacts:
    2M/N at the end of the cycle, walls' contacts included.
    """
    number: np.ndarray
    start: float
    permanent: np.ndarray
    rate: np.ndarray
    dissipated: np.ndarray
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
    if len(cycle := run.values("cycle")) < 2:
        return np.arange(len(cycle))
    whole = np.round(cycle)
    near = np.abs(cycle - whole) < np.diff(cycle).max() / 4
    # The first of several samples near one whole number, in case the last step of a cycle was sampled twice.
    return np.flatnonzero(near)[np.unique(whole[near], return_index=True)[1]]


def of(run):
    """Return the Cycles of a run; None if no cycle is complete, because the sample collapsed in the first."""
    if len(at := ends(run)) < 2:
        return None
    gamma, sliding = run.values("gamma")[at], sliding_share(run)
    scale = observables.work_scale(run)
    return Cycles(
        number=np.arange(1, len(at)), start=float(gamma[0]), permanent=gamma[1:], rate=np.diff(gamma),
        dissipated=np.diff(run.values("dissipated_energy")[at]) / scale,
        sliding_max=np.array([sliding[first:last + 1].max() for first, last in zip(at[:-1], at[1:])]),
        contacts=2 * run.values("contacts")[at[1:]] / run.parameters["disks"])


def windows(count):
    """Return windows (first, last) of cycles that cover 1 .. count, each about 1.15 times as late as the one before."""
    found = [(0, 0)]
    while (first := found[-1][1] + 1) <= count:
        found.append((first, min(count, max(first, round(first * 1.15)))))
    return found[1:]


def late_rate(found):
    """Return the mean change of gamma a cycle over the last half of the cycles; NaN where there are fewer than two, or none (None)."""
    count = len(found.number) if found else 0
    return float(found.rates([(count // 2 + 1, count)])[0]) if count > 1 else np.nan


def last_quarter(found):
    """Return the mean rate of the last quarter of the cycles over that of the quarter before: 1 for a constant rate. NaN below eight cycles."""
    count = len(found.number) if found else 0
    if count < 8:
        return np.nan
    before, last = found.rates([(count // 2 + 1, 3 * count // 4), (3 * count // 4 + 1, count)])
    return float(last / before) if before else np.nan
