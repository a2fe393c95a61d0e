"""AxF textures."""

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from axffit.axf import AxfTexture
from axffit.axf.names import TEXTURES
from axffit.testing.strategies.values import Draw, built, composite

Elements = tuple[float, float]

STORED: dict[str, Elements] = {
    "normal": (-1.0, 1.0),
    "clearcoatnormal": (-1.0, 1.0),
    "specularlobe": (0.0, 1.0),
    "opacity": (0.0, 1.0),
    "fresnel": (-1.0, 1.0),
}
"""What a valid file may hold where that is not any color: negative colors and reflectances are legal and counted."""

_ANY = (-1000.0, 1000.0)


def texels(
    key: str, dtype: np.dtype, shape: tuple[int, ...], elements: Elements | None = None
) -> st.SearchStrategy[np.ndarray]:
    """Arrays of one texture; an index of refraction may be any float, NaN too, unless ``elements`` bounds it."""
    if key == "clearcoatior" and elements is None:
        return hnp.arrays(dtype, shape)
    low, high = elements or STORED.get(key, _ANY)
    numbers = st.floats(low, high, width=dtype.itemsize * 8)  # pyright: ignore[reportArgumentType]
    if "normal" in key:
        # One component is never 0, so that no normal is without a direction.
        return hnp.arrays(dtype, (*shape[:-1], 2), elements=numbers).map(
            lambda xy: np.concatenate([xy, np.ones((*shape[:-1], 1), dtype)], axis=-1)
        )
    return hnp.arrays(dtype, shape, elements=numbers)


def textures(
    *,
    key: str,
    most: int = 5,
    channels: int | None = None,
    depth: int | None = None,
    elements: Elements | None = None,
    size_mm: Elements = (-1.0, 1e6),
) -> st.SearchStrategy[AxfTexture]:
    """Textures that are valid under the AxF name ``key``, float32 or float16.

    Args:
        key: canonical name (``axffit.axf.names.TEXTURE_KEYS``).
        most: largest side in texels.
        channels: number of channels; None draws one that is legal.
        depth: slices of the flakes' array; None draws 1 to 4.
        elements: smallest and largest value; None takes all that a file may hold.
        size_mm: smallest and largest size in millimeters (both sides are drawn alike); 0 or less is a constant.
    """
    if key not in TEXTURES:
        raise ValueError(f"unknown texture {key!r}; there are: {', '.join(TEXTURES)}")
    if most < 1:
        raise ValueError(f"most={most}: at least one texel")
    layout = TEXTURES[key]
    if channels is not None and channels not in layout.channels:
        raise ValueError(f"{key} with {channels} channels; it has {' or '.join(map(str, layout.channels))}")

    @composite
    def texture(draw: Draw) -> AxfTexture:
        dtype = draw(st.sampled_from([np.dtype(np.float32), np.dtype(np.float16)]))
        last = draw(st.sampled_from(layout.channels)) if channels is None else channels
        height, width = draw(st.integers(1, most)), draw(st.integers(1, most))
        slices = () if layout.rank == 3 else (draw(st.integers(1, 4)) if depth is None else depth,)
        shapes = [(*slices, height, width, last)]
        if layout.rank == 4:
            for _ in range(draw(st.integers(0, 3))):
                height, width = max(height // 2, 1), max(width // 2, 1)
                shapes.append((*slices, height, width, last))
        levels = tuple(draw(texels(key, dtype, shape, elements)) for shape in shapes)
        size = st.floats(*size_mm, width=32)
        return built(AxfTexture, levels, draw(size), draw(size))

    return texture()
