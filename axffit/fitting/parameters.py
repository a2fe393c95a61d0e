"""One parameter of a fit: its value, how sure it is, and whether the data determine it at all."""

import math
from dataclasses import dataclass
from typing import Any, Literal

_NORMAL_95 = 1.959963984540054

Status = Literal["identified", "conditional", "at bound", "not identified"]
"""``identified``: the data determine it, the interval is marginal over all other parameters. ``conditional``: the
interval holds for the given color table, or for another parameter staying at its bound. ``at bound`` and ``not
identified`` have no interval: a finite one would be a lie."""


@dataclass(frozen=True)
class ParameterEstimate:
    """One parameter of a fitted model.

    ``standard_error`` is None unless ``status`` is identified or conditional. ``low`` and ``high`` are the legal range.
    """

    name: str
    value: float
    standard_error: float | None
    status: Status
    low: float = 0.0
    high: float = math.inf

    @property
    def interval(self) -> tuple[float, float] | None:
        """95 % interval, or None without a standard error."""
        if self.standard_error is None:
            return None
        half = _NORMAL_95 * self.standard_error
        return self.value - half, self.value + half

    def to_json(self) -> dict[str, Any]:
        """The fields by name; an unbounded range is null."""
        return {
            "name": self.name,
            "value": self.value,
            "standard_error": self.standard_error,
            "status": self.status,
            "low": self.low,
            "high": self.high if math.isfinite(self.high) else None,
        }
