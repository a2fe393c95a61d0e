"""Clear coats over synthetic SVBRDFs."""

import numpy as np

from .noise import Rng, fractal_noise, unit_vectors, value_noise


def clear_coat(
    rng: Rng,
    u: np.ndarray,
    v: np.ndarray,
    size: int,
    *,
    peel: float = 0.012,
    ior: float = 1.5,
    gaps: float = 0.003,
) -> dict[str, np.ndarray]:
    """Clear coat: faint orange peel, an index with gaps where it could not be measured, a warm tint.

    Args:
        rng: source of chance.
        u: texture coordinate along the width, (H, W).
        v: texture coordinate along the height, (H, W).
        size: texels along each side; finer octaves of the orange peel are left out.
        peel: largest slope of its coarsest octave.
        ior: mean index of refraction.
        gaps: share of texels whose index is NaN.

    Returns:
        The three coat maps by AxF's lower-case names.
    """
    slope = [peel * fractal_noise(rng, u, v, (6, 6), octaves=2, size=size) for _ in range(2)]
    index = ior + 0.02 * value_noise(rng, u, v, (4, 4))
    missing = value_noise(rng, u, v, (8, 8))
    missing = missing > np.quantile(missing, 1.0 - gaps)
    tint = 0.02 * value_noise(rng, u, v, (3, 3))[..., None]
    return {
        "clearcoatcolor": np.array([1.0, 0.99, 0.97]) * (0.97 + tint),
        "clearcoatnormal": unit_vectors(*slope),
        "clearcoatior": np.where(missing, np.nan, index)[..., None],
    }
