"""OpenEXR files: half and single floats as they are, other formats as the numbers they stand for in single floats.

Mip levels and slices are numbered parts (``level0``, ``level1.slice2``), since OpenEXR's own mip levels come out
damaged. The header attribute ``axffit.format`` names the number format, so that codes come back bit for bit.
"""

import errno
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import OpenEXR

from ...errors import InputError
from ..floats import IeeeFloat
from ..formats import FORMATS, NumberFormat, format_named
from .exr_header import Part, parts_of
from .image import MAXIMUM_LEVELS, TextureImage, content_of

SUFFIX = ".exr"

_CHANNELS = "RGBA"
_TYPES = {"half": np.float16, "float": np.float32}


def holds(format: str) -> bool:
    """Whether the codes of a format come back from the numbers they stand for."""
    form = FORMATS.get(format)
    if form is None:
        return False
    return _own_float(form) is not None or not any(codec.is_float or codec.lowest < 0 for codec in form.codecs)


def write(path: Path, image: TextureImage) -> None:
    """Write an image. The codes of float formats are stored as they are, NaN payloads included.

    Raises:
        InputError: codes of another format do not come back from the numbers they stand for (SNORM has two codes for
            -1).
        OSError: the file cannot be written whole.
    """
    form = image.number_format
    parts = []
    window = tuple(np.array(corner, dtype=np.int32) for corner in ((0, 0), _last(image.levels[0])))
    for level in range(len(image.levels)):
        for index in range(image.slices):
            codes = image.slice(level, index)
            header = {
                "compression": OpenEXR.ZIP_COMPRESSION,
                "type": OpenEXR.scanlineimage,
                "displayWindow": window,
                "axffit.format": image.format,
            }
            values = _values(codes, form, path)
            channels = {name: np.ascontiguousarray(values[..., c]) for c, name in enumerate(_CHANNELS[: form.channels])}
            name = _part_name(level, index if image.is_array else None)
            parts.append(OpenEXR.Part(header, channels, name))
    try:
        with OpenEXR.File(parts) as file:
            file.write(str(path))
        # OpenEXR has written damaged files without an error before.
        parts_of(path, content_of(path))
    except (RuntimeError, InputError) as error:
        reason = str(error).replace(f' to image file "{path}"', "")
        raise OSError(errno.EIO, f"OpenEXR could not write it ({reason})", str(path)) from error


def read(path: Path, format: str | None = None) -> TextureImage:
    """Read an image.

    Args:
        path: the file.
        format: the number format its values are codes of; None takes the one that axffit noted in the file, else that
            of its channels.

    Raises:
        InputError: it is no OpenEXR file of scan lines, cut off, damaged, or its values are no codes of the format.
    """
    parts = parts_of(path, content_of(path))
    chosen = format or parts[0].format or _format_of(path, parts[0])
    if chosen not in FORMATS:
        raise InputError(f"{path}: says that it holds {chosen!r}, which is no known format; give the format")
    form = format_named(chosen)
    wanted = set(_CHANNELS[: form.channels])
    for part in parts:
        if set(part.channels) != wanted or len(set(part.channels.values())) != 1:
            raise InputError(
                f"{path}: part {part.name!r} has channels {_listed(part)}; {chosen} needs {', '.join(sorted(wanted))} "
                "of one type"
            )
    try:
        with OpenEXR.File(str(path), separate_channels=True) as file:
            stored = [{name: channel.pixels for name, channel in part.channels.items()} for part in file.parts]
    except (RuntimeError, ValueError, TypeError) as error:
        raise InputError(f"{path}: OpenEXR cannot read it ({error}); the file is damaged") from error
    if len(stored) != len(parts):
        raise InputError(f"{path}: {len(stored)} of {len(parts)} parts can be read; the file is damaged")
    images = []
    for part, pixels in zip(parts, stored, strict=True):
        right = [pixels.get(name) for name in _CHANNELS[: form.channels]]
        if any(channel is None or channel.shape != (part.height, part.width) for channel in right):
            raise InputError(f"{path}: part {part.name!r} cannot be read whole; the file is damaged")
        images.append(_codes(np.stack(right, axis=-1), form, path))  # pyright: ignore[reportArgumentType]
    return TextureImage(chosen, _assembled(path, parts, images))


def _own_float(form: NumberFormat) -> IeeeFloat | None:
    """The float of all channels where EXR has it too, half or single."""
    codec = form.codecs[0]
    return codec if isinstance(codec, IeeeFloat) and codec.bits in (16, 32) else None


def _last(level: np.ndarray) -> tuple[int, int]:
    return level.shape[-2] - 1, level.shape[-3] - 1


def _part_name(level: int, index: int | None) -> str:
    return f"level{level}" if index is None else f"level{level}.slice{index}"


def _values(codes: np.ndarray, form: NumberFormat, path: Path) -> np.ndarray:
    """Numbers that EXR stores: the float's own bits, or the exact number rounded to a single float."""
    own = _own_float(form)
    if own is not None:
        return np.ascontiguousarray(codes).view(own.float_type)
    values = form.decode(codes).astype(np.float32)
    if not np.array_equal(form.encode(values.astype(np.float64)), codes):
        raise InputError(f"{path}: codes of {form.name} do not come back from EXR's floats; choose dds or ktx2")
    return values


def _codes(values: np.ndarray, form: NumberFormat, path: Path) -> np.ndarray:
    own = _own_float(form)
    if values.dtype not in (np.float16, np.float32):
        raise InputError(f"{path}: holds {values.dtype}; {form.name} is read from half or float")
    if own is None:
        if form.outside(values.astype(np.float64)).any():
            raise InputError(f"{path}: values outside the range of {form.name}; store them as a float format")
        return form.encode(values.astype(np.float64))
    if values.dtype != own.float_type:
        raise InputError(f"{path}: holds {values.dtype}; {form.name} needs {np.dtype(own.float_type)}")
    return np.ascontiguousarray(values).view(own.code_type)


def _format_of(path: Path, part: Part) -> str:
    channels = "".join(name for name in _CHANNELS if name in part.channels)
    kinds = set(part.channels.values())
    bits = {"half": "16F", "float": "32F"}.get(kinds.pop() if len(kinds) == 1 else "")
    format = f"{channels}{bits}"
    if bits is None or len(channels) != len(part.channels) or format not in FORMATS:
        raise InputError(f"{path}: channels {_listed(part)}; those read are R, RG, RGB or RGBA, all half or all float")
    return format


def _listed(part: Part) -> str:
    return ", ".join(f"{name} ({kind})" for name, kind in part.channels.items()) or "none"


def _assembled(path: Path, parts: Sequence[Part], images: Sequence[np.ndarray]) -> tuple[np.ndarray, ...]:
    """Levels of parts by their names; a single part of another name is the only level."""
    named = dict(zip((part.name for part in parts), images, strict=True))
    if len(parts) == 1 and parts[0].name != _part_name(0, 0):
        return (images[0],)
    array = _part_name(0, 0) in named
    levels: list[np.ndarray] = []
    while len(named) and len(levels) < MAXIMUM_LEVELS:
        slices: list[np.ndarray] = []
        while (name := _part_name(len(levels), len(slices) if array else None)) in named:
            slices.append(named.pop(name))
        if not slices or len({codes.shape for codes in slices}) > 1:
            break
        levels.append(np.stack(slices) if array else slices[0])
    if named:
        raise InputError(
            f"{path}: part {next(iter(named))!r} does not continue the levels and slices before it; parts are named "
            "level0, level1 ... or level0.slice0, level0.slice1 ..., all slices of a level of one size"
        )
    return tuple(levels)
