"""Checks at every sample whether the walls carry the prescribed stress. Needs no YADE."""
from yade_scripts import parameters

# Largest accepted stress error in P0, and number of samples in a row that may exceed it. A working servo has errors of 1e-4 to 4e-4 (rms, t0 = 4 to
# 1 s), a locked one of 0.4 to 1; walls with mass lag during a collapse. If the error lasts for more than a few samples, the loading is wrong.
TOLERANCE, SAMPLES = 0.05, 5
# Checked at the end of a run: samples in a row that may be off, and share of all samples; in a short run the load maximum may be one of three.
LAST_SAMPLES, SHARE = 2, 0.25
# Change of gamma, while the stress is off, that shows a yielding packing. Vibrating walls cause less (a locked servo 3e-4, see walls.servo).
COLLAPSE_STEP = 2e-3
# Once a packing has strained by this share of collapse_strain, walls that are pushed by forces may be off their goal: such walls cannot lock, and
# a packing that has yielded so far swings back, stops and yields again.
GIVEN_WAY = 0.1
# Largest accepted stress above its goal, in P0. A yielding packing carries less than its goal (the excess stayed below 1 in collapses of 100 disks
# with both methods); walls that bounce to and fro exceed it by 20 and more if a flight changes gamma by more than COLLAPSE_STEP.
EXCESS = 5


class StressError(RuntimeError):
    """The walls do not carry the prescribed stress, although the sample does not yield."""


class Collapse(Exception):
    """The sample no longer carries its load. This ends the run and is a result."""


class LoadCheck:
    """Checks every sample of the history of a run of `samples` intervals.

    The sample has collapsed if |gamma| exceeds collapse_strain. A wrong stress alone is no collapse, since a yielding packing may stop and carry its
    load again. The walls do not work if the stress is wrong while gamma stays within its former range, or if the stress is far above its goal. Walls
    pushed by forces may have a wrong stress while a packing that has yielded accelerates and stops. But the mean of this error has to vanish, since
    it is the change of the walls' momentum.
    """

    def __init__(self, full, samples):
        self.full, self.samples, self.left = full, samples + 1, samples + 1
        self.misses = self.all_misses = self.excesses = self.off = 0
        self.pushed = full["method"] == "CD" or full["md_walls"] == "force"
        self.worst = 0.0  # largest stress error so far, in P0
        self.furthest = 0.0  # largest |gamma| so far
        self.drift = [0.0, 0.0]  # sum over the samples, for both directions, of the stress error of a packing that has yielded, in P0
        self.gammas = (0.0, 0.0)  # the range of gamma since the stress was last on its goal

    def look(self, row):
        """Raise Collapse or StressError if the run has to end; row: time, gamma, sigma1, sigma1_goal, sigma2, sigma2_goal."""
        p0 = parameters.pressure(self.full)
        above = [(row[f"sigma{k}"] - row[f"sigma{k}_goal"]) / p0 for k in (1, 2)]
        off, gamma = max(map(abs, above)), row["gamma"]
        self.left -= 1
        self.worst = max(self.worst, off)
        self.excesses += max(above) > EXCESS
        self.off += off > TOLERANCE
        # Walls that fly to and fro may reach any strain without a collapse.
        beyond = abs(gamma) > self.full["collapse_strain"]
        if beyond and self.excesses < 2:
            raise Collapse(f"|gamma| = {abs(gamma):.3g} above collapse_strain at t = {row['time']:.4g} s, sigma2 = {row['sigma2_goal'] / p0:.4g} P0")
        low, high = self.gammas
        self.gammas = min(low, gamma), max(high, gamma)
        self.furthest = max(self.furthest, abs(gamma))
        swings = self.pushed and self.furthest > GIVEN_WAY * self.full["collapse_strain"]
        if swings:
            self.drift = [total + error for total, error in zip(self.drift, above)]
        if off <= TOLERANCE or swings:
            self.misses, self.gammas = 0, (gamma, gamma)
        elif low - COLLAPSE_STEP <= gamma <= high + COLLAPSE_STEP:
            self.misses, self.gammas = self.misses + 1, (low, high)
            self.all_misses += 1
        else:  # beyond the former range: the packing yields; the next samples show whether it collapses
            self.misses = 0
        hangs = max(map(abs, self.drift)) > TOLERANCE * self.samples
        at_the_end = not self.left and (self.misses >= LAST_SAMPLES or self.all_misses > SHARE * self.samples or hangs)
        if self.misses >= SAMPLES or self.excesses >= SAMPLES or beyond or at_the_end:
            raise StressError(
                f"wall stress off its goal by up to {100 * self.worst:.0f} % of P0 until t = {row['time']:.4g} s, {self.off} of "
                f"{self.samples - self.left} samples off by more than {100 * TOLERANCE:g} % while gamma stayed between {self.gammas[0]:.3g} and "
                f"{self.gammas[1]:.3g}: the walls have locked, or the load changes faster than they can follow; lengthen period"
                + ("" if self.pushed else ", or use md_walls=force")
                + (f", or lower tolerance = {self.full['tolerance']:g}" if self.full["method"] == "CD" and not self.full["fixed_iterations"] else "")
                + (", or set wall_friction=0: with it the other walls carry part of the load" if self.full["wall_friction"] else ""))
