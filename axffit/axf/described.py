"""From the sorted leaves of a material that axffit wrote to the material, by its description (`docs/axf-layout.md`)."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any, TypeVar

from ..errors import InputError
from . import layout
from .gather import Candidate, Gathered
from .hdf5 import Leaf
from .material import AxfMaterial, AxfTexture, MaterialKind
from .names import DIFFUSE_MODELS, FILTERS, SPECULAR_MODELS, TEXTURES
from .properties import PROPERTY_TYPES
from .resources import own_texture, single

_Value = TypeVar("_Value")


def described_material(gathered: Gathered, rest: list[Leaf]) -> tuple[int, AxfMaterial]:
    """The place of the material in its file and the material, with its other representations.

    Args:
        gathered: the leaves of the material's group.
        rest: takes the leaves that were not used.

    Raises:
        InputError: the description is damaged.
    """
    rest += gathered.rest
    nodes = {c.node: c for candidates in gathered.textures.values() for c in candidates}
    read: dict[str, AxfTexture] = {}
    entries, inferred = [], []
    for number in sorted(gathered.own, key=lambda number: int(number or 0)):
        own = gathered.own[number]
        textures = {}
        for key, node in _stated(own, gathered, nodes, first=not number).items():
            if node not in read:
                read[node] = own_texture(nodes[node], rest, inferred)
            textures[key] = read[node]
        entries.append(_described(own, gathered.group, textures))
        rest += _besides(own)
    rest += [leaf for node, candidate in nodes.items() if node not in read for leaf in candidate.leaves]
    rest += gathered.wavelengths
    rest += gathered.metadata.values()
    rest += [leaf for leaves in gathered.properties.values() for leaf in leaves]
    rest += [leaf for found in gathered.strings.values() for _, leaf in found]
    first = gathered.own.get("")
    if first is None:
        raise InputError(f"material {gathered.group!r}: {layout.OWN_GROUP} is missing beside its numbered ones")
    front = replace(entries[0], alternatives=tuple(entries[1:]), inferred=tuple(inferred))
    return int(_number(first, "Index")), front


def _stated(own: dict[str, Leaf], gathered: Gathered, nodes: dict[str, Candidate], *, first: bool) -> dict[str, str]:
    """The node of each texture: what the description says, else for the first one AxF's own place where it is."""
    found = {}
    prefix = f"/{layout.MATERIALS}/{gathered.group}/{layout.RESOURCES}/"
    for key in TEXTURES:
        leaf = own.get(f"{layout.TEXTURES}/{key}")
        if leaf is not None:
            stated = _text(leaf)
            if stated and prefix + stated not in nodes:
                raise InputError(f"{leaf.path} is {stated!r}, where no texture is; name a node below the resources")
            if stated:
                found[key] = prefix + stated
        elif first and prefix + TEXTURES[key].node in nodes:
            found[key] = prefix + TEXTURES[key].node
    return found


def _described(own: dict[str, Leaf], group: str, textures: dict[str, AxfTexture]) -> AxfMaterial:
    kinds = {kind.value: kind for kind in MaterialKind}
    properties, metadata = {}, {}
    for path, leaf in own.items():
        section, _, name = path.partition("/")
        if section == "Properties":
            properties[name] = _property(name, leaf)
        elif section == "Metadata":
            metadata[layout.unescape(name)] = _text(leaf)
    return AxfMaterial(
        id=_own_text(own, "Id", group),
        name=_own_text(own, "Name", group),
        kind=_known(own, "Class", kinds, group),
        diffuse_model=_known(own, "DiffuseModel/TypeKey", _inverse(DIFFUSE_MODELS), group),
        specular_model=_known(own, "SpecularModel/TypeKey", _inverse(SPECULAR_MODELS), group),
        specular_variant=_optional(own, "SpecularModel/Variant"),
        fresnel_variant=_optional(own, "SpecularModel/FresnelVariant"),
        anisotropic=bool(_number(own, "SpecularModel/IsAnisotropic")),
        textures=textures,
        properties=properties,
        metadata=metadata,
        representation=_optional(own, layout.REPRESENTATION) or "",
    )


def _property(name: str, leaf: Leaf) -> Any:
    if not leaf.is_number:
        raise InputError(f"{leaf.path} holds no number; write a number or a list of them")
    if name not in PROPERTY_TYPES:
        raise InputError(f"{leaf.path} is no AxF property; allowed: {', '.join(PROPERTY_TYPES)}")
    return PROPERTY_TYPES[name].convert(leaf.array(), leaf.path)


_OWN_NAMES = {
    "Index",
    "Id",
    "Name",
    "Class",
    "DiffuseModel/TypeKey",
    "SpecularModel/TypeKey",
    "SpecularModel/Variant",
    "SpecularModel/FresnelVariant",
    "SpecularModel/IsAnisotropic",
    layout.REPRESENTATION,
    *(f"{name}Filter/TypeKey" for name in FILTERS),
    *(f"{layout.TEXTURES}/{key}" for key in TEXTURES),
}


def _besides(own: dict[str, Leaf]) -> Iterator[Leaf]:
    """What a description holds beyond what is written there: it is not used."""
    for path, leaf in own.items():
        if not is_own_name(path):
            yield leaf


def is_own_name(path: str) -> bool:
    """Whether a path below our description is one that it consists of."""
    return path in _OWN_NAMES or path.partition("/")[0] in ("Properties", "Metadata")


def _inverse(table: Mapping[str, str]) -> dict[str, str]:
    return {key: name for name, key in table.items()}


def _text(leaf: Leaf) -> str:
    text = leaf.text()
    if text is None:
        raise InputError(f"{leaf.path} holds no single text; write it as one string")
    return text


def _optional(own: dict[str, Leaf], name: str) -> str | None:
    return _text(own[name]) if name in own else None


def _own_text(own: dict[str, Leaf], name: str, group: str) -> str:
    if name not in own:
        raise InputError(f"material {group!r}: {layout.OWN_GROUP}/{name} is missing; write it as one string")
    return _text(own[name])


def _number(own: dict[str, Leaf], name: str) -> float:
    return single(own[name]) if name in own and own[name].is_number else 0.0


def _known(own: dict[str, Leaf], name: str, table: Mapping[str, _Value], group: str) -> _Value:
    text = _own_text(own, name, group)
    if text not in table:
        raise InputError(f"{own[name].path} is {text!r}; allowed: {', '.join(table)}")
    return table[text]
