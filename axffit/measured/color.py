"""Spectral samples as RGB, for models and pictures that know three channels."""

from dataclasses import replace

import numpy as np

from axffit import spectrum
from axffit.errors import InputError
from axffit.measured.measurements import Measurements, RGBChannels

CONVERSION = "CIE 1931 2° observer, illuminant E, sRGB primaries: the perfect diffuser is (1, 1, 1)"


def to_rgb(measurements: Measurements) -> Measurements:
    """The samples with RGB channels; RGB ones come back as they are.

    rgb = values @ M, M (C, 3) of `axffit.spectrum.weights`: the interpolated spectrum under illuminant E, seen by the
    CIE 1931 2° observer. A single wavelength becomes gray. Noise is propagated as independent between wavelengths:
    sigma² = sigma² @ M².

    Raises:
        InputError: colour-science is not installed (extra `color`), or wavelengths are not nm, rising.
    """
    if isinstance(measurements.channels, RGBChannels):
        return measurements
    nanometers = np.asarray(measurements.channels.nanometers, np.float64)
    if len(nanometers) == 1:
        matrix = np.ones((1, 3))
        words = f"a single wavelength, {nanometers[0]:g} nm, repeated as gray"
    else:
        if spectrum.in_nanometers(nanometers) is None:
            raise InputError(f"wavelengths {nanometers.tolist()}: give nm, rising, from 200 to 3000")
        matrix = spectrum.weights(tuple(nanometers.tolist()))
        words = f"{len(nanometers)} wavelengths, {nanometers[0]:g} to {nanometers[-1]:g} nm, to RGB: {CONVERSION}"
    sigma = measurements.sigma
    return replace(
        measurements,
        values=measurements.values @ matrix,
        sigma=None if sigma is None else np.sqrt(sigma**2 @ matrix**2),
        channels=RGBChannels(),
        provenance={**measurements.provenance, "color": words},
    )
