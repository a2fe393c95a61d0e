"""What a fit minimizes: residual objects.

Every residual has the form r = w^(1/2) (T(g c) - T(f c)) with f the data, g the model, c a factor that depends on the
directions only, and T monotone. ``axf-models`` metrics: :class:`CosineWeighted`, :class:`LogCosine`, :class:`CubeRoot`
have c = i_z, weights w of solid angle and data clipped at 0. :class:`NoiseWeighted` has c = 1, w = 1 / sigma² and does
not clip, for clipping would bias it.
"""

import abc
from typing import ClassVar, NamedTuple

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from axffit.errors import InputError
from axffit.measured import Measurements

Values = Float[Array, "..."]


class ResidualData(NamedTuple):
    """The fixed parts of a residual, per sample and channel."""

    target: np.ndarray
    """f c, (N, C)."""
    factor: np.ndarray
    """c, (N,)."""
    root_weight: np.ndarray
    """w^(1/2), (N, C)."""


class AbstractResidual(eqx.Module):
    """r = w^(1/2) (T(g c) - T(f c))."""

    name: eqx.AbstractClassVar[str]
    linear: eqx.AbstractClassVar[bool]
    knows_noise: eqx.AbstractClassVar[bool]

    @abc.abstractmethod
    def transform(self, x: Values) -> Values:
        """T."""

    @abc.abstractmethod
    def slope(self, x: Values) -> Values:
        """T'."""

    @abc.abstractmethod
    def curvature(self, x: Values) -> Values:
        """T''."""

    @abc.abstractmethod
    def prepare(self, measurements: Measurements) -> ResidualData:
        """Targets, factors and weights for samples that are all valid."""


def _cosine_data(measurements: Measurements) -> ResidualData:
    cosine = measurements.wi[:, 2]
    target = np.maximum(measurements.values, 0.0) * cosine[:, None]
    channels = measurements.values.shape[1]
    root_weight = np.sqrt(measurements.weights / (channels * np.sum(measurements.weights)))
    return ResidualData(target, cosine, np.repeat(root_weight[:, None], channels, axis=1))


class CosineWeighted(AbstractResidual):
    """T(x) = x, divided by the root mean square of the data: the cost is the relative cosine RMS, squared."""

    name: ClassVar[str] = "cosine"
    linear: ClassVar[bool] = True
    knows_noise: ClassVar[bool] = False

    def transform(self, x: Values) -> Values:
        """X itself."""
        return x

    def slope(self, x: Values) -> Values:
        """1."""
        return jnp.ones_like(x)

    def curvature(self, x: Values) -> Values:
        """0."""
        return jnp.zeros_like(x)

    def prepare(self, measurements: Measurements) -> ResidualData:
        """Cosine and solid angle, scaled to the relative RMS."""
        data = _cosine_data(measurements)
        norm = np.sqrt(np.sum((data.root_weight * data.target) ** 2))
        return data._replace(root_weight=data.root_weight / norm if norm > 0 else data.root_weight)


class LogCosine(AbstractResidual):
    """T(x) = log(1 + x) (Löw et al., ACM TOG 31(1), 2012)."""

    name: ClassVar[str] = "log"
    linear: ClassVar[bool] = False
    knows_noise: ClassVar[bool] = False

    def transform(self, x: Values) -> Values:
        """log(1 + x)."""
        return jnp.log1p(x)

    def slope(self, x: Values) -> Values:
        """1 / (1 + x)."""
        return 1.0 / (1.0 + x)

    def curvature(self, x: Values) -> Values:
        """-1 / (1 + x)²."""
        return -1.0 / ((1.0 + x) * (1.0 + x))

    def prepare(self, measurements: Measurements) -> ResidualData:
        """Cosine and solid angle."""
        return _cosine_data(measurements)


