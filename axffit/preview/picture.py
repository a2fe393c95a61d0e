"""From radiance to a picture: exposure, tone curve, sRGB, PNG.

White point: AxF's RGB is relative to a perfect diffuser of (1, 1, 1) under illuminant E, a display's white is (1, 1, 1)
too. Equal channels are therefore shown as neutral and no matrix is applied: adaptation to the display's white is the
identity in these relative units.
"""

import struct
import zlib

import numpy as np

DEFAULT_EXPOSURE = 1.0
LINEAR_LIMIT = 0.6
DIFFERENCE_GAIN = 8.0


def tone_curve(radiance: np.ndarray) -> np.ndarray:
    """Display light in [0, 1) of radiance >= 0: y = x up to a, then a + (1 - a)(1 - exp(-(x - a)/(1 - a))), a = 0.6.

    Colors up to ``LINEAR_LIMIT`` are shown as they are; only highlights are compressed, each channel by itself, with
    value and slope continuous. The curve never depends on the picture, so pictures compare.
    """
    a = LINEAR_LIMIT
    over = np.maximum(radiance - a, 0.0)
    return np.where(radiance <= a, np.maximum(radiance, 0.0), a + (1.0 - a) * -np.expm1(-over / (1.0 - a)))


def inverse_tone_curve(display: np.ndarray) -> np.ndarray:
    """Radiance that :func:`tone_curve` shows as ``display`` in [0, 1)."""
    a = LINEAR_LIMIT
    over = np.clip((display - a) / (1.0 - a), 0.0, 1.0 - 1e-6)
    return np.where(display <= a, display, a - (1.0 - a) * np.log1p(-over))


def encode_srgb(linear: np.ndarray) -> np.ndarray:
    """The sRGB transfer function (IEC 61966-2-1) on display light in [0, 1]."""
    linear = np.clip(linear, 0.0, 1.0)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055)


def to_display(radiance: np.ndarray, *, exposure: float = DEFAULT_EXPOSURE) -> np.ndarray:
    """Linear radiance (H, W, 3) to 8-bit sRGB (H, W, 3), at an exposure that is the same for every picture of a row."""
    return np.round(255.0 * encode_srgb(tone_curve(exposure * np.asarray(radiance, np.float64)))).astype(np.uint8)


def _difference(a: np.ndarray, b: np.ndarray, exposure: float) -> np.ndarray:
    """|a - b| between the sRGB values in [0, 1] of two radiances, before they are rounded to 8 bits."""
    first, second = (encode_srgb(tone_curve(exposure * np.asarray(x, np.float64))) for x in (a, b))
    return np.abs(first - second)


def difference_to_display(
    a: np.ndarray, b: np.ndarray, *, gain: float = DIFFERENCE_GAIN, exposure: float = DEFAULT_EXPOSURE
) -> np.ndarray:
    """``gain`` × |a - b| of two radiances (H, W, 3) as 8-bit sRGB levels above black.

    One 8-bit step of the display shows as ``gain`` levels; differences below a step are kept.
    """
    return np.round(255.0 * np.clip(gain * _difference(a, b, exposure), 0.0, 1.0)).astype(np.uint8)


def display_steps(a: np.ndarray, b: np.ndarray, *, exposure: float = DEFAULT_EXPOSURE) -> np.ndarray:
    """Difference of two radiances (H, W, 3) as shown, in 8-bit steps of the display, largest channel, (H, W)."""
    return 255.0 * _difference(a, b, exposure).max(axis=-1)


def _paeth_filtered(rows: np.ndarray) -> bytes:
    """PNG scan lines under the Paeth filter (PNG specification, 9.4), the best single filter for smooth pictures."""
    height, width, channels = rows.shape
    left = np.zeros((height, width, channels), np.int16)
    up, corner = left.copy(), left.copy()
    value = rows.astype(np.int16)
    left[:, 1:], up[1:], corner[1:, 1:] = value[:, :-1], value[:-1], value[:-1, :-1]
    estimate = left + up - corner
    to_left, to_up, to_corner = (np.abs(estimate - x) for x in (left, up, corner))
    nearest = np.where((to_left <= to_up) & (to_left <= to_corner), left, np.where(to_up <= to_corner, up, corner))
    filtered = (value - nearest).astype(np.uint8).reshape(height, width * channels)
    return np.concatenate([np.full((height, 1), 4, np.uint8), filtered], axis=1).tobytes()


def _png(header: bytes, *chunks: tuple[bytes, bytes]) -> bytes:
    """A PNG file of a header and further chunks (type, body), marked sRGB; the end chunk is added."""
    parts = [b"\x89PNG\r\n\x1a\n"]
    for kind, body in ((b"IHDR", header), (b"sRGB", b"\0"), *chunks, (b"IEND", b"")):
        parts.append(struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body)))
    return b"".join(parts)


def png_bytes(picture: np.ndarray) -> bytes:
    """An 8-bit RGB picture (H, W, 3) as PNG; the same picture always gives the same bytes."""
    if picture.dtype != np.uint8 or picture.ndim != 3 or picture.shape[2] != 3:
        raise ValueError(f"a PNG takes uint8 pictures of shape (H, W, 3), not {picture.dtype} {picture.shape}")
    header = struct.pack(">IIBBBBB", picture.shape[1], picture.shape[0], 8, 2, 0, 0, 0)
    return _png(header, (b"IDAT", zlib.compress(_paeth_filtered(picture), 9)))


def indexed_png_bytes(indices: np.ndarray, palette: np.ndarray) -> bytes:
    """A picture of indices (H, W) uint8 into a palette (K, 3) uint8 as PNG: a third of the size of RGB."""
    if (
        indices.dtype != np.uint8
        or indices.ndim != 2
        or palette.dtype != np.uint8
        or int(indices.max()) >= len(palette)
    ):
        raise ValueError(f"indices {indices.dtype} {indices.shape} and palette {palette.shape} make no indexed PNG")
    header = struct.pack(">IIBBBBB", indices.shape[1], indices.shape[0], 8, 3, 0, 0, 0)
    rows = np.concatenate([np.zeros((len(indices), 1), np.uint8), indices], axis=1)
    return _png(header, (b"PLTE", palette.tobytes()), (b"IDAT", zlib.compress(rows.tobytes(), 9)))
