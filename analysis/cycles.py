"""Strain, dissipation and contacts of a run from cycle to cycle.

The accumulated permanent strain is gamma at the end of a cycle, where the load is back at P0; its change over a cycle is the strain
rate of Fig. 3. Everything here is per cycle, counted from 1. Only rates are computed: whether a falling rate will reach zero cannot be known from
the cycles that were run.
"""
from dataclasses import dataclass

import numpy as np

from analysis import observables
from yade_scripts.results import reader


@dataclass(frozen=True)
class Cycles:
    """One array each, over the completed cycles; all are empty if the sample collapsed in the first.

    number: 1, 2, ... gamma: at the beginning of the first cycle and at the end of each [1]. sliding_max: largest share of the contacts at the Coulomb
    limit. contacts: 2M/N at the end of the cycle, walls' contacts included. ends: the samples at the beginning of the first cycle and at the end of
    each.
    """
    run: reader.Run
    ends: np.ndarray
    number: np.ndarray
    gamma: np.ndarray
    sliding_max: np.ndarray
    contacts: np.ndarray

    @property
    def dissipated(self):
        """Energy dissipated in each cycle over P0 V0 [1]."""
        return np.diff(self.run.values("dissipated_energy")[self.ends]) / observables.work_scale(self.run)

    @property
    def permanent(self):
        """gamma at the end of each cycle [1]."""
        return self.gamma[1:]

    @property
    def rate(self):
        """Change of gamma over each cycle [1]."""
        return np.diff(self.gamma)

    @property
    def first(self):
        """Change of gamma over the first cycle; NaN if it is not complete."""
        return self.rate[0] if len(self.number) else np.nan

    def rates(self, windows):
        """Return the mean strain rate in each window of cycles (first, last), from gamma at its ends."""
        return np.array([(self.gamma[last] - self.gamma[first - 1]) / (last - first + 1) for first, last in windows])

    @property
    def late_rate(self):
        """Mean change of gamma a cycle over the last half of the cycles; NaN where there are fewer than two."""
        count = len(self.number)
        return self.rates([(count // 2 + 1, count)])[0] if count > 1 else np.nan

    @property
    def last_quarter(self):
        """Mean rate of the last quarter of the cycles over that of the quarter before: 1 for a constant rate. NaN below eight cycles."""
        count = len(self.number)
        if count < 8:
            return np.nan
        before, last = self.rates([(count // 2 + 1, 3 * count // 4), (3 * count // 4 + 1, count)])
        return last / before if before else np.nan


def error_of_mean(rates, blocks=10):
    """Return the standard error of the mean of the rates of successive cycles, from the means of blocks of them; NaN for fewer cycles than blocks."""
    if len(rates) < blocks:
        return np.nan
    return float(np.std([block.mean() for block in np.array_split(rates, blocks)], ddof=1) / np.sqrt(blocks))


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
    """Return the Cycles of a run."""
    at, sliding = ends(run), sliding_share(run)
    return Cycles(
        run=run, ends=at, number=np.arange(1, len(at)), gamma=run.values("gamma")[at],
        sliding_max=np.array([sliding[first:last + 1].max() for first, last in zip(at[:-1], at[1:])]),
        contacts=2 * run.values("contacts")[at[1:]] / run.parameters["disks"])


def windows(count):
    """Return windows (first, last) of cycles that cover 1 .. count, each about 1.15 times as late as the one before."""
    found = [(0, 0)]
    while (first := found[-1][1] + 1) <= count:
        found.append((first, min(count, max(first, round(first * 1.15)))))
    return found[1:]
