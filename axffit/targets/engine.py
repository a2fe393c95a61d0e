"""The core of every target: `pack`, `unpack`, `validate` and `reading` by the target's tables.

A target module is tables, and where its importer does more than re-range and quantize, two functions: what it does to
a material before (`prepare`) and how its values are read afterwards (`restore`).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..axf import AxfMaterial, AxfTexture, MaterialKind
from ..axf.ranges import ROUGHNESS_FLOOR
from ..axf.validation import check
from ..errors import InputError
from ..textures import Counts, NumberFormat, format_named
from ..textures.codec import check_rounding
from ..textures.rerange import Chain, Identity, Reranging, Scale, texels
from .base import PackedMaterial, PackedTexture, Problem
from .encoding import blocks, decode_level, decode_rows, encode_level, spread
from .rerangings import ChannelScale
from .table import SLICE_TABLE, Absent, FormatChoice, Scaling, Tables, TextureRow
from .validate import problems
from .values import coat_textures, common_notes, material_fields, material_values


@dataclass(frozen=True, eq=False)
class Prepared:
    """A material as an importer has changed it before it re-ranges anything.

    Attributes:
        material: the material.
        values: the target's names to values that do not follow from the material's properties.
        counts: AxF names to texels the change could not keep.
        notes: what was changed, and what the target cannot express, one sentence each.
    """

    material: AxfMaterial
    values: Mapping[str, Any] = field(default_factory=dict)
    counts: Mapping[str, Counts] = field(default_factory=dict)
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Engine:
    """A target.

    Attributes:
        tables: its textures and values.
        rounding: how its importer rounds.
        prepare: what its importer does to a material first.
        restore: (packed, fields of `AxfMaterial`) -> fields: the inverse, as far as there is one.
    """

    tables: Tables
    rounding: str = "nearest_even"
    prepare: Callable[[AxfMaterial], Prepared] = Prepared
    restore: Callable[[PackedMaterial, dict[str, Any]], dict[str, Any]] = lambda packed, fields: fields

    @property
    def name(self) -> str:
        """The target's name."""
        return self.tables.name

    def pack(
        self, material: AxfMaterial, *, formats: Mapping[str, str] | None = None, rounding: str | None = None
    ) -> PackedMaterial:
        """The textures and values that the engine's AxF material expects for this material.

        Args:
            material: SVBRDF or car paint, in AxF's ranges.
            formats: AxF texture name to one of the formats its row allows; the advised format for the rest.
            rounding: rounding mode of every encoder; None takes the target's own.

        Returns:
            Every texture of the table that the material's kind has: re-ranged, clamped and counted, quantized, all
            mip levels kept; defaults for absent ones where the target makes them.

        Raises:
            InputError: the material breaks a rule of AxF (`axf.validation`), or a format or rounding is not allowed.
        """
        check(material)
        rounding = self.rounding if rounding is None else rounding
        check_rounding(rounding)
        chosen = self._chosen_formats(formats or {})
        prepared = self.prepare(material)
        material, values = prepared.material, self._values(prepared)
        textures = {}
        for row in self.tables.textures:
            if material.kind not in row.kinds:
                continue
            source, format = _source(row, material), chosen.get(row.axf_name)
            if source is None:
                if _default_wanted(row, material):
                    textures[row.name] = self._default_texture(row, material, format, rounding)
                continue
            choice = self._choice(row, source.channels, format)
            if row.scale is not None:
                values[row.scale] = _scale(row, source, choice)
            lost = prepared.counts.get(row.axf_name, Counts())
            textures[row.name] = _texture(row, source, choice, values, rounding, material, lost)
        return PackedMaterial(
            target=self.name,
            id=material.id,
            name=material.name,
            kind=material.kind,
            textures=textures,
            values=values,
            metadata=material.metadata,
            notes=(*prepared.notes, *common_notes(self.tables, material)),
        )

    def reading(self, texture: PackedTexture, values: Mapping[str, Any]) -> Reranging:
        """How this target's shader reads a texture: its inverse turns decoded texels into AxF's values.

        It follows from the texture's name, its format and the packed values, never from what the packer says it did,
        so that a texture packed wrongly, or for another target, is read as this target would read it. A format that
        the target does not advise is read as its advised one: the shader sees numbers, not formats.

        Raises:
            InputError: the target has no such texture, or not of so many channels.
        """
        row = self.tables.row(texture.name)
        choices = row.stored_choices(texture.channels)
        if not choices:
            allowed = " or ".join(str(number) for number in row.choices)
            raise InputError(f"{self.name}: {row.name} has {texture.channels} channels; the shader reads {allowed}")
        choice = next((choice for choice in choices if choice.format == texture.format), choices[0])
        return _transform(row, choice, values)

    def texture_name(self, axf_name: str, kind: MaterialKind) -> str | None:
        """The target's name of an AxF texture in a material of that kind, or None where it has no place for it."""
        row = self.tables.row_of(axf_name, kind)
        return None if row is None else row.name

    def default_values(self, name: str) -> np.ndarray:
        """The default of a texture in AxF's range, [channels]: what its 4x4 stand-in is meant to say.

        Raises:
            InputError: the target has no such texture.
        """
        row = self.tables.row(name)
        channels = max(row.choices)
        choice = row.choices[channels][0]
        stored = np.array(row.default)[: min(channels, format_named(choice.format).channels)]
        return _chain(choice.reranging, choice.curve).inverse(stored)

    def values_of(self, material: AxfMaterial) -> dict[str, Any]:
        """The values `pack` gives this material, the scales of its textures left at 1."""
        return self._values(self.prepare(material))

    def scale_of(self, texture: PackedTexture, values: Mapping[str, Any]) -> tuple[str, Any] | None:
        """Name and value of what a texture is divided by, or None.

        Raises:
            InputError: the target has no such texture.
        """
        name = self.tables.row(texture.name).scale
        return None if name is None else (name, values.get(name, 1.0))

    def validate(self, packed: PackedMaterial) -> tuple[Problem, ...]:
        """Every broken obligation of a packed material, by name; empty when it may be handed to the shader."""
        return tuple(problems(self.tables, packed))

    def unpack(self, packed: PackedMaterial, *, defaults: bool = True) -> AxfMaterial:
        """The material the shader will see, in AxF's ranges again.

        Args:
            packed: a packed material, not necessarily packed by `pack`.
            defaults: whether textures that are only the target's defaults become textures of the material, too.

        Returns:
            A material whose textures are decoded and re-ranged back (float32). What packing lost stays lost. A car
            paint without the clear-coat flag comes back with a coat of index 1, which is none.

        Raises:
            InputError: a texture, format or packed integer the target does not know.
        """
        textures = {}
        slices = None
        for texture in packed.textures.values():
            if texture.defaulted and not defaults:
                continue
            read = self.reading(texture, packed.values)
            form = format_named(texture.format)
            levels = tuple(decode_level(codes, read, form, texture.channels) for codes in texture.levels)
            if texture.axf_name == SLICE_TABLE:
                slices = np.rint(levels[0].reshape(-1)).astype(np.int32)
            else:
                textures[texture.axf_name] = AxfTexture(levels, texture.width_mm, texture.height_mm, texture.source)
        fields = self.restore(packed, material_fields(self.tables, packed, slices))
        return AxfMaterial(id=packed.id, name=packed.name, textures=textures, metadata=packed.metadata, **fields)

    def _values(self, prepared: Prepared) -> dict[str, Any]:
        return {**material_values(self.tables, prepared.material), **prepared.values}

    def _chosen_formats(self, formats: Mapping[str, str]) -> dict[str, str]:
        known = {row.axf_name for row in self.tables.textures}
        for name in formats:
            if name not in known:
                allowed = ", ".join(sorted(known))
                raise InputError(f"{self.name}: a format is given for {name!r}; allowed names: {allowed}")
        return dict(formats)

    def _choice(self, row: TextureRow, channels: int, format: str | None) -> FormatChoice:
        """The choice of that format (the advised one for None) for a texture of so many AxF channels."""
        if channels not in row.choices:
            allowed = " or ".join(str(number) for number in row.choices)
            raise InputError(f"{self.name}: {row.name} of {channels} channels; it must have {allowed}")
        if format is None:
            return row.choices[channels][0]
        choice = row.choice(channels, format)
        if choice is None:
            allowed = ", ".join(choice.format for choice in row.choices[channels])
            raise InputError(f"{self.name}: {row.name} of {channels} channels cannot be {format}; allowed: {allowed}")
        return choice

    def _default_texture(
        self, row: TextureRow, material: AxfMaterial, format: str | None, rounding: str
    ) -> PackedTexture:
        channels = max(row.choices)
        if row.axf_name == "specularlobe" and len(row.choices) > 1:
            channels = 2 if material.anisotropic else 1
        choice = self._choice(row, channels, format)
        form = format_named(choice.format)
        color = spread(np.array(row.default[: form.channels]), form.channels)
        shape = (1, 4, 4, form.channels) if row.array else (4, 4, form.channels)
        codes = form.encode(np.broadcast_to(color, shape), rounding)
        return PackedTexture(
            name=row.name,
            axf_name=row.axf_name,
            format=choice.format,
            rounding=rounding,
            levels=(codes,),
            channels=min(channels, form.channels),
            transform=_chain(choice.reranging, choice.curve).formula,
            defaulted=True,
        )