class CubeRoot(AbstractResidual):
    """T(x) = x^(1/3) (Fores, Ferwerda & Gu, CIC 20, 2012), with a finite slope at 0: T(x) = x (x + e)^(-2/3).

    ``floor`` e (1/sr): where x is far above it, T differs from the cube root by 2 e / (3 x) of it.
    """

    name: ClassVar[str] = "cube root"
    linear: ClassVar[bool] = False
    knows_noise: ClassVar[bool] = False
    floor: float = eqx.field(static=True, default=1e-9)

    def transform(self, x: Values) -> Values:
        """X (x + e)^(-2/3)."""
        return x * self._power(x)

    def slope(self, x: Values) -> Values:
        """(x / 3 + e) (x + e)^(-5/3)."""
        return (x / 3.0 + self.floor) * self._power(x) / (x + self.floor)

    def curvature(self, x: Values) -> Values:
        """-(2/9) (x + 6 e) (x + e)^(-8/3)."""
        shifted = x + self.floor
        return -(2.0 / 9.0) * (x + 6.0 * self.floor) * self._power(x) / (shifted * shifted)

    def _power(self, x: Values) -> Values:
        """(x + e)^(-2/3), the one expensive part of all three."""
        root = jnp.cbrt(x + self.floor)
        return 1.0 / (root * root)

    def prepare(self, measurements: Measurements) -> ResidualData:
        """Cosine and solid angle."""
        return _cosine_data(measurements)


class NoiseWeighted(AbstractResidual):
    """(g - f) / sigma: maximum likelihood for Gaussian noise of known standard deviation."""

    name: ClassVar[str] = "noise"
    linear: ClassVar[bool] = True
    knows_noise: ClassVar[bool] = True

    def transform(self, x: Values) -> Values:
        """X itself."""
        return x

    def slope(self, x: Values) -> Values:
        """1."""
        return jnp.ones_like(x)

    def curvature(self, x: Values) -> Values:
        """0."""
        return jnp.zeros_like(x)

    def prepare(self, measurements: Measurements) -> ResidualData:
        """Values as measured, divided by their noise.

        Raises:
            InputError: the measurements do not state their noise.
        """
        if measurements.sigma is None:
            raise InputError(
                f"{measurements.name or 'the samples'}: the noise-weighted residual needs the standard deviation of "
                "the noise, which the samples do not state; use the log, cube root or cosine residual"
            )
        return ResidualData(measurements.values, np.ones(len(measurements)), 1.0 / measurements.sigma)


class Robust(AbstractResidual):
    """:class:`LogCosine` with Huber's loss (Ann. Math. Stat. 35(1), 1964): wild samples pull with bounded force.

    With u the root mean square over the channels of a sample's log1p(g c) - log1p(f c), in units of 1.4826 times the
    median of u, the loss is u² / 2 up to ``threshold`` k and k u - k² / 2 beyond. The fit minimizes it by weighting
    samples with min(1, k / u) again and again (:func:`axffit.fitting.fit`); k = 1.345 costs 5 % of the efficiency
    where the noise is Gaussian after all.
    """

    name: ClassVar[str] = "robust"
    linear: ClassVar[bool] = False
    knows_noise: ClassVar[bool] = False
    threshold: float = eqx.field(static=True, default=1.345)

    def transform(self, x: Values) -> Values:
        """log(1 + x)."""
        return LogCosine().transform(x)

    def slope(self, x: Values) -> Values:
        """1 / (1 + x)."""
        return LogCosine().slope(x)

    def curvature(self, x: Values) -> Values:
        """-1 / (1 + x)²."""
        return LogCosine().curvature(x)

    def prepare(self, measurements: Measurements) -> ResidualData:
        """Cosine and solid angle."""
        return _cosine_data(measurements)

    def factors(self, measurements: Measurements, values: np.ndarray) -> np.ndarray:
        """min(1, k / u) (N,) of samples for which a model has ``values`` (N, C)."""
        cosine = measurements.wi[:, 2][:, None]
        data, model = (np.log1p(np.maximum(x, 0.0) * cosine) for x in (measurements.values, values))
        u = np.sqrt(np.mean((model - data) ** 2, axis=1))
        scale = 1.4826 * float(np.median(u))
        return np.minimum(1.0, self.threshold * scale / np.maximum(u, 1e-300)) if scale > 0 else np.ones(len(u))


RESIDUALS = {
    "log": LogCosine,
    "cube-root": CubeRoot,
    "cosine": CosineWeighted,
    "noise": NoiseWeighted,
    "robust": Robust,
}
"""Residuals by the names used on the command line."""
