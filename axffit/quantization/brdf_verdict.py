"""The BRDF level of a verdict: for each definition what was found, what is proved, and which of the two is judged."""

import math
from dataclasses import dataclass
from typing import Any

from .brdf_error import BrdfErrors, Found
from .checks import Check
from .material_bounds import MaterialBounds
from .statistics import finite_or_none
from .tolerances import KINDS, Kind, Tolerances

_TITLES = {
    "peak_relative": ("b", "max |f' - f| i_z / max_i (f i_z), peak per view"),
    "log_ratio": ("c", "max |log f' - log f| where f i_z >= 1e-3 of the view's peak"),
}


OPEN = 10.0
"""A bound that is more times what was found says that its search ended early, not that an error is so large."""


def _unproved(errors: BrdfErrors, bounds: MaterialBounds, kind: Kind) -> str:
    """Why what was found is judged in place of the bound, or ""."""
    bound, found = bounds.bound(kind), getattr(errors, kind).value
    if bound is None:
        return bounds.reason
    if bound <= OPEN * found:
        return ""
    ended = f"at {bound:.3g}, more than {OPEN:g} times what was found" if math.isfinite(bound) else "without one"
    return f"the search for a bound ended {ended}"


@dataclass(frozen=True)
class BrdfVerdict:
    """The BRDF level. Judged is the bound, which holds for every texel; where there is none, what was found.

    A bound more than `OPEN` times what was found counts as none.

    Attributes:
        errors: what was found at sampled texels, or None where the model is not evaluated.
        bounds: upper bounds over all texels, or why there are none; None where the model is not evaluated.
        checks: definitions (b) and (c) with their limits.
        reason: why nothing was evaluated, or "".
    """

    errors: BrdfErrors | None
    bounds: MaterialBounds | None
    checks: tuple[Check, ...]
    reason: str = ""

    @classmethod
    def judged(cls, errors: BrdfErrors, bounds: MaterialBounds, tolerances: Tolerances) -> "BrdfVerdict":
        """The verdict of what was found and of what is proved."""

        def check(kind: Kind) -> Check:
            bound, name = bounds.bound(kind), f"brdf.{kind}"
            judged = getattr(errors, kind).value if bound is None or _unproved(errors, bounds, kind) else bound
            return Check(name, judged, tolerances.get(name))

        return cls(errors, bounds, tuple(map(check, KINDS)))

    @property
    def within(self) -> bool:
        """Whether both definitions are within their limits."""
        return all(check.within for check in self.checks)

    def basis(self, check: Check) -> str:
        """What a failure of a check adds: whether the bound was judged or only what was found; "" for other levels."""
        if check not in self.checks or self.errors is None or self.bounds is None:
            return ""
        kind = KINDS[self.checks.index(check)]
        return " (found only)" if _unproved(self.errors, self.bounds, kind) else " (bound)"

    def to_json(self) -> dict[str, Any]:
        """One row a definition, how large the sample was, and the classes that were bounded."""
        content: dict[str, Any] = {"evaluated": self.errors is not None, "reason": self.reason, "within": self.within}
        if self.errors is None or self.bounds is None:
            nothing = {"strip": None, "sample": None, "bounds": None, "colors": [], "expected": []}
            return {**content, "rows": [], **nothing}
        rows = [
            self._row(self.errors, self.bounds, kind, check) for kind, check in zip(KINDS, self.checks, strict=True)
        ]
        sample = {name: getattr(self.errors, name) for name in ("texels", "views", "lights", "ascents")}
        return {
            **content,
            "rows": rows,
            "strip": self.errors.strip.to_json(),
            "sample": {**sample, "kind": "found"},
            "bounds": self.bounds.to_json(),
            "colors": [each.to_json() for each in self.errors.colors],
            "expected": [each.to_json() for each in self.errors.expected],
        }

    def _row(self, errors: BrdfErrors, bounds: MaterialBounds, kind: Kind, check: Check) -> dict[str, Any]:
        found: Found = getattr(errors, kind)
        definition, title = _TITLES[kind]
        bound = bounds.bound(kind)
        unproved = _unproved(errors, bounds, kind)
        proved = {
            "bound": None if bound is None else finite_or_none(bound),
            "judged": "found" if unproved else "bound",
            "unproved": unproved,
        }
        return {"definition": definition, "name": kind, "title": title, **found.to_json(), **proved, **check.to_json()}
