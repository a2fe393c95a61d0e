"""One lobe as another: which roughness, color and F0 of a model come closest to a lobe of another model.

For a lobe on its own, seen from everywhere, the fit is

    min over alpha', p, q  of  sum w (T(c l'(alpha'; p, q) i_z) - T(c l(alpha, F0) i_z))²,   s' = p + q, F0' = p / s'

with T of the residual and one brightness c for all, the mean of the material's specular color. So (alpha', p, q)
depends on (alpha, F0) alone and is computed once for a table of both, between whose entries a map is interpolated. With
the cosine-weighted and the cube-root residual c does not matter; with the log residual it decides how much tails count.
"""

from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float
from scipy.interpolate import RegularGridInterpolator

from axffit import brdf as brdfs
from axffit.axf import AxfMaterial, AxfTexture, MaterialKind, to_brdf
from axffit.brdf import AbstractBRDF
from axffit.fitting.batch import solve_batch
from axffit.fitting.bijections import LogInterval
from axffit.fitting.models import LOBES, AbstractFitModel, Coat, Shapes
from axffit.fitting.residuals import AbstractResidual
from axffit.fitting.separable import make_problem
from axffit.frames import half_difference_to_directions
from axffit.measured import Measurements

ROUGHNESS = (1e-4, 1.0)
"""What AxF's lobe map may hold."""

_THETA_H, _THETA_D, _PHI_D = 40, 8, 4
_NARROWEST = 1e-5
LANES = 64
_START_FACTORS = (0.5, 1.4)
_MOST_LOBES, _MOST_F0 = 24, 6
_EXPONENT_MODELS = ("BlinnPhong", "Phong")


class LobeModel(AbstractFitModel):
    """One lobe of unit color without a diffuse term: weights p and q, or p alone where there is no Fresnel."""

    lobe: str = eqx.field(static=True)
    fresnel: bool = eqx.field(static=True)
    coat: Coat | None = None

    @property
    def name(self) -> str:
        """The lobe's."""
        return self.lobe

    @property
    def lobe_count(self) -> int:
        """One."""
        return 1

    def bounds(self) -> Shapes:
        """Roughness on a logarithmic scale, within AxF's range."""
        return Shapes(LogInterval(*ROUGHNESS))

    def basis(self, shapes: Shapes, wi: Float[Array, "n 3"], wo: Float[Array, "n 3"]) -> Float[Array, "n m"]:
        """The lobe with F = 1, and with F = (1 - c)⁵."""
        white, lobe = jnp.ones(3, wi.dtype), LOBES[self.lobe]
        columns = [self.column(lobe(white, shapes.roughness[0]), wi, wo)]
        if self.fresnel:
            schlick = brdfs.Schlick1994(jnp.zeros((), wi.dtype))
            columns.append(self.column(lobe(white, shapes.roughness[0], schlick), wi, wo))
        return jnp.stack(columns, axis=1)

    def assemble(self, shapes: Shapes, weights: Float[Array, "m channels"]) -> AbstractBRDF:
        """The lobe with color and F0 of ``weights``."""
        p, q = (weights[0], weights[1]) if self.fresnel else (weights[0], jnp.zeros_like(weights[0]))
        s = p + q
        fresnel = brdfs.Schlick1994(jnp.where(s > 0, p / jnp.where(s > 0, s, 1.0), 1.0)) if self.fresnel else None
        return LOBES[self.lobe](s, shapes.roughness[0], brdfs.NoFresnel() if fresnel is None else fresnel)


