"""Bounds on non-linear parameters, as bijections between the whole real line and the allowed range.

The solvers know no bounds: they move a raw value anywhere, and ``forward`` maps it inside. A fit holds one bijection
where its tree of parameters holds one array (:func:`forward_tree`, :func:`start_tree`). Linear parameters need none:
they are found by non-negative least squares, which reaches an exact 0 (``axffit.fitting.nonnegative``).
"""

import abc
from typing import Any, TypeVar

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jax.core import Tracer
from jaxtyping import Array, Float

_NUDGE = 1e-3
_AT_BOUND = 1e-4
_ROUNDING = 1e-12

Tree = TypeVar("Tree")


class AbstractBijection(eqx.Module):
    """Raw value on the real line <-> physical value strictly between ``lower`` and ``upper``."""

    lower: eqx.AbstractVar[float]
    upper: eqx.AbstractVar[float]

    @abc.abstractmethod
    def forward(self, raw: Float[Array, "..."]) -> Float[Array, "..."]:
        """Physical value of a raw one."""

    @abc.abstractmethod
    def inverse(self, value: Float[Array, "..."]) -> Float[Array, "..."]:
        """Raw value of a physical one strictly inside the bounds."""

    @abc.abstractmethod
    def fraction(self, value: Float[Array, "..."]) -> Float[Array, "..."]:
        """Where ``value`` lies in the range, 0 at ``lower`` and 1 at ``upper``, on the bijection's own scale."""

    @abc.abstractmethod
    def at(self, fraction: Float[Array, "..."]) -> Float[Array, "..."]:
        """Inverse of :meth:`fraction`."""

    def start(self, value: Any) -> Float[Array, "..."]:
        """Raw value to start from; a start on a bound, where the raw value is infinite, is moved inside.

        Raises:
            ValueError: ``value`` lies outside the bounds or is not finite; a value that JAX traces is not looked at.
        """
        if not isinstance(value, Tracer):
            value = np.asarray(value, np.float64)
            # A value that a solver walked to a bound with is off it by rounding.
            slack = _ROUNDING * (abs(self.lower) + abs(self.upper))
            if not (np.all(value >= self.lower - slack) and np.all(value <= self.upper + slack)):
                raise ValueError(f"start {value} lies outside [{self.lower:g}, {self.upper:g}]: start inside")
        fraction = jnp.clip(self.fraction(jnp.asarray(value)), _NUDGE, 1.0 - _NUDGE)
        return self.inverse(self.at(fraction))

    def at_bound(self, value: Any) -> np.ndarray:
        """Which values lie within 1e-4 of the range of a bound: such a parameter is not determined by the data."""
        fraction = np.asarray(self.fraction(jnp.asarray(value)))
        return (fraction < _AT_BOUND) | (fraction > 1.0 - _AT_BOUND)


class Interval(AbstractBijection):
    """lower + (upper - lower) / (1 + exp(-raw))."""

    lower: float = eqx.field(static=True)
    upper: float = eqx.field(static=True)

    def __check_init__(self):
        if not self.lower < self.upper:
            raise ValueError(f"Interval({self.lower}, {self.upper}): lower must be below upper")

    def forward(self, raw: Float[Array, "..."]) -> Float[Array, "..."]:
        """The logistic function, scaled to the bounds."""
        return self.at(jax.nn.sigmoid(raw))

    def inverse(self, value: Float[Array, "..."]) -> Float[Array, "..."]:
        """Log of the ratio of the distances to the bounds."""
        return jnp.log(value - self.lower) - jnp.log(self.upper - value)

    def fraction(self, value: Float[Array, "..."]) -> Float[Array, "..."]:
        """Linear."""
        return (value - self.lower) / (self.upper - self.lower)

    def at(self, fraction: Float[Array, "..."]) -> Float[Array, "..."]:
        """Linear."""
        return self.lower + (self.upper - self.lower) * fraction


class LogInterval(AbstractBijection):
    """lower (upper / lower)^(1 / (1 + exp(-raw))): an :class:`Interval` on the logarithm, for scales."""

    lower: float = eqx.field(static=True)
    upper: float = eqx.field(static=True)

    def __check_init__(self):
        if not 0 < self.lower < self.upper:
            raise ValueError(f"LogInterval({self.lower}, {self.upper}): 0 < lower < upper is needed")

    def _log(self) -> Interval:
        return Interval(float(np.log(self.lower)), float(np.log(self.upper)))

    def forward(self, raw: Float[Array, "..."]) -> Float[Array, "..."]:
        """The exponential of the interval on the logarithm."""
        return jnp.exp(self._log().forward(raw))

    def inverse(self, value: Float[Array, "..."]) -> Float[Array, "..."]:
        """The interval's inverse of the logarithm."""
        return self._log().inverse(jnp.log(value))

    def fraction(self, value: Float[Array, "..."]) -> Float[Array, "..."]:
        """Linear in the logarithm."""
        return self._log().fraction(jnp.log(value))

    def at(self, fraction: Float[Array, "..."]) -> Float[Array, "..."]:
        """Linear in the logarithm."""
        return jnp.exp(self._log().at(fraction))


def _is_bijection(node: Any) -> bool:
    return isinstance(node, AbstractBijection)


def forward_tree(bounds: Tree, raw: Tree) -> Tree:
    """Physical values of a tree of raw ones; ``bounds`` holds a bijection where ``raw`` holds an array."""
    return jax.tree.map(lambda bound, leaf: bound.forward(leaf), bounds, raw, is_leaf=_is_bijection)


def start_tree(bounds: Tree, values: Tree) -> Tree:
    """Raw values of a tree of physical ones to start from (:meth:`AbstractBijection.start`)."""
    return jax.tree.map(lambda bound, leaf: bound.start(leaf), bounds, values, is_leaf=_is_bijection)
