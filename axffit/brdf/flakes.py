"""The flakes of a car paint: a bidirectional texture over (theta_h, theta_d), stored as a stack of slices."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from axffit._types import RGB, Scalar
from axffit.brdf.base import as_parameter
from axffit.brdf.texture import TextureMap

CLAMP_ANGLE = 1.0
"""Angle (radians) beyond which the AxF SDK looks up the flakes of that angle."""


def _default_offsets(bins: int) -> np.ndarray:
    """Shifts of the virtual bins: the additive sequence of the plastic number, which keeps them well apart."""
    plastic = 1.324717957244746
    steps = np.arange(bins)[:, None] * np.array([1 / plastic, 1 / plastic**2])
    return np.mod(0.5 + steps, 1.0)


class Flakes(eqx.Module):
    """AxF's ``BTFflakes``: radiance Xi(uv, theta_h, theta_d) in 1/sr that is *added* to the paint.

        t = theta / (pi/2) · num_theta_f + 0.5 for both angles, lo = floor t, weight t - lo, bilinear
        slice(iF, iI) = lut[iI] + iF, valid only below lut[iI + 1] and for iI < max_theta_i; otherwise 0

    If num_theta_i < num_theta_f, theta_d's bins are virtual: bin iI shows the slices of bin
    floor(iI · num_theta_i / num_theta_f) at its own shift of the uv, exchanged (u, v) for odd iI, and is bounded by
    that own bin's next entry of the table.

    Attributes:
        slices: the stack, with all its mip levels as the file gives them; linear RGB.
        slice_lut: AxF ``thetaFI_sliceLUT``, first slice of each theta_d bin.
        num_theta_f: AxF ``num_thetaF``, bins of both angles over [0, pi/2].
        num_theta_i: AxF ``num_thetaI``, bins of theta_d that the stack really holds.
        max_theta_i: AxF ``max_thetaI``, number of valid entries.
        uv: where on the surface, (2,); flakes repeat with period 1.
        level: mip level, ().
        clamp_angles: whether angles stop at 1 radian, as the SDK does.
        virtual_offsets: shift of each virtual bin, (bins, 2); fixed and spread by default.
    """

    slices: TextureMap
    slice_lut: tuple[int, ...] = eqx.field(static=True)
    num_theta_f: int = eqx.field(static=True, kw_only=True)
    num_theta_i: int = eqx.field(static=True, kw_only=True)
    max_theta_i: int = eqx.field(static=True, kw_only=True)
    uv: Float[Array, "2"] = eqx.field(converter=as_parameter, default=(0.0, 0.0))
    level: Scalar = eqx.field(converter=as_parameter, default=0.0)
    virtual_offsets: Float[Array, "bins 2"] = eqx.field(
        converter=as_parameter, default_factory=lambda: _default_offsets(258)
    )
    clamp_angles: bool = eqx.field(static=True, default=False, kw_only=True)

    def __check_init__(self):
        depth, entries = self.slices.shapes[0][0], len(self.slice_lut)
        if min(self.num_theta_f, self.num_theta_i) < 1 or not 0 <= self.max_theta_i <= entries:
            raise ValueError(
                f"num_theta_f={self.num_theta_f}, num_theta_i={self.num_theta_i}, max_theta_i={self.max_theta_i} with "
                f"a table of {entries} entries: the counts start at 1, max_theta_i is at most the table's length"
            )
        if not all(0 <= entry <= depth for entry in self.slice_lut):
            raise ValueError(f"slice_lut {self.slice_lut} leaves the stack: entries lie in 0..{depth}, its depth")

    def at(self, uv: Float[Array, "2"], footprint: Scalar) -> "Flakes":
        """The same flakes at another place, averaged over about ``footprint`` (a side, in uv)."""
        level = self.slices.level_of(footprint)
        return eqx.tree_at(lambda flakes: (flakes.uv, flakes.level), self, (uv, level))

    def lookup(self, theta_h: Scalar, theta_d: Scalar) -> RGB:
        """Xi at the flakes' uv for a pair of angles (radians)."""
        bin_f, weight_f = self._bin(theta_h)
        bin_i, weight_i = self._bin(theta_d)
        low = self._along_theta_h(bin_i, bin_f, weight_f)
        high = self._along_theta_h(bin_i + 1, bin_f, weight_f)
        return (1.0 - weight_i) * low + weight_i * high

    def _bin(self, theta: Scalar) -> tuple[Int[Array, ""], Scalar]:
        theta = jnp.minimum(theta, CLAMP_ANGLE) if self.clamp_angles else theta
        t = theta * (2.0 * self.num_theta_f / jnp.pi) + 0.5
        low = jnp.floor(t)
        return low.astype(jnp.int32), t - low

    def _along_theta_h(self, bin_i: Int[Array, ""], bin_f: Int[Array, ""], weight: Scalar) -> RGB:
        """Interpolated over theta_h within one theta_d bin."""
        # An entry past the table's end bounds nothing: 0, as in the unused entries of real tables.
        lut = jnp.asarray((*self.slice_lut, 0, 0), jnp.int32)
        own, uv = self._own_bin(bin_i)
        own = jnp.minimum(own, len(self.slice_lut))
        first, limit = lut[own], lut[own + 1]

        def fetch(step: Int[Array, ""]) -> RGB:
            valid = (first + step < limit) & (own < self.max_theta_i)
            texel = self.slices.fetch(uv, self.level, jnp.where(valid, first + step, 0))
            return jnp.where(valid, texel, jnp.zeros_like(texel))

        return (1.0 - weight) * fetch(bin_f) + weight * fetch(bin_f + 1)

    def _own_bin(self, bin_i: Int[Array, ""]) -> tuple[Int[Array, ""], Float[Array, "2"]]:
        """The bin of the stack that serves theta_d bin ``bin_i``, and the uv at which it is read."""
        if self.num_theta_i >= self.num_theta_f:
            return bin_i, self.uv
        own = bin_i * self.num_theta_i // self.num_theta_f
        exchanged = jnp.where(bin_i % 2 == 1, self.uv[::-1], self.uv)
        return own, exchanged + self.virtual_offsets[jnp.minimum(bin_i, self.virtual_offsets.shape[0] - 1)]
