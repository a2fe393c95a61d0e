"""What the columns of values of a text file mean: gray, RGB, or wavelengths."""

import re
from collections.abc import Sequence

import numpy as np

from axffit.measured.measurements import RGBChannels, Wavelengths

_WAVELENGTH = re.compile(r"([0-9]+(?:\.[0-9]+)?)\s*(nm|um)?", re.IGNORECASE)
_GRAY = {"f", "f_r", "f_r11", "brdf", "bsdf", "brdf_value"}
_RGB = ({"r", "red"}, {"g", "green"}, {"b", "blue"})
RULE = "one column f (or BRDF), three columns R, G, B, or wavelengths in nm (400 or 400nm; 0.4um), rising"


def channels_of(names: Sequence[str], white: str) -> tuple[RGBChannels | Wavelengths, int, str] | None:
    """What columns of these names are: channels, how often to repeat each, and words; None where they are unknown."""
    lowered = [name.strip().lower() for name in names]
    if len(lowered) == 1 and lowered[0] in _GRAY:
        return RGBChannels(white=white), 3, "one channel, repeated as gray"
    if len(lowered) == 3 and all(name in known for name, known in zip(lowered, _RGB, strict=True)):
        return RGBChannels(white=white), 1, "RGB as stored, taken as linear sRGB"
    found = [_WAVELENGTH.fullmatch(name) for name in lowered]
    if not found or any(match is None for match in found):
        return None
    nanometers = np.array([float(m[1]) * (1000.0 if m[2] == "um" else 1.0) for m in found if m is not None])
    if not (np.diff(nanometers) > 0).all() or nanometers[0] < 100:
        return None
    return Wavelengths(nanometers), 1, f"{len(nanometers)} wavelengths, {nanometers[0]:g} to {nanometers[-1]:g} nm"
