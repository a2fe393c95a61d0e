"""A number beside its limit."""

from dataclasses import dataclass
from typing import Any

from .statistics import finite_or_none
from .tolerances import Tolerance


@dataclass(frozen=True)
class Check:
    """A number and its limit.

    Attributes:
        name: dotted name of the limit, e.g. ``textures.normal.angle``.
        value: what was measured.
        tolerance: the limit, or None for a number that is only reported.
    """

    name: str
    value: float
    tolerance: Tolerance | None

    @property
    def within(self) -> bool:
        """Whether the value is allowed."""
        return self.tolerance is None or self.tolerance.allows(self.value)

    def __str__(self) -> str:
        """The value against the limit, as a failure reads."""
        limit = "no limit" if self.tolerance is None else f"{self.tolerance.limit:.4g}"
        return f"{self.name}: {self.value:.4g} > {limit}"

    def to_json(self) -> dict[str, Any]:
        """Limit and outcome as JSON; a limit of infinity is null, as no limit is."""
        limit = None if self.tolerance is None else finite_or_none(self.tolerance.limit)
        return {
            "check": self.name,
            "statistic": None if self.tolerance is None else self.tolerance.statistic,
            "tolerance": limit,
            "reason": "" if self.tolerance is None else self.tolerance.reason,
            "within": self.within,
        }