def _chain(*steps: Reranging) -> Reranging:
    used = tuple(step for step in steps if not isinstance(step, Identity))
    return used[0] if len(used) == 1 else Chain(used)


def _transform(row: TextureRow, choice: FormatChoice, values: Mapping[str, Any]) -> Reranging:
    """AxF's range to the texture's, the scale between re-ranging and curve."""
    scale = 1.0 if row.scale is None else values.get(row.scale, 1.0)
    divided: Reranging = Identity()
    if row.scaling is Scaling.PER_CHANNEL and row.scale is not None:
        divided = ChannelScale(tuple(float(number) for number in np.atleast_1d(scale)))
    elif float(scale) != 1.0:
        divided = Scale(float(scale))
    return _chain(choice.reranging, divided, choice.curve)


def _source(row: TextureRow, material: AxfMaterial) -> AxfTexture | None:
    """What AxF has for a row; the slice table is a property, made a texture of one row here."""
    if row.axf_name == SLICE_TABLE:
        table = material.properties.get(SLICE_TABLE)
        return None if table is None else AxfTexture((np.asarray(table, dtype=np.float32).reshape(1, -1, 1),))
    return material.textures.get(row.axf_name)


def _default_wanted(row: TextureRow, material: AxfMaterial) -> bool:
    if row.absent is Absent.COAT_FLAG:
        return bool(coat_textures(material))
    return row.absent is Absent.DEFAULT


