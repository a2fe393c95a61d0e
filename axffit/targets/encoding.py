"""Levels of a texture to codes and back, in blocks; large results lie outside of memory (`axf.scratch`).

Every target uses these two directions; a target only says which re-ranging and which format.
"""

from collections.abc import Iterator

import numpy as np

from ..axf.scratch import empty, let_go
from ..textures import Counts, NumberFormat
from ..textures.rerange import Reranging, texels

BLOCK_TEXELS = 2**17
"""Texels at once: the float64 intermediates stay in the cache's size class."""


def blocks(level: np.ndarray) -> Iterator[tuple[slice, np.ndarray]]:
    """Runs of texels of a level [..., C] as ([start, stop) in the flattened texel order, the rows [n, C]).

    A level outside of memory takes some only while its blocks are gone through.
    """
    flat = level.reshape(-1, level.shape[-1])
    for start in range(0, len(flat), BLOCK_TEXELS):
        run = slice(start, min(start + BLOCK_TEXELS, len(flat)))
        yield run, flat[run]
    let_go(level)


def spread(values: np.ndarray, channels: int) -> np.ndarray:
    """Values [n, c] on the ``channels`` of a format: a gray color on all three, missing colors 0, missing alpha 1."""
    given = values.shape[-1]
    if given == channels:
        return values
    full = np.zeros((*values.shape[:-1], channels))
    if channels == 4:
        full[..., 3] = 1.0
    full[..., :given] = values
    return full


def encode_level(
    level: np.ndarray, transform: Reranging, form: NumberFormat, rounding: str, *, gray: bool = False
) -> tuple[np.ndarray, Counts]:
    """Codes [..., format channels] of an AxF level [..., C], and what could not be kept.

    Values beyond the format's range go to its end and are counted as clamped, so that no half becomes infinite.

    Args:
        level: AxF's values.
        transform: re-ranging from AxF to the target.
        form: the number format.
        rounding: its rounding mode.
        gray: whether a single channel stands for a gray color and is repeated on three channels.
    """
    codes = empty((level[..., 0].size, form.channels), form.codecs[0].code_type)
    lowest = np.array([codec.lowest for codec in form.codecs])
    highest = np.array([codec.highest for codec in form.codecs])
    counts = Counts()
    for run, rows in blocks(level):
        values = transform.forward(rows)
        if gray and values.shape[-1] == 1:
            values = np.repeat(values, 3, axis=-1)
        used = values.shape[-1]
        values = spread(values, form.channels)
        outside = form.outside(values)
        if outside.any():
            held = np.clip(values, lowest, highest)
            beyond = np.abs(transform.inverse(values[..., :used]) - transform.inverse(held[..., :used]))
            counts += Counts(clamped=texels(outside), excess=float(np.nanmax(beyond, initial=0.0)))
            values = held
        counts += transform.count(rows)
        codes[run] = form.encode(values, rounding)
    let_go(codes)
    return codes.reshape(*level.shape[:-1], form.channels), counts


def decode_rows(codes: np.ndarray, reading: Reranging, form: NumberFormat, channels: int) -> np.ndarray:
    """AxF values [..., AxF channels] in float64 of codes [..., format channels]: what the shader works with."""
    return reading.inverse(form.decode(codes)[..., :channels])


def decode_level(codes: np.ndarray, reading: Reranging, form: NumberFormat, channels: int) -> np.ndarray:
    """A whole level in AxF's range, float32 as in a shader; ``channels`` of the format carry data."""
    level: np.ndarray | None = None
    for run, rows in blocks(codes):
        with np.errstate(over="ignore"):
            values = decode_rows(rows, reading, form, channels)
            if level is None:
                level = empty((codes[..., 0].size, values.shape[-1]), np.float32)
            level[run] = values
    if level is None:
        return np.empty((*codes.shape[:-1], channels), dtype=np.float32)
    let_go(level)
    return level.reshape(*codes.shape[:-1], level.shape[-1])
