"""Images of random codes for the tests of image files."""

import numpy as np

from axffit.textures import FORMATS, format_named
from axffit.textures.files import TextureImage
from axffit.textures.files.image import code_type_of


def random_image(
    format: str, *, size: tuple[int, int] = (7, 5), levels: int = 1, slices: int | None = None, seed: int = 0
) -> TextureImage:
    """Codes of every bit pattern, NaN payloads of floats included; levels halve."""
    rng = np.random.default_rng(seed)
    form = format_named(format)
    shape = () if slices is None else (slices,)
    made = []
    for k in range(levels):
        level = [
            rng.integers(0, 2**codec.bits, (*shape, max(1, size[0] >> k), max(1, size[1] >> k)), dtype=np.uint64)
            for codec in form.codecs
        ]
        codes = np.stack(level, axis=-1).astype(code_type_of(form))
        if format == "RGB9E5":
            # The channels of a texel share the exponent above their mantissas.
            codes = (codes & np.uint16(511)) | (codes[..., :1] & np.uint16(0x3E00))
        made.append(codes)
    return TextureImage(format, tuple(made))


def same(a: TextureImage, b: TextureImage) -> bool:
    """Whether both hold the same codes."""
    return (
        a.format == b.format
        and len(a.levels) == len(b.levels)
        and all(x.dtype == y.dtype and np.array_equal(x, y) for x, y in zip(a.levels, b.levels, strict=True))
    )


ALL_FORMATS = tuple(FORMATS)
