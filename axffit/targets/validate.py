"""Obligations of a target: what a packed material must fulfil, whoever packed it; by the target's tables."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ..axf import MaterialKind
from ..textures import FORMATS
from .base import PackedMaterial, PackedTexture, Problem
from .bitfields import FLOAT32_WORD, BrdfType, BrdfVariants
from .table import MAXIMUM_LOBES, SLICE_TABLE, Absent, Role, Tables, TextureRow, ValueRow, ValueType


def problems(tables: Tables, packed: PackedMaterial) -> Iterator[Problem]:
    """Every broken obligation of a packed material, by name; none when it may be handed to the shader."""
    for rule in (_values, _textures, _flags, _models, _lobes, _slices):
        yield from rule(tables, packed)


def _word(tables: Tables, packed: PackedMaterial, source: Role | str) -> int:
    """A packed integer, 0 where it is missing or no whole number (another rule says so)."""
    row = tables.value_of(source, packed.kind)
    value = 0 if row is None else packed.values.get(row.name, 0)
    return int(value) if _is_word(value) else 0


def _is_word(value: Any) -> bool:
    return np.ndim(value) == 0 and np.isfinite(value) and 0 <= value < FLOAT32_WORD and int(value) == value


def _name(row: TextureRow | ValueRow | None) -> str:
    return "" if row is None else row.name


def _packed_of(tables: Tables, packed: PackedMaterial, axf_name: str) -> PackedTexture | None:
    row = tables.row_of(axf_name, packed.kind)
    return None if row is None else packed.textures.get(row.name)


def _missing(tables: Tables, packed: PackedMaterial, axf_name: str) -> TextureRow | None:
    """The row of a texture that the importer should have made and did not."""
    row = tables.row_of(axf_name, packed.kind)
    return None if row is None or row.absent is Absent.NOTHING or row.name in packed.textures else row


def _values(tables: Tables, packed: PackedMaterial) -> Iterator[Problem]:
    """All values of the kind are there, of the right type, finite; packed integers survive float32."""
    known = {row.name: row for row in tables.values if packed.kind in row.kinds}
    for row in known.values():
        if row.name in packed.values:
            yield from _value(row, packed.values[row.name])
        else:
            yield Problem("value.missing", row.name, f"give a {row.type.value}; the default is {row.default:g}")
    for name in packed.values:
        if name not in known:
            yield Problem(
                "value.unknown", name, f"the target has no such value for a {packed.kind.value}; leave it out"
            )


def _value(row: ValueRow, value: Any) -> Iterator[Problem]:
    length = row.type.length
    if row.type is ValueType.UINT:
        if not _is_word(value):
            message = f"{value!r} does not survive a float32; give a whole number below {FLOAT32_WORD}"
            yield Problem("value.uint", row.name, message)
    elif row.type is ValueType.FLOAT:
        if not (np.ndim(value) == 0 and np.isfinite(value)):
            yield Problem("value.float", row.name, f"{value!r} is no finite number")
        elif row.source in (Role.SIZE_U, Role.SIZE_V) and value <= 0:
            yield Problem("value.size", row.name, f"{value:g} mm; uv = position / size needs a positive size")
    elif not (np.shape(value) == (length,) and np.all(np.isfinite(value))):
        message = f"{value!r} is not {length} finite numbers; pad with {row.default:g}"
        yield Problem(f"value.{row.type.value}", row.name, message)


def _textures(tables: Tables, packed: PackedMaterial) -> Iterator[Problem]:
    """Each texture is known, in an allowed format, of the right rank; scales fit the format; needed ones are there."""
    known = {row.name: row for row in tables.textures if packed.kind in row.kinds}
    for name, texture in packed.textures.items():
        if name in known:
            yield from _texture(known[name], texture, packed.values)
        else:
            yield Problem(
                "texture.unknown", name, f"the target has no such texture for a {packed.kind.value}; leave it out"
            )
    for row in known.values():
        if row.absent is Absent.DEFAULT and row.name not in packed.textures:
            color = ", ".join(f"{number:g}" for number in row.default)
            yield Problem("texture.missing", row.name, f"the shader samples it; give a 4x4 texture of ({color})")


def _texture(row: TextureRow, texture: PackedTexture, values: Mapping[str, Any]) -> Iterator[Problem]:
    choices = row.stored_choices(texture.channels)
    if not choices:
        allowed = " or ".join(str(channels) for channels in row.choices)
        yield Problem("texture.channels", row.name, f"{texture.channels} channels carry data; it must be {allowed}")
        return
    if texture.format not in FORMATS or texture.format not in {choice.format for choice in choices}:
        allowed = ", ".join(choice.format for choice in choices)
        yield Problem("texture.format", row.name, f"{texture.format} is not read by the shader; allowed: {allowed}")
        return
    rank = 4 if row.array else 3
    form = FORMATS[texture.format]
    for number, level in enumerate(texture.levels):
        if level.ndim != rank or level.shape[-1] != form.channels or level.dtype != form.codecs[0].code_type:
            yield Problem(
                "texture.codes",
                row.name,
                f"level {number} is {level.dtype} of shape {level.shape}; {texture.format} needs "
                f"{np.dtype(form.codecs[0].code_type)} of rank {rank} with {form.channels} channels",
            )
    if not texture.levels:
        yield Problem("texture.codes", row.name, "no level; give at least one")
    if row.scale is not None:
        scale = np.atleast_1d(values.get(row.scale, 1.0))
        if not np.all(np.isfinite(scale) & (scale > 0)):
            yield Problem("scale", row.scale, f"{scale.tolist()}; the scale of {row.name} must be positive")
        elif form.is_float and np.any(scale != 1.0):
            message = f"{scale.tolist()}; {row.name} is {texture.format}, which needs no scale: give 1"
            yield Problem("scale", row.scale, message)


def _flags(tables: Tables, packed: PackedMaterial) -> Iterator[Problem]:
    """Each flag bit is backed by the textures it promises, and the other way round."""
    name = _name(tables.value_of(Role.FLAGS, packed.kind))
    word = tables.flags(_word(tables, packed, Role.FLAGS))
    if word.unknown:
        yield Problem("flags", name, f"bits {word.unknown:#b} have no meaning; leave them 0")
    svbrdf = packed.kind is MaterialKind.SVBRDF
    lobe = _packed_of(tables, packed, "specularlobe")
    if word.is_anisotropic and not svbrdf:
        yield Problem("flags.bit0", name, "anisotropic is set, but only an SVBRDF has a lobe map; clear bit 0")
    if word.is_anisotropic and svbrdf:
        if _missing(tables, packed, "specularlobe") or (lobe is not None and lobe.channels != 2):
            where = _name(tables.row_of("specularlobe", packed.kind))
            yield Problem("flags.bit0", where, "anisotropic is set; the lobe map needs 2 channels")
        if row := _missing(tables, packed, "anisrotation"):
            yield Problem("flags.bit0", row.name, "anisotropic is set; give the rotation map")
    if svbrdf and not word.is_anisotropic and lobe is not None and lobe.channels == 2:
        yield Problem("flags.bit0", name, "the lobe map has 2 channels; set bit 0, or give 1 channel")
    yield from _coat_flags(tables, packed, name)
    height = tables.row_of("height", packed.kind)
    if word.has_height_map and height is not None and height.name not in packed.textures:
        yield Problem("flags.bit3", height.name, "height map is set; give the map, or clear bit 3")
    if height is not None and height.name in packed.textures and not word.has_height_map:
        yield Problem("flags.bit3", name, "a height map is given, but bit 3 is 0: it is not sampled")


def _coat_flags(tables: Tables, packed: PackedMaterial, name: str) -> Iterator[Problem]:
    word = tables.flags(_word(tables, packed, Role.FLAGS))
    if word.has_clear_coat and (row := _missing(tables, packed, "clearcoatnormal")):
        color = ", ".join(f"{number:g}" for number in row.default)
        yield Problem("flags.bit1", row.name, f"clear coat is set; give the normal map (4x4 of {color})")
    given = [t for t in packed.textures.values() if t.axf_name.startswith("clearcoat") and not t.defaulted]
    if given and not word.has_clear_coat:
        yield Problem("flags.bit1", name, f"{given[0].name} is given, but bit 1 is 0: the coat is not drawn")
    if word.has_clear_coat and word.coat_refracts and (row := _missing(tables, packed, "clearcoatior")):
        index = tables.value_of("IOR", packed.kind)
        if index is None or packed.values.get(index.name) is None:
            yield Problem("flags.bit2", row.name, "the coat refracts; give the IOR map (4x4 of F0 = 0.04)")


def _models(tables: Tables, packed: PackedMaterial) -> Iterator[Problem]:
    """The packed model integers mean something."""
    for role, field in ((Role.BRDF_TYPE, BrdfType), (Role.BRDF_VARIANTS, BrdfVariants)):
        row = tables.value_of(role, packed.kind)
        if row is not None and not field.unpack(_word(tables, packed, role)).is_known:
            message = f"{packed.values[row.name]} has no meaning; see the codes in targets.bitfields"
            yield Problem("models", row.name, message)


def _lobes(tables: Tables, packed: PackedMaterial) -> Iterator[Problem]:
    """At most four lobes, and the padding the target expects behind them."""
    counter = tables.value_of(Role.LOBES_COUNT, packed.kind)
    if counter is None:
        return
    count = _word(tables, packed, Role.LOBES_COUNT)
    if count > MAXIMUM_LOBES:
        yield Problem("lobes", counter.name, f"{count} lobes; at most {MAXIMUM_LOBES}")
        return
    for row in tables.values:
        value = packed.values.get(row.name)
        if row.type.length > 1 and row.axf_name and value is not None and np.shape(value) == (row.type.length,):
            wrong = [number for number in value[count:] if number != row.default]
            if wrong:
                yield Problem("lobes.padding", row.name, f"{wrong[0]:g} behind {count} lobes; pad with {row.default:g}")


def _slices(tables: Tables, packed: PackedMaterial) -> Iterator[Problem]:
    """The slice table is long enough and points at slices that exist."""
    flakes, row = _packed_of(tables, packed, "btfflakes"), tables.row_of(SLICE_TABLE, packed.kind)
    if row is None or flakes is None or flakes.defaulted:
        return
    table = packed.textures.get(row.name)
    if table is None:
        yield Problem("slices", row.name, "flakes are given; give the table that finds their slices")
        return
    read = row.choices[1][0] if (found := row.choice(1, table.format)) is None else found
    entries = read.reranging.inverse(table.number_format.decode(table.levels[0])[..., 0]).reshape(-1)
    bins, depth = _word(tables, packed, "max_thetaI"), flakes.levels[0].shape[0]
    if entries.size < bins:
        bound = _name(tables.value_of("max_thetaI", packed.kind))
        yield Problem("slices", row.name, f"{entries.size} texels for {bound} {bins}; give one a bin")
    if entries.size and entries.max() > depth:
        yield Problem("slices", row.name, f"it points at slice {entries.max():g} of {depth}; give all slices")
