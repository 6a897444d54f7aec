"""The energy that the springs of Molecular Dynamics dissipate, summed at every step over all contacts."""
import math

from yade_scripts.running import hooks


class Losses:
    """The dissipation of the contacts in O: friction from YADE's law functor or from PathIndependentShear, dashpots from DashpotWork."""

    def __init__(self, full, boxed):
        """boxed: whether the sample is in the biaxial box."""
        # PathIndependentShear does not see contacts with walls, where the functor slips.
        self._path_independent, self._all = full["tangential_law"] == "path_independent", boxed and not full["wall_friction"]
        self.bind()

    def bind(self):
        """Find the law functor in O; after O.load it is another object."""
        self._functor = hooks.engine("InteractionLoop").lawDispatcher.functors[0]
        self._functor.traceEnergy = True

    def leave(self):
        self._functor.traceEnergy = False

    def friction(self):
        """Return the energy dissipated by friction [J]; NaN if disks slip by PathIndependentShear but walls by the functor."""
        if self._path_independent:
            return hooks.engine("PathIndependentShear").frictionDissipation if self._all else math.nan
        return self._functor.plasticDissipation()

    def dashpots(self):
        return hooks.engine("DashpotWork").work

    def memory(self):
        """Return the sum that O.save does not store."""
        return self._functor.plasticDissipation()

    def remember(self, memory):
        """Put it back after O.load."""
        self._functor.initPlasticDissipation(memory)
