"""Textures packed for one target and read by another: what the second shader sees under its own names."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ..axf import AxfMaterial
from ..targets import PackedMaterial, Problem, target_named
from ..textures import FORMATS
from .verdict import TextureVerdict


def read_by(material: AxfMaterial, packed: PackedMaterial, reader: str) -> PackedMaterial:
    """The textures of a packed material under another target's names, with that target's own values for the material.

    Only the texels are the packer's, and what they were divided by, as far as the reader multiplies by something of
    that shape. A texture the reader has no place for is left out, and a note says so.

    Raises:
        InputError: an unknown target, or a material that the reader cannot hold.
    """
    packer, module = target_named(packed.target), target_named(reader)
    values, textures, unread = module.values_of(material), {}, []
    for texture in packed.textures.values():
        name = module.texture_name(texture.axf_name, packed.kind)
        if name is None:
            unread.append(texture.name)
            continue
        textures[name] = replace(texture, name=name)
        divided, multiplied = packer.scale_of(texture, packed.values), module.scale_of(textures[name], values)
        if divided is not None and multiplied is not None and np.shape(divided[1]) == np.shape(multiplied[1]):
            values[multiplied[0]] = divided[1]
    notes = (f"{reader} reads no {', '.join(unread)}",) if unread else ()
    return replace(packed, target=reader, textures=textures, values=values, notes=(*packed.notes, *notes))


def reader_problems(problems: tuple[Problem, ...], packed: PackedMaterial) -> Iterator[Problem]:
    """The reader's complaints, except about formats: a shader sees numbers, whatever they are stored as."""
    for problem in problems:
        stored = packed.textures[problem.subject].format if problem.subject in packed.textures else ""
        if problem.obligation != "texture.format" or stored not in FORMATS:
            yield problem


def misread(textures: tuple[TextureVerdict, ...], packer: str, reader: str) -> Iterator[Problem]:
    """One problem for each texture outside its tolerance that is read otherwise than it was written."""
    for texture in textures:
        packed = texture.packed
        if packed.transform == texture.reading or texture.within:
            continue
        statistics, _ = next(measured for measured in texture.measures if not measured[1].within)
        yield Problem(
            "mismatch",
            packed.name,
            f"{packed.axf_name} is packed for {packer} as {packed.transform} and read by {reader} as the inverse of "
            f"{texture.reading}: up to {statistics.max:.4g}{f' {statistics.unit}' if statistics.unit else ''} off "
            f"(mean {statistics.mean:.4g}); pack it for {reader}",
        )
