"""What a parameter is: its name, default, unit, meaning and allowed values. The registry of all parameters is parameters.py. Needs no YADE."""
import math
import numbers
import sys
from dataclasses import dataclass

from yade_scripts.errors import ParameterError


@dataclass(frozen=True)
class Parameter:
    """One parameter: its name, default, unit and meaning (doc). The type of the default is the type of its values.

    low, high: allowed range, both included. above: lower end, if that is excluded. choices: the allowed values, if these are words.
    prepare: whether the prepared packing depends on it.
    method: the only method that reads it, or None.
    """
    name: str
    default: object
    unit: str
    doc: str
    low: float = -math.inf
    high: float = math.inf
    above: float = -math.inf
    choices: tuple = ()
    prepare: bool = False
    method: str | None = None

    def __post_init__(self):
        self.check(self.default)

    def allowed(self):
        """Return the allowed values in words."""
        if self.choices:
            return "one of " + ", ".join(map(str, self.choices))
        if type(self.default) in (bool, str):
            return "True or False" if isinstance(self.default, bool) else "a name"
        kind = "an integer" if isinstance(self.default, int) else "a number"
        return f"{kind} in " + (f"[{self.low:g}, {self.high:g}]" if self.above == -math.inf else f"({self.above:g}, {self.high:g}]")

    def check(self, value):
        """Return the value in the parameter's own type. Raise ParameterError if it is not allowed."""
        kind, legal = type(self.default), False
        if kind in (bool, str):
            legal = isinstance(value, kind) and (not self.choices or value in self.choices)
        elif isinstance(value, numbers.Real) and not isinstance(value, bool):
            finite = abs(value) <= sys.float_info.max
            legal = finite and self.above < value <= self.high and value >= self.low and (kind is float or value == int(value))
        if not legal:
            unit = f" [{self.unit}]" * (self.unit != "1")
            raise ParameterError(f"{self.name} = {value!r}: must be {self.allowed()}{unit} ({self.doc})")
        return kind(value) + 0.0 if kind is float else kind(value)  # -0.0 is 0, so that both name one run