def _scale(row: TextureRow, source: AxfTexture, choice: FormatChoice) -> float | tuple[float, ...]:
    """What the texture is divided by, float32; see `Scaling`."""
    if row.scaling is Scaling.PER_CHANNEL:
        tops = [choice.reranging.forward(rows).max(axis=0) for level in source.levels for _, rows in blocks(level)]
        largest = np.resize(np.maximum(np.max(tops, axis=0), 0.1).astype(np.float32), 3)
        return tuple(float(number) for number in largest)
    if row.scaling is Scaling.FILL and format_named(choice.format).is_float:
        return 1.0
    largest = max(float(choice.reranging.forward(level.max(keepdims=True)).max()) for level in source.levels)
    threshold = 1.0 if row.scaling is Scaling.ABOVE_ONE else 0.0
    return float(np.float32(largest)) if largest > threshold else 1.0


def _texture(
    row: TextureRow,
    source: AxfTexture,
    choice: FormatChoice,
    values: Mapping[str, Any],
    rounding: str,
    material: AxfMaterial,
    lost: Counts,
) -> PackedTexture:
    form, transform = format_named(choice.format), _transform(row, choice, values)
    # A Fresnel map of one channel is a gray color; other maps of one channel use the first channel alone.
    gray = source.channels == 1 and 3 in row.choices
    encoded = [encode_level(level, transform, form, rounding, gray=gray) for level in source.levels]
    codes = tuple(level for level, _ in encoded)
    counts = sum((count for _, count in encoded), lost)
    channels = min(source.channels, form.channels)
    if row.axf_name == "specularlobe" and material.specular_model not in ("BlinnPhong", "Phong"):
        counts += Counts(floored=sum(_floored(level, transform, form, channels) for level in codes))
    return PackedTexture(
        name=row.name,
        axf_name=row.axf_name,
        format=choice.format,
        rounding=rounding,
        levels=codes,
        channels=channels,
        transform=transform.formula,
        counts=counts,
        width_mm=source.width_mm,
        height_mm=source.height_mm,
        source=source.source,
    )


def _floored(codes: np.ndarray, transform: Reranging, form: NumberFormat, channels: int) -> int:
    return sum(texels(decode_rows(rows, transform, form, channels) < ROUGHNESS_FLOOR) for _, rows in blocks(codes))
