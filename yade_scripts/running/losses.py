"""What the springs of Molecular Dynamics dissipate, summed where it happens: at every step, contact by contact."""
import math

from yade_scripts.running import hooks


class Losses:
    """Of the contacts in O: the slips, by YADE's law functor or by PathIndependentShear, which slips at other forces; the dashpots, by DashpotWork."""

    def __init__(self, full, boxed):
        """boxed: whether the sample is in the biaxial box."""
        # PathIndependentShear does not see contacts with walls, where the functor slips.
        self._path_independent, self._all = full["tangential_law"] == "path_independent", boxed and not full["wall_friction"]
        self.bind()

    def bind(self):
        """Take hold of the objects in O; after O.load they are other ones."""
        self._functor = hooks.engine("InteractionLoop").lawDispatcher.functors[0]
        self._functor.traceEnergy = True

    def leave(self):
        self._functor.traceEnergy = False

    def friction(self):
        """Return what friction has dissipated [J]; NaN where PathIndependentShear slips at disks and the functor at walls."""
        if self._path_independent:
            return hooks.engine("PathIndependentShear").frictionDissipation if self._all else math.nan
        return self._functor.plasticDissipation()

    def dashpots(self):
        return hooks.engine("DashpotWork").work

    def memory(self):
        """Return what O.save forgets."""
        return self._functor.plasticDissipation()

    def remember(self, memory):
        """Put it back after O.load."""
        self._functor.initPlasticDissipation(memory)
