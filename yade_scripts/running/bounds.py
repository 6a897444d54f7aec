"""Limits of what only a row's samples know: errors of CD's solver, and the energies of a loaded box, where all work is known.

They are checked at every sample; a run that exceeds one ends. cd_engine/watching.py checks what any simulation shows, wall_check.py the walls'
stress. CD's engine keeps the largest error of all steps. A NaN does not vanish, so it is found at the next sample, and the message names the one
before.
"""
import math

from cd_engine import Unstable
from yade_scripts import parameters
from yade_scripts.results.schema import MAY_BE_UNDEFINED, OF_A_BOX

# Error e at which the contact forces are wrong by their own size. A fixed number of sweeps promises no error (published: 0.17).
RESIDUAL = 1.0
# The next two limits are in units of P0 times the volume of the grains. They apply to loaded boxes only, where all work is known.
# CD: work of the walls = dissipated + kinetic energy, an identity of the scheme, true to 3e-11 in the published runs.
BALANCE = 1e-9
# MD: the work of the walls that is neither stored nor kinetic has been dissipated and cannot be negative (published: -2e-9, round-off and an averaged
# wall force). The tables of the studies compare it with what friction and dashpots have dissipated.
CREATED = 1e-3


class OutOfBounds(RuntimeError):
    """A quantity of the run has exceeded its limit. The message names the quantity, the place and the remedy."""


class Bounds:
    """Checks every sample of a run. loaded: whether the sample is in a box whose walls are loaded."""

    def __init__(self, full, loaded):
        self.full, self.loaded = full, loaded
        self.held = None  # kinetic and stored energy [J] at the first sample
        self.seen = 0  # step of the last sample
        self.scale = parameters.pressure(full) * parameters.volume(full)

    def look(self, row, step):
        """Raise OutOfBounds or Unstable where the run has to end; row: all that a sample measures."""
        where = f"step {step}, t = {row['time']:.6g} s"
        undefined = MAY_BE_UNDEFINED | (set() if self.loaded else OF_A_BOX)
        for name, value in row.items():
            if name not in undefined and not math.isfinite(value):
                raise Unstable(f"{where}: {name} is {value}, which arose between step {self.seen} and this one; lower md_dt_factor (MD) or cd_dt "
                                  "(CD)")
        if self.full["method"] == "CD" and not self.full["fixed_iterations"] and row["residual_max"] > RESIDUAL:
            raise OutOfBounds(f"{where}: between step {self.seen} and this one the error e of the contact problem was {row['residual_max']:.3g}, the "
                              f"limit is {RESIDUAL:g}: its forces are no solution; lower cd_dt, raise max_iterations, or take another method_cd")
        self.seen = step
        if self.loaded:
            self._energies(row, where)

    def _energies(self, row, where):
        """Check that energy is neither created nor lost."""
        held, unit = row["kinetic_energy"] + row["stored_energy"], f"{self.scale:.3g} J (P0 times the volume of the grains)"
        if self.held is None:
            self.held = held
        gone = row["wall_work"] - (held - self.held)
        if gone < -CREATED * self.scale:
            raise Unstable(f"{where}: {-gone:.3g} J of energy were created, more than {CREATED} of {unit}; lower md_dt_factor (MD) or cd_dt (CD)")
        lost = gone - row["dissipated_energy"]
        if self.full["method"] == "CD" and abs(lost) > BALANCE * self.scale:
            raise OutOfBounds(f"{where}: the energy balance is off by {lost:.3g} J, more than {BALANCE} of {unit}: a force other than walls and "
                              "contacts acts on the disks")
