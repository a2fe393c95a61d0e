"""Validation at the border: what a material must fulfil before anything is computed from it."""

from collections.abc import Iterator

import numpy as np

from ..errors import InputError
from .material import AxfMaterial, AxfTexture
from .names import COLOR_KEYS, SPECTRUM_CHANNELS, TEXTURES
from .ranges import (
    EXPONENT_RANGE,
    FRESNEL_MAXIMUM,
    MAXIMUM_LOBES,
    MAXIMUM_LUT_ENTRIES,
    PROPERTY_RANGES,
    TEXTURE_RANGES,
    Outside,
    Range,
)
from .scratch import let_go

LOBE_ARRAYS = ("CT_coeffs", "CT_F0s", "CT_spreads")
"""The three properties that describe the lobes of a car paint, one entry a lobe each."""


def check(material: AxfMaterial, source: str = "") -> None:
    """Refuse a material that cannot be used.

    Args:
        material: the material.
        source: the file it comes from, named in the message.

    Raises:
        InputError: the first of `problems`.
    """
    for problem in problems(material):
        raise InputError(f"{source}: {problem}" if source else problem)


def problems(material: AxfMaterial) -> Iterator[str]:
    """Every broken rule as one line that names the node, the value, what is allowed and the mend."""
    for key, texture in material.textures.items():
        node = texture.source or f"{material.id}/{key}"
        complaints = list(_shape_problems(key, texture, node))
        yield from complaints
        if not complaints:
            yield from _value_problems(key, texture, node, material.specular_model)
        yield from _spectrum_problems(key, texture, node)
    yield from _property_problems(material)
    yield from _lobe_problems(material)
    yield from _slice_problems(material)


def _shape_problems(key: str, texture: AxfTexture, node: str) -> Iterator[str]:
    layout = TEXTURES[key]
    shape_in_words = "[depth, height, width, channels]" if layout.rank == 4 else "[height, width, channels]"
    for number, level in enumerate(texture.levels):
        where = node if number == 0 else f"{node} (level {number})"
        if level.ndim != layout.rank:
            yield (
                f"{where}: {key} of rank {level.ndim} (shape {level.shape}); "
                f"it must have rank {layout.rank}: store it as {shape_in_words}"
            )
        elif 0 in level.shape:
            yield f"{where}: {key} has no texel (shape {level.shape}); leave it out or give at least 1x1"
        elif level.dtype not in (np.float16, np.float32):
            yield f"{where}: {key} holds {level.dtype}; store float32 or float16"
        elif level.shape[-1] not in layout.channels:
            allowed = " or ".join(str(channels) for channels in layout.channels)
            spectrum = " (a spectrum?)" if level.shape[-1] > 4 else ""
            yield f"{where}: {key} has {level.shape[-1]} channels{spectrum}; it must have {allowed}"
        elif number and (level.shape[-1] != texture.channels or level.shape[:-3] != texture.data.shape[:-3]):
            yield (
                f"{where}: shape {level.shape} does not continue level 0 of shape {texture.data.shape}; "
                "all levels need the same channels and slices"
            )


def _value_problems(key: str, texture: AxfTexture, node: str, specular_model: str) -> Iterator[str]:
    legal = TEXTURE_RANGES[key]
    if key == "specularlobe" and specular_model in ("BlinnPhong", "Phong"):
        legal = EXPONENT_RANGE
    for number, level in enumerate(texture.levels):
        where = node if number == 0 else f"{node} (level {number})"
        if key != "clearcoatior":
            bad = ~np.isfinite(level)
            if bad.any():
                yield (
                    f"{where}: {_place(bad, level)} in {key} not finite; only a clear-coat IOR may be NaN: "
                    "replace these texels"
                )
                continue
        for bound in (legal, FRESNEL_MAXIMUM) if key == "fresnel" else (legal,):
            bad = bound.beyond(level) if bound.outside is Outside.ERROR else np.zeros(1, bool)
            if bad.any():
                yield f"{where}: {_place(bad, level)} in {key} ({bound.unit}) outside {bound}; correct them"
        if key in ("normal", "clearcoatnormal"):
            bad = np.all(level == 0, axis=-1)
            if bad.any():
                yield (
                    f"{where}: {_place(bad, level)} in {key} of length 0; a normal needs a direction, (0, 0, 1) is flat"
                )
        let_go(level)


