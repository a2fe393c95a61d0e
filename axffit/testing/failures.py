"""How a broken law says which pair of directions broke it."""

from collections.abc import Callable

import numpy as np


def vector(values: np.ndarray) -> str:
    """Components with all the digits that reproduce them."""
    return f"({', '.join(repr(float(value)) for value in values)})"


def demand(law: str, found, allowed, explain: Callable[[int], str], wi, wo) -> None:
    """Raise ``AssertionError`` unless ``found`` <= ``allowed`` for every pair of directions.

    Args:
        law: name of the law.
        found: what must be small, (n,) or (n, channels); NaN is never small, True is 1.
        allowed: how small, broadcast against ``found``.
        explain: what is wrong with pair k.
        wi: directions to the light, (n, 3).
        wo: directions to the viewer, (n, 3).
    """
    found = np.asarray(found, np.float64).reshape(len(wi), -1)
    allowed = np.broadcast_to(np.asarray(allowed, np.float64), found.shape)
    broken = ~(found <= allowed)
    if not broken.any():
        return
    with np.errstate(invalid="ignore"):
        excess = np.where(broken, np.nan_to_num(found - allowed, nan=np.inf, posinf=np.inf), -np.inf)
    pair = int(np.argmax(excess.max(axis=1)))
    count = int(np.count_nonzero(broken.any(axis=1)))
    among = "" if len(wi) == 1 else f" (pair {pair}; {count} of {len(wi)} pairs break it)"
    place = f"wi = {vector(np.asarray(wi[pair]))}, wo = {vector(np.asarray(wo[pair]))}"
    raise AssertionError(f"{law}: {explain(pair)} at {place}{among}")
