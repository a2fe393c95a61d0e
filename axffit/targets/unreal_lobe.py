"""One GGX lobe in place of a car paint's lobes, as Unreal's importer finds it.

The rule is read in the importer's source: over light and view directions in one plane through the normal, up to 72°
from it, the sum of |f' - f| cos theta_i is made smallest over roughness and specularity by a search on a 30 x 30 grid
that is refined five times to 0.2 of its width around the best so far. There, f' is a metallic surface of the engine:
the GGX lobe with alpha = roughness², Schlick's Fresnel with F0 = specularity (its edge tint fades below 2 %), and no
diffuse part; f is the paint below its coat, without its color.

Two deviations, so the numbers differ a little from the engine's: the lobe's masking is Smith's own where the engine
approximates it, and the plane is sampled at 40 x 40 pairs instead of 100 x 100.
"""

from dataclasses import dataclass

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from .. import brdf
from ..axf import AxfMaterial
from .table import MAXIMUM_LOBES

DIRECTIONS = 40
LARGEST_ANGLE = 0.8 * np.pi / 2
STEPS, ROUNDS, NARROWING = 30, 5, 0.2
ROUGHNESS_RANGE, SPECULARITY_RANGE = (0.0101, 1.0), (0.0, 1.0)
"""The importer begins at roughness 0.01; a little above, alpha stays within AxF's spreads, which end at 1e-4."""

COEFFICIENT = 0.25
"""The engine's lobe carries the microfacet 1/4 that AxF's lobes lack."""


@dataclass(frozen=True)
class Lobe:
    """The reduced paint.

    Attributes:
        roughness: the engine's: alpha = roughness².
        specularity: F0 of the metallic surface, times the color table's color.
        residual: sum |f' - f| cos over sum f cos.
    """

    roughness: float
    specularity: float
    residual: float


def reduce_paint(material: AxfMaterial) -> Lobe:
    """The lobe that stands for a car paint; exact for a paint that is such a lobe already.

    A paint without diffuse part and with one lobe of coefficient 1/4 is what `unpack` makes of a reduced paint.
    """
    held = material.properties
    coefficients = np.atleast_1d(held.get("CT_coeffs", np.zeros(0, np.float32)))
    if float(held.get("CT_diffuse", 0.0)) == 0.0 and coefficients.tolist() == [COEFFICIENT]:
        return Lobe(float(np.float32(np.sqrt(held["CT_spreads"][0]))), float(held["CT_F0s"][0]), 0.0)
    wi, wo, edge = _plane()
    wanted = np.asarray(_paint(_base(material), wi, wo), np.float64) * np.asarray(wi[:, 2], np.float64)
    return _search(wanted, wi, wo, edge)


def _base(material: AxfMaterial) -> brdf.CarPaint:
    """The paint without color, always of four lobes, so that one compilation serves all."""
    held = material.properties

    def padded(name: str, padding: float) -> np.ndarray:
        given = np.atleast_1d(held.get(name, np.zeros(0, np.float32)))
        return np.concatenate([given, np.full(MAXIMUM_LOBES - len(given), padding, np.float32)])

    return brdf.CarPaint(
        diffuse=np.float32(held.get("CT_diffuse", 0.0)),
        coefficients=padded("CT_coeffs", 0.0),
        f0=padded("CT_F0s", 0.0),
        spreads=padded("CT_spreads", 1.0),
    )


def _plane() -> tuple[jax.Array, jax.Array, np.ndarray]:
    """Lights and viewers [n, 3] float32, and (1 - <h, o>)^5 [n]."""
    angles = np.linspace(-LARGEST_ANGLE, LARGEST_ANGLE, DIRECTIONS)
    light, view = (grid.reshape(-1) for grid in np.meshgrid(angles, angles, indexing="ij"))
    wi, wo = (jnp.asarray(np.stack([np.sin(a), 0 * a, np.cos(a)], axis=-1), jnp.float32) for a in (light, view))
    return wi, wo, (1.0 - np.cos((light - view) / 2)) ** 5


@eqx.filter_jit
def _paint(paint: brdf.CarPaint, wi: jax.Array, wo: jax.Array) -> jax.Array:
    return paint.evaluate(wi, wo)[..., 0]


@eqx.filter_jit
def _lobes(alphas: jax.Array, wi: jax.Array, wo: jax.Array) -> jax.Array:
    """The engine's lobe without its Fresnel factor, [alphas, n]."""

    def lobe(alpha: jax.Array) -> jax.Array:
        white = jnp.ones(3, jnp.float32)
        return brdf.GGX(white, alpha, normalization="microfacet").evaluate(wi, wo)[..., 0]

    return eqx.filter_vmap(lobe)(alphas)


def _search(wanted: np.ndarray, wi: jax.Array, wo: jax.Array, edge: np.ndarray) -> Lobe:
    roughness, specularity = ROUGHNESS_RANGE, SPECULARITY_RANGE
    best = (np.inf, 1.0, 1.0)
    for _ in range(ROUNDS):
        tried, factors = np.linspace(*roughness, STEPS), np.linspace(*specularity, STEPS)
        shapes = np.asarray(_lobes(jnp.asarray(np.maximum(tried**2, 1e-4), jnp.float32), wi, wo), np.float64)
        fresnel = np.minimum(50 * factors, 1.0)[:, None] * edge + (1 - edge) * factors[:, None]
        for value, shape in zip(tried, shapes * np.asarray(wi[:, 2], np.float64), strict=True):
            distances = np.abs(fresnel * shape - wanted).sum(axis=-1)
            least = int(np.argmin(distances))
            best = min(best, (float(distances[least]), float(value), float(factors[least])))
        roughness = _narrowed(roughness, best[1], ROUGHNESS_RANGE)
        specularity = _narrowed(specularity, best[2], SPECULARITY_RANGE)
    total = float(wanted.sum())
    return Lobe(best[1], best[2], best[0] / total if total > 0 else 0.0)


def _narrowed(ends: tuple[float, float], center: float, limits: tuple[float, float]) -> tuple[float, float]:
    spread = (ends[1] - ends[0]) * NARROWING
    return max(limits[0], center - spread), min(limits[1], center + spread)