def _spectrum_problems(key: str, texture: AxfTexture, node: str) -> Iterator[str]:
    for number, level in enumerate(texture.spectra):
        where = node if number == 0 else f"{node} (level {number})"
        if key not in COLOR_KEYS or level.shape[-1:] < (SPECTRUM_CHANNELS,):
            yield (
                f"{where}: {key} as spectra of shape {level.shape}; only colors may be spectra, "
                f"of {SPECTRUM_CHANNELS} channels or more"
            )
        elif level.ndim != TEXTURES[key].rank or 0 in level.shape or level.dtype not in (np.float16, np.float32):
            yield (
                f"{where}: {key} as spectra of rank {level.ndim} (shape {level.shape}, {level.dtype}); "
                f"store float32 or float16 of rank {TEXTURES[key].rank}"
            )
        elif texture.levels and [each.shape[:-1] for each in texture.levels] != [
            each.shape[:-1] for each in texture.spectra
        ]:
            yield f"{where}: {key} has spectra and RGB of unequal sizes; convert every level"
        elif not np.isfinite(level).all():
            yield f"{where}: {_place(~np.isfinite(level), level)} in {key} not finite; replace these texels"


def _place(bad: np.ndarray, values: np.ndarray) -> str:
    """How many are bad, and where and what the first one is."""
    first = tuple(int(index) for index in np.argwhere(bad)[0])
    count = int(np.count_nonzero(bad))
    noun = "value" if count == 1 else "values"
    # As a list: how numpy prints arrays depends on options that other packages set.
    value = values[first].tolist() if np.ndim(values[first]) else values[first]
    return f"{count} {noun} (first at {list(first)}: {value})"


def _property_problems(material: AxfMaterial) -> Iterator[str]:
    for name, value in material.properties.items():
        legal = PROPERTY_RANGES[name]
        values = np.atleast_1d(value)
        bad = ~np.isfinite(values) | legal.beyond(values)
        if bad.any():
            index = int(np.flatnonzero(bad)[0])
            entry = f"{name}[{index}]" if np.ndim(value) else name
            yield f"{material.id}: property {entry} is {values[index]}; allowed: {_in_words(legal)}: correct it"


def _in_words(legal: Range) -> str:
    return f"a finite {legal.unit} in {legal}"


def _lobe_problems(material: AxfMaterial) -> Iterator[str]:
    lengths = {name: len(material.properties.get(name, ())) for name in LOBE_ARRAYS}
    if len(set(lengths.values())) > 1:
        listed = ", ".join(f"{name} {length}" for name, length in lengths.items())
        yield f"{material.id}: lobe properties of unequal length ({listed}); give one entry a lobe in each"
    if max(lengths.values()) > MAXIMUM_LOBES:
        yield f"{material.id}: {max(lengths.values())} lobes; AxF has at most {MAXIMUM_LOBES}"


def _slice_problems(material: AxfMaterial) -> Iterator[str]:
    """The LUT of flake slices rises, except that unused entries at its end are 0."""
    lut = material.properties.get("thetaFI_sliceLUT")
    if lut is None:
        return
    where = f"{material.id}: property thetaFI_sliceLUT"
    if len(lut) > MAXIMUM_LUT_ENTRIES:
        yield f"{where} has {len(lut)} entries; AxF has at most {MAXIMUM_LUT_ENTRIES}"
    bins = int(material.properties.get("max_thetaI", 0))
    if len(lut) < bins:
        yield f"{where} has {len(lut)} entries for max_thetaI {bins}; it needs one entry a bin"
    used = len(np.trim_zeros(lut, "b"))
    falls = np.flatnonzero(np.diff(lut[:used]) < 0)
    if falls.size:
        index = int(falls[0]) + 1
        yield f"{where} falls from {lut[index - 1]} to {lut[index]} at entry {index}; slices must be in order"
    flakes = material.textures.get("btfflakes")
    if flakes is not None and flakes.data.ndim == 4 and used and lut[:used].max() > flakes.data.shape[0]:
        yield (
            f"{where} points at slice {lut[:used].max()} but the flakes have {flakes.data.shape[0]} slices; "
            "give all slices or correct the table"
        )
