"""Reflectance spectra to linear RGB, as AxF means it: illuminant E, so that the perfect diffuser is (1, 1, 1).

X = sum_k w_k rho(lambda_k), with weights w_k from the CIE 1931 2° observer's color matching functions (360-830 nm
by 1 nm) and the equal-energy illuminant: w_k is the sum of (x, y, z)(lambda) times what the k-th sample contributes
to the interpolated spectrum at lambda (Sprague's for equal steps as CIE 167:2005 says, a cubic spline for others;
beyond the ends the spectrum stays constant). An interpolation reproduces constants, so the weights sum to the white
of illuminant E.

XYZ becomes RGB by the matrix of sRGB's primaries (Rec. 709) with that white in place of D65. Rows of the matrix sum
to (1, 1, 1) over the white, so unity reflectance comes out as (1, 1, 1) to rounding without a chromatic adaptation:
none is needed, as illuminant, white and the space's white are one and the same. Adapting to D65 and then taking
sRGB's own matrix would also give (1, 1, 1) but other colors, and belongs to the display.
"""

import functools

import numpy as np

from axffit.errors import InputError

SAMPLES = 31
"""Samples of a spectrum that is taken as 400-700 nm by 10 nm where the file has no wavelengths."""

_SPRAGUE = 6
"""Samples that Sprague's interpolation needs."""


def default_wavelengths(samples: int) -> np.ndarray | None:
    """What wavelengths in nm are taken for granted: 400-700 by 10 for 31 samples, else None."""
    return np.linspace(400.0, 700.0, SAMPLES) if samples == SAMPLES else None


def in_nanometers(wavelengths: np.ndarray) -> np.ndarray | None:
    """Wavelengths in nm, recognized by their size as nm, micrometers or meters; None where they are neither."""
    values = np.asarray(wavelengths, np.float64).reshape(-1)
    if values.size < 2 or not np.isfinite(values).all() or not (np.diff(values) > 0).all():
        return None
    for factor in (1.0, 1e3, 1e9):
        if 200.0 <= values[0] * factor and values[-1] * factor <= 3000.0:
            # A float32 of other units is off by a few 1e-5 nm, which would make equal steps unequal.
            return values if factor == 1.0 else np.round(values * factor, 3)
    return None


def to_rgb(spectra: np.ndarray, wavelengths: np.ndarray) -> np.ndarray:
    """Linear RGB (sRGB primaries, white of illuminant E) of reflectance spectra.

    Args:
        spectra: reflectances (..., C); may lie outside [0, 1].
        wavelengths: C rising wavelengths in nm.

    Returns:
        (..., 3), float32.

    Raises:
        InputError: colour-science is not installed (extra `color`), or the wavelengths do not fit.
    """
    wavelengths = np.asarray(wavelengths, np.float64)
    if wavelengths.shape != spectra.shape[-1:] or in_nanometers(wavelengths) is None:
        raise InputError(
            f"{wavelengths.size} wavelengths for {spectra.shape[-1]} channels; give one a channel, rising, in nm"
        )
    matrix = weights(tuple(wavelengths.tolist()))
    with np.errstate(over="ignore", invalid="ignore"):
        return (spectra.astype(np.float64) @ matrix).astype(np.float32)


@functools.lru_cache(maxsize=16)
def weights(wavelengths: tuple[float, ...]) -> np.ndarray:
    """The matrix (C, 3) from reflectances at C wavelengths in nm to linear RGB.

    Raises:
        InputError: colour-science is not installed (extra `color`).
    """
    try:
        import colour
        from colour.utilities import suppress_warnings
    except ImportError as error:
        raise InputError(
            "colors given as spectra are converted by colour-science: pip install 'axffit[color]'"
        ) from error
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(colour.SpectralShape(360, 830, 1))
    samples = colour.MultiSpectralDistributions(np.eye(len(wavelengths)), list(wavelengths))
    few = colour.LinearInterpolator if len(wavelengths) < _SPRAGUE else None
    # It warns of unequal steps, which is what the spline is for.
    with suppress_warnings(colour_runtime_warnings=True):
        contributions = samples.align(observer.shape, interpolator=few).values
    xyz = contributions.T @ observer.values / observer.values[:, 1].sum()
    white = xyz.sum(axis=0)
    primaries = colour.RGB_COLOURSPACES["sRGB"].primaries
    from_rgb = colour.normalised_primary_matrix(primaries, colour.XYZ_to_xy(white))
    matrix = xyz @ np.linalg.inv(from_rgb).T
    matrix.flags.writeable = False
    return matrix
