"""Checks sample by sample whether the walls carry the stress that the loading asks for. Plain numbers, no YADE."""
from yade_scripts import parameters

# A servo that works is off by 1e-4 to 4e-4 of P0 (rms, t0 = 4 to 1 s), one that is locked by 40-100 %; walls with mass lag during a collapse.
# Longer than a few samples neither is the loading that was asked for.
TOLERANCE, SAMPLES = 0.05, 5
# At the end of a run, where nothing follows that could mend it; and of all samples of a run, whose load maximum may be one of three.
LAST_SAMPLES, SHARE = 2, 0.25
# Of gamma while the stress is off: a sample that is giving way, beyond what walls can shake (a locked servo 3e-4, see walls.servo).
COLLAPSE_STEP = 2e-3
# Share of collapse_strain which a sample once has to have strained by, so that walls that are pushed by forces may be off their goal from then on:
# such walls cannot lock, and a sample that has given way so far swings back, stops and gives way again.
GIVEN_WAY = 0.1
# Above the goal, in P0: a sample that gives way carries less than is asked of it (it stayed below 1 in collapses of 100 disks by both
# methods), walls that fly to and fro carry 20 and more where a flight is longer than COLLAPSE_STEP.
EXCESS = 5


class StressError(RuntimeError):
    """The walls do not carry the stress that the loading asks for, and not because the sample gives way."""


class Collapse(Exception):
    """The sample no longer carries its load: an end of the run, and a result."""


class LoadCheck:
    """Looks at every sample of a run of `samples` intervals.

    A collapse is strain beyond collapse_strain. Stress off its goal alone is none: a sample that gives way may stop, and carry its load
    again. Where gamma goes nowhere new meanwhile, or the stress is far above the goal, it tells of walls that do not work; where the sample has
    given way already, only the latter does.
    """

    def __init__(self, full, samples):
        self.full, self.samples, self.left = full, samples + 1, samples + 1
        self.misses = self.all_misses = self.excesses = 0
        self.pushed = full["method"] == "CD" or full["md_walls"] == "force"
        self.worst = 0.0  # stress error met, in P0
        self.furthest = 0.0  # |gamma|
        self.gammas = (0.0, 0.0)  # the range of gamma since the stress was last on its goal

    def look(self, row):
        """Raise Collapse or StressError where the run has to end; row: time, gamma, sigma1, sigma1_goal, sigma2, sigma2_goal."""
        p0 = parameters.pressure(self.full)
        above = [(row[f"sigma{k}"] - row[f"sigma{k}_goal"]) / p0 for k in (1, 2)]
        off, gamma = max(map(abs, above)), row["gamma"]
        self.left -= 1
        self.worst = max(self.worst, off)
        self.excesses += max(above) > EXCESS
        # Walls that fly to and fro may pass any strain.
        if abs(gamma) > self.full["collapse_strain"] and self.excesses < 2:
            raise Collapse(f"|gamma| = {abs(gamma):.3g} above collapse_strain at t = {row['time']:.4g} s, sigma2 = {row['sigma2_goal'] / p0:.4g} P0")
        low, high = self.gammas
        self.gammas = min(low, gamma), max(high, gamma)
        self.furthest = max(self.furthest, abs(gamma))
        gives_way = self.pushed and self.furthest > GIVEN_WAY * self.full["collapse_strain"]
        if off <= TOLERANCE or gives_way:
            self.misses, self.gammas = 0, (gamma, gamma)
        elif low - COLLAPSE_STEP <= gamma <= high + COLLAPSE_STEP:
            self.misses, self.gammas = self.misses + 1, (low, high)
            self.all_misses += 1
        else:  # further than ever: it is giving way, where to, the next samples tell
            self.misses = 0
        at_the_end = not self.left and (self.misses >= LAST_SAMPLES or self.all_misses > SHARE * self.samples)
        if self.misses >= SAMPLES or self.excesses >= SAMPLES or at_the_end:
            raise StressError(
                f"wall stress off its goal by up to {100 * self.worst:.0f} % of P0 until t = {row['time']:.4g} s, {max(self.all_misses, self.excesses)} of "
                f"{self.samples - self.left} samples off by more than {100 * TOLERANCE:g} % while gamma stayed between {self.gammas[0]:.3g} and "
                f"{self.gammas[1]:.3g}: the walls have locked or the load moves faster than they can; lengthen period, or use md_walls=force")
