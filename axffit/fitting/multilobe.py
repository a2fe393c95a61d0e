"""Several lobes of one kind over a diffuse term, all colored: which lobe, and how many of them, explain a material.

The F0 of the lobes (Schlick's Fresnel) is free for each lobe and channel, one for all, or known. Free ones are linear:
the weights are p = s F0 and q = s (1 - F0), as for a car paint.
"""

from typing import Literal

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from axffit import brdf as brdfs
from axffit.brdf import AbstractBRDF
from axffit.brdf.carpaint import MAX_LOBES
from axffit.errors import InputError
from axffit.fitting.bijections import Interval, LogInterval
from axffit.fitting.models import LOBES, ROUGHNESS_BOUNDS, AbstractLobeModel, Coat, Directions, Shapes

F0 = Literal["each", "shared"] | float


class LobesModel(AbstractLobeModel):
    """f = d / pi + sum_k s_k F_k lobe(alpha_k): d and s_k per channel, alpha_k for all channels.

    Attributes:
        lobe: a name of ``axffit.fitting.models.LOBES``.
        lobes: K, 1 to 4.
        coat: a clear coat of known index, or None.
        f0: ``"each"``: one a lobe and channel; ``"shared"``: one for all lobes and channels; or its known value.
    """

    lobe: str = eqx.field(static=True)
    lobes: int = eqx.field(static=True, default=2)
    coat: Coat | None = None
    f0: F0 = eqx.field(static=True, default="each", kw_only=True)

    def __check_init__(self):
        if self.lobe not in LOBES:
            raise InputError(f"unknown lobe {self.lobe!r}: choose one of {', '.join(LOBES)}")
        if not 1 <= self.lobes <= MAX_LOBES:
            raise InputError(f"{self.lobes} lobes: give 1 to {MAX_LOBES}")
        if self.f0 not in ("each", "shared") and not (isinstance(self.f0, float) and 0.0 <= self.f0 <= 1.0):
            raise InputError(f"F0 {self.f0!r}: give a number from 0 to 1, 'shared' or 'each'")

    @property
    def name(self) -> str:
        """As on the command line, with the number of lobes."""
        plain = self.lobe if self.coat is None else f"{self.lobe}+coat"
        return f"{plain}, {self.lobes} lobes" if self.lobes > 1 else plain

    @property
    def lobe_count(self) -> int:
        """K."""
        return self.lobes

    def bounds(self) -> Shapes:
        """Roughnesses on a logarithmic scale, a shared F0 in [0, 1]."""
        return Shapes(LogInterval(*ROUGHNESS_BOUNDS), Interval(0.0, 1.0) if self.f0 == "shared" else None)

    def _column(
        self, roughness: Float[Array, ""], f0: Float[Array, ""] | None, wi: Directions, wo: Directions
    ) -> Float[Array, " n"]:
        """A white lobe with Schlick's Fresnel, or none where ``f0`` is None."""
        fresnel = brdfs.NoFresnel() if f0 is None else brdfs.Schlick1994(f0)
        return self.column(LOBES[self.lobe](jnp.ones(3, wi.dtype), roughness, fresnel), wi, wo)

    def scan_basis(self, roughness: Float[Array, ""], wi: Directions, wo: Directions) -> Float[Array, "n 2"]:
        """The lobe with F = 1 and with F = (1 - c)⁵; with a known F0 the lobe and nothing."""
        if isinstance(self.f0, float):
            known = self._column(roughness, jnp.asarray(self.f0, wi.dtype), wi, wo)
            return jnp.stack([known, jnp.zeros_like(known)], axis=1)
        p, q = self._column(roughness, None, wi, wo), self._column(roughness, jnp.zeros((), wi.dtype), wi, wo)
        return jnp.stack([p, q], axis=1)

    def basis(self, shapes: Shapes, wi: Directions, wo: Directions) -> Float[Array, "n m"]:
        """1 / pi, then a column a lobe, or two (p, q) where each has an F0 of its own."""
        diffuse = self.column(brdfs.Lambert(jnp.ones(3, wi.dtype)), wi, wo)[:, None]
        if self.f0 == "each":
            pairs = jax.vmap(lambda a: self.scan_basis(a, wi, wo), out_axes=1)(shapes.roughness)
            return jnp.concatenate([diffuse, pairs.reshape(len(wi), 2 * self.lobes)], axis=1)
        f0 = shapes.f0 if self.f0 == "shared" else jnp.asarray(self.f0, wi.dtype)
        lobes = jax.vmap(lambda a: self._column(a, f0, wi, wo), out_axes=1)(shapes.roughness)
        return jnp.concatenate([diffuse, lobes], axis=1)

    def split(
        self, shapes: Shapes, weights: Float[Array, "m channels"]
    ) -> tuple[Float[Array, "k channels"], Float[Array, "k channels"]]:
        """Colors s_k and F0_k; an F0 of its own is 1 where a lobe has no weight."""
        if self.f0 == "each":
            p, q = weights[1::2], weights[2::2]
            s = p + q
            return s, jnp.where(s > 0, p / jnp.where(s > 0, s, 1.0), 1.0)
        f0 = shapes.f0 if self.f0 == "shared" else self.f0
        return weights[1:], jnp.broadcast_to(jnp.asarray(f0, weights.dtype), weights[1:].shape)

    def assemble(self, shapes: Shapes, weights: Float[Array, "m channels"]) -> AbstractBRDF:
        """Lambert and the lobes under the coat."""
        s, f0 = self.split(shapes, weights)
        parts = [LOBES[self.lobe](s[k], shapes.roughness[k], brdfs.Schlick1994(f0[k])) for k in range(self.lobes)]
        return self.covered(brdfs.Sum((brdfs.Lambert(weights[0]), *parts)))

    def ordered(self, shapes: Shapes, weights: Float[Array, "m channels"]) -> tuple[Shapes, Float[Array, "m channels"]]:
        """The same model with lobes in the order of their roughnesses, lobes without weight last."""
        roughness, values = np.asarray(shapes.roughness), np.asarray(weights)
        groups = values[1:].reshape(self.lobes, -1, values.shape[1])
        order = np.lexsort((roughness, ~np.any(groups > 0, axis=(1, 2))))
        lobes = groups[order].reshape(-1, values.shape[1])
        return Shapes(jnp.asarray(roughness[order]), shapes.f0), jnp.asarray(np.concatenate([values[:1], lobes]))
