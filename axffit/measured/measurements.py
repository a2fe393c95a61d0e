"""One container for every sampled BRDF, whatever file it came from."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

REC709_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Luminance of linear RGB with sRGB (Rec. 709) primaries; ITU-R BT.709-6."""


@dataclass(frozen=True)
class RGBChannels:
    """The channels are linear RGB. ``white`` names the illuminant under which the perfect diffuser is (1, 1, 1)."""

    primaries: str = "srgb"
    white: str = "E"


@dataclass(frozen=True, eq=False)
class Wavelengths:
    """The channels are spectral samples at ``nanometers`` (C,)."""

    nanometers: np.ndarray


@dataclass(frozen=True, eq=False)
class Measurements:
    """A sampled BRDF: N samples of C channels, NumPy float64.

    Attributes:
        wi: unit directions to the light, (N, 3), in (t, b, n) with n = (0, 0, 1).
        wo: unit directions to the viewer, (N, 3).
        values: f in 1/sr without the cosine, (N, C). May be negative where the instrument says so.
        valid: (N,) bool; samples that are not finite or lie below the horizon are always invalid.
        weights: solid-angle weights (both directions), (N,), >= 0, summing to 1 over all samples; they are scaled to
            that on construction. Readers that know no better give equal weights.
        sigma: standard deviation of the noise of ``values``, (N, C), or None where it is not known.
        channels: what the C channels are.
        provenance: where the samples came from and every conversion that was made, by topic.
        name: of the material.
    """

    wi: np.ndarray
    wo: np.ndarray
    values: np.ndarray
    valid: np.ndarray
    weights: np.ndarray
    sigma: np.ndarray | None = None
    channels: RGBChannels | Wavelengths = field(default_factory=RGBChannels)
    provenance: Mapping[str, str] = field(default_factory=dict)
    name: str = ""

    def __post_init__(self):
        wi, wo = (np.asarray(v, np.float64) for v in (self.wi, self.wo))
        values, weights = np.asarray(self.values, np.float64), np.asarray(self.weights, np.float64)
        valid = np.asarray(self.valid, bool)
        sigma = None if self.sigma is None else np.asarray(self.sigma, np.float64)
        n = len(wi)
        shapes = {"wi": wi.shape, "wo": wo.shape, "valid": valid.shape, "weights": weights.shape}
        expected = {"wi": (n, 3), "wo": (n, 3), "valid": (n,), "weights": (n,)}
        if shapes != expected or values.ndim != 2 or len(values) != n or values.shape[1] == 0:
            raise ValueError(f"shapes {shapes} and values {values.shape}: expected {expected} and values ({n}, C)")
        if sigma is not None and sigma.shape != values.shape:
            raise ValueError(f"sigma has shape {sigma.shape}: give one standard deviation a value, {values.shape}")
        if isinstance(self.channels, Wavelengths) and np.shape(self.channels.nanometers) != values.shape[1:]:
            raise ValueError(f"{np.shape(self.channels.nanometers)} wavelengths for {values.shape[1]} channels")
        for name, v in (("wi", wi), ("wo", wo)):
            if n and not np.allclose(np.sum(v * v, axis=1), 1.0, rtol=0.0, atol=1e-6):
                raise ValueError(f"{name} holds vectors that are not of unit length: normalize them")
        if n and not (np.all(np.isfinite(weights)) and np.all(weights >= 0) and np.sum(weights) > 0):
            raise ValueError("weights must be finite, >= 0 and not all 0")
        valid = valid & np.isfinite(values).all(axis=1) & (wi[:, 2] > 0) & (wo[:, 2] > 0)
        if sigma is not None:
            valid = valid & np.isfinite(sigma).all(axis=1) & (sigma > 0).all(axis=1)
        scaled = weights / np.sum(weights) if n else weights
        for name, array in (
            ("wi", wi),
            ("wo", wo),
            ("values", values),
            ("valid", valid),
            ("weights", scaled),
            ("sigma", sigma),
        ):
            object.__setattr__(self, name, array)

    def __len__(self) -> int:
        return len(self.wi)

    @property
    def negative_count(self) -> int:
        """How many values of valid samples are below 0."""
        return int(np.count_nonzero(self.values[self.valid] < 0))

    def select(self, chosen: np.ndarray) -> "Measurements":
        """The samples that ``chosen`` (bool (N,) or indices) names, weights summing to 1 again."""
        return replace(
            self,
            wi=self.wi[chosen],
            wo=self.wo[chosen],
            values=self.values[chosen],
            valid=self.valid[chosen],
            weights=self.weights[chosen],
            sigma=None if self.sigma is None else self.sigma[chosen],
        )