class Conversion(NamedTuple):
    """The table of one conversion.

    Attributes:
        lobes: (K,) ascending, as the source's lobe map holds them: roughness, or n' with the exponent 2^n'.
        f0: (F,) ascending.
        roughness: (K, F) alpha'.
        p: (K, F) s' F0' for a source of color 1.
        q: (K, F) s' (1 - F0'); 0 where the source has no Fresnel.
        misfit: (K, F) root of the weighted squares over that of the source's, as the residual sees them.
        exponents: whether ``lobes`` are n'.
    """

    lobes: np.ndarray
    f0: np.ndarray
    roughness: np.ndarray
    p: np.ndarray
    q: np.ndarray
    misfit: np.ndarray
    exponents: bool

    def at(self, lobe: np.ndarray, f0: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """alpha', p and q for values within the table, of any one shape."""  # noqa: D403
        axes = [axis for axis in (self._axis, self.f0) if len(axis) > 1]
        inputs = [x for x, axis in ((self._coordinate(lobe), self._axis), (f0, self.f0)) if len(axis) > 1]
        columns = np.stack([np.log(self.roughness), self.p, self.q], axis=-1)
        if not axes:
            values = np.broadcast_to(columns[0, 0], (*lobe.shape, 3))
        else:
            grid = columns.reshape(*(len(axis) for axis in axes), 3)
            clipped = [np.clip(x, axis[0], axis[-1]) for x, axis in zip(inputs, axes, strict=True)]
            method = "pchip" if min(len(axis) for axis in axes) >= 4 else "linear"
            values = RegularGridInterpolator(axes, grid, method=method)(np.stack(clipped, axis=-1))
        return np.exp(values[..., 0]), values[..., 1], values[..., 2]

    @property
    def _axis(self) -> np.ndarray:
        return self._coordinate(self.lobes)

    def _coordinate(self, lobe: np.ndarray) -> np.ndarray:
        # An exponent's logarithm is a logarithm already; either way steps of roughness are steps of ratio.
        return lobe if self.exponents else np.log(np.maximum(lobe, ROUGHNESS[0]))


def nodes(lowest: float, highest: float, *, most: int, ratio: float, logarithmic: bool) -> np.ndarray:
    """Values from ``lowest`` to ``highest``, neighbors at most ``ratio`` apart (a factor if logarithmic)."""
    if not highest > lowest:
        return np.array([lowest])
    if logarithmic:
        count = int(np.clip(np.ceil(np.log(highest / lowest) / np.log(ratio)) + 1, 2, most))
        return np.geomspace(lowest, highest, count)
    count = int(np.clip(np.ceil((highest - lowest) / ratio) + 1, 2, most))
    return np.linspace(lowest, highest, count)


def _directions() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Directions whose theta_h are spaced by a factor, so that a lobe of any width is resolved; and their weights."""
    edges = np.geomspace(_NARROWEST, np.pi / 2, _THETA_H + 1)
    theta_h = np.sqrt(edges[1:] * edges[:-1])
    theta_d = (np.pi / 2) * (np.arange(_THETA_D) + 0.5) / _THETA_D
    phi_d = np.pi * (np.arange(_PHI_D) + 0.5) / _PHI_D
    angles = np.meshgrid(theta_h, theta_d, phi_d, indexing="ij")
    weights = np.sin(angles[0]) * np.diff(edges)[:, None, None] * np.sin(angles[1]) * np.cos(angles[1])
    wi, wo = half_difference_to_directions(*(jnp.asarray(angle.ravel()) for angle in angles))
    above = np.asarray((wi[:, 2] > 0) & (wo[:, 2] > 0))
    return np.asarray(wi)[above], np.asarray(wo)[above], weights.ravel()[above]


def lobe_values(material: AxfMaterial, lobes: np.ndarray, f0: np.ndarray, wi: np.ndarray, wo: np.ndarray) -> np.ndarray:
    """Values (L, n) in 1/sr of the material's lobe alone, color 1, for lobe parameters and F0 (L,)."""

    def row(values: np.ndarray) -> AxfTexture:
        return AxfTexture((np.asarray(values, np.float32).reshape(1, -1, 1),), float(len(values)), 1.0)

    probe = AxfMaterial(
        id=material.id,
        name=material.name,
        kind=MaterialKind.SVBRDF,
        specular_model=material.specular_model,
        specular_variant=material.specular_variant,
        fresnel_variant=material.fresnel_variant,
        textures={
            "specularcolor": AxfTexture((np.ones((1, 1, 3), np.float32),)),
            "specularlobe": row(lobes),
            "fresnel": row(f0),
        },
    )
    count = len(lobes)
    uv = np.stack([(np.arange(count) + 0.5) / count, np.full(count, 0.5)], axis=-1)
    model = to_brdf(probe, uv=uv)
    directions = jnp.asarray(wi), jnp.asarray(wo)

    @eqx.filter_jit
    def one(texel: AbstractBRDF) -> Array:
        return texel.evaluate(*directions)[:, 0]

    arrays, rest = eqx.partition(model, eqx.is_array)
    rows = [one(eqx.combine(jax.tree.map(lambda leaf, k=k: leaf[k], arrays), rest)) for k in range(count)]
    return np.asarray(jnp.stack(rows), np.float64)


def convert(
    material: AxfMaterial,
    target: str,
    residual: AbstractResidual,
    *,
    brightness: float,
    lobes: tuple[float, float],
    f0: tuple[float, float],
) -> tuple[Conversion, float]:
    """The table from a material's lobes to ``target``, and how far a map between its entries can be off.

    Args:
        material: an SVBRDF; its specular model and Fresnel variant count.
        target: a name of :data:`axffit.fitting.models.LOBES`.
        residual: what is made small.
        brightness: c.
        lobes: smallest and largest value of the lobe map.
        f0: smallest and largest F0.

    Returns:
        The table; and the largest relative difference in alpha' or s' between the table's interpolation and fits of
        their own, over all middles of neighboring entries.
    """
    exponents = material.specular_model in _EXPONENT_MODELS
    logarithmic = not exponents
    ratio = 1.0 if exponents else 1.4
    k = nodes(*lobes, most=_MOST_LOBES, ratio=ratio, logarithmic=logarithmic)
    f = nodes(*f0, most=_MOST_F0, ratio=0.15, logarithmic=False) if material.fresnel_variant else np.array([f0[0]])

    def fitted(lobes: np.ndarray, f0: np.ndarray) -> Conversion:
        return _fitted(material, target, residual, brightness, lobes, f0)

    table = fitted(k, f)
    if len(k) == len(f) == 1:
        return table, 0.0
    between = fitted(_middles(k, logarithmic=logarithmic), _middles(f, logarithmic=False))
    grid = np.meshgrid(between.lobes, between.f0, indexing="ij")
    roughness, p, q = table.at(*grid)
    apart = np.abs(np.log(roughness / between.roughness))
    color = np.abs(np.log(np.maximum(p + q, 1e-30) / np.maximum(between.p + between.q, 1e-30)))
    return table, float(np.expm1(max(apart.max(), color.max())))


def _middles(values: np.ndarray, *, logarithmic: bool) -> np.ndarray:
    if len(values) == 1:
        return values
    return np.sqrt(values[1:] * values[:-1]) if logarithmic else 0.5 * (values[1:] + values[:-1])


def _fitted(
    material: AxfMaterial,
    target: str,
    residual: AbstractResidual,
    brightness: float,
    lobes: np.ndarray,
    f0: np.ndarray,
) -> Conversion:
    model = LobeModel(lobe=target, fresnel=material.fresnel_variant is not None)
    wi, wo, weights = _directions()
    grid = [axis.ravel() for axis in np.meshgrid(lobes, f0, indexing="ij")]
    values = brightness * lobe_values(material, grid[0], grid[1], wi, wo)
    first = Measurements(wi, wo, values[:1].T, np.ones(len(wi), bool), weights, name=material.id)
    data = residual.prepare(first)
    problem = make_problem(model, residual, first, data)
    padding = len(problem.wi) - len(wi)
    targets = np.pad(values * data.factor, ((0, 0), (0, padding)))[:, :, None]
    alpha = np.sqrt(2.0 / (np.exp2(grid[0]) + 2.0)) if material.specular_model in _EXPONENT_MODELS else grid[0]
    starts = np.clip(np.outer(_START_FACTORS, alpha).ravel()[:, None], *ROUGHNESS)
    repeated = np.tile(targets, (len(_START_FACTORS), 1, 1))
    found = solve_batch(problem, repeated, np.asarray(problem.root_weight)[None], start=Shapes(starts), lanes=LANES)
    cost = np.where(np.isfinite(found.cost), found.cost, np.inf).reshape(len(_START_FACTORS), -1)
    best = np.argmin(cost, axis=0) * len(alpha) + np.arange(len(alpha))
    seen = np.asarray(problem.root_weight)[None] * np.asarray(residual.transform(jnp.asarray(targets)))
    size = np.sum(seen**2, axis=(1, 2))
    shape = (len(lobes), len(f0))
    p = found.weights[best, 0, 0] / brightness
    q = found.weights[best, 1, 0] / brightness if model.fresnel else np.zeros_like(p)
    misfit = np.sqrt(2.0 * cost.min(axis=0) / np.where(size > 0, size, 1.0))
    roughness = np.asarray(found.shapes.roughness)[best, 0]
    columns = [np.asarray(column).reshape(shape) for column in (roughness, p, q, misfit)]
    return Conversion(lobes, f0, *columns, exponents=material.specular_model in _EXPONENT_MODELS)
