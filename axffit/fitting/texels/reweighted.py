"""Texels fitted to their pixels' noise: weights from the pixels first, then from what the fit says they should be.

Weights from noisy pixels favor those that happen to be dark: at 5 % noise the colors come out half a percent too dark,
about their standard error. Weights from the first fit are free of that.
"""

from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float, Int

from axffit.fitting.texels.batch import LANES, fit_texels
from axffit.fitting.texels.maps import Map, maps_of, reduced_chi_square
from axffit.fitting.texels.noise import Noise
from axffit.fitting.texels.problem import TexelModel, model_values
from axffit.fitting.texels.shading import common_light

_model_values = partial(jax.jit, static_argnums=0)(model_values)


class FittedTexels(NamedTuple):
    """Maps by AxF's names, reduced chi-square, and :class:`axffit.fitting.texels.batch.Outcome` of each texel."""

    maps: dict[str, Map]
    chi_square: Float[np.ndarray, " texels"]
    outcome: Int[np.ndarray, " texels"]


@jax.enable_x64(new_val=True)
def fit_pixels(
    model: TexelModel,
    wi: Float[np.ndarray, "n 3"],
    wo: Float[np.ndarray, "n 3"],
    pixels: Float[np.ndarray, "channels n texels"],
    noise: Noise,
    lanes: int = LANES,
) -> FittedTexels:
    """The maps of some texels.

    Args:
        model: what is fitted.
        wi: unit vectors to the light, one an image.
        wo: unit vectors to the viewer.
        pixels: radiance over irradiance at normal incidence; what is not finite does not count.
        noise: of the pixels.
        lanes: texels in flight at once.
    """
    usable = noise.usable(pixels)
    values = np.where(usable, pixels, 0.0)
    first = fit_texels(model, wi, wo, values, noise.precisions(values, usable), lanes=lanes)
    expected = np.asarray(
        _model_values(model, common_light(wi, wo), jnp.asarray(first.theta), jnp.asarray(first.weights))
    )
    precisions = noise.precisions(expected, usable)
    fit = fit_texels(model, wi, wo, values, precisions, first.theta, lanes)
    chi_square = reduced_chi_square(model, fit, precisions)
    return FittedTexels(maps_of(model, fit, None if noise.known else chi_square), chi_square, fit.outcome)
