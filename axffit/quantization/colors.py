"""How much the reflected color changes: dE2000 under D65 and A.

A light's contribution is seen as the color pi f i_z: 1 for a perfect diffuser that faces the light. A view whose
highlight is brighter than that is exposed for the highlight, as a camera would be: divided by the peak of pi f i_z over
that view's lights, the same number before and after.

AxF's RGB has no spectrum: (1, 1, 1) is the perfect diffuser, primaries are sRGB's, white is illuminant E. The color
under another illuminant is the one whose tristimulus values Bradford's chromatic adaptation makes of those under E.
So there is no metamerism in these numbers: two colors that match under E match under every light.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

ILLUMINANTS = ("D65", "A")


@dataclass(frozen=True)
class ColorError:
    """dE2000 over sampled texels, views and lights under one illuminant.

    Attributes:
        illuminant: of `ILLUMINANTS`.
        mean: mean over all pairs.
        p95: what 95 % of them do not exceed.
        max: the largest.
        pairs: how many there are.
    """

    illuminant: str
    mean: float
    p95: float
    max: float
    pairs: int

    def to_json(self) -> dict[str, Any]:
        """As a JSON object."""
        return dict(vars(self))


@lru_cache
def _to_xyz(illuminant: str) -> tuple[np.ndarray, np.ndarray]:
    """Matrix (3, 3) from RGB to XYZ under an illuminant, rows by rows; and the illuminant's chromaticity (2,)."""
    import colour

    whites = colour.CCS_ILLUMINANTS["CIE 1931 2 Degree Standard Observer"]
    primaries = colour.RGB_COLOURSPACES["sRGB"].primaries
    to_xyz = np.asarray(colour.models.normalised_primary_matrix(primaries, whites["E"]))
    ends = [colour.xy_to_XYZ(whites[name]) for name in ("E", illuminant)]
    adapt = np.asarray(colour.adaptation.matrix_chromatic_adaptation_VonKries(*ends, transform="Bradford"))
    return (adapt @ to_xyz).T, np.asarray(whites[illuminant])


def color_differences(before: np.ndarray, after: np.ndarray, illuminant: str) -> np.ndarray:
    """dE2000 (n,) between colors (n, 3) under an illuminant; 1 is the perfect diffuser.

    Raises:
        ImportError: colour-science is not installed (`measures.has_color_science`).
    """
    import colour

    matrix, white = _to_xyz(illuminant)
    lab = [colour.XYZ_to_Lab(np.maximum(rows, 0.0) @ matrix, white) for rows in (before, after)]
    return np.asarray(colour.delta_E(lab[0], lab[1], method="CIE 2000"))


def exposed(f: np.ndarray, g: np.ndarray, clear: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Colors (n, 3) before and after of f i_z and f' i_z (texels, views, lights, 3), of the pairs that count."""
    peak = np.pi * np.max(np.where(clear[..., None], f, 0.0), axis=(2, 3), keepdims=True)
    scale = np.pi / np.maximum(peak, 1.0)
    return (scale * f)[clear], (scale * g)[clear]


def color_errors(differences: dict[str, list[np.ndarray]]) -> tuple[ColorError, ...]:
    """Summary of what `color_differences` gave for each illuminant."""
    errors = []
    for illuminant, parts in differences.items():
        values = np.concatenate(parts)
        if values.size:
            p95 = float(np.quantile(values, 0.95, method="higher"))
            errors.append(ColorError(illuminant, float(values.mean()), p95, float(values.max()), int(values.size)))
    return tuple(errors)
