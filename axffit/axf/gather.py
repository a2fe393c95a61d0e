"""What a material's group holds, sorted by name: candidates for textures, properties, known strings, the rest."""

import re
from collections.abc import Iterable
from dataclasses import dataclass, field

from . import layout
from .hdf5 import Leaf
from .names import (
    COLOR_KEYS,
    DIFFUSE_MODELS,
    FILTERS,
    FRESNEL_VARIANTS,
    SPECTRUM_CHANNELS,
    SPECULAR_MODELS,
    SPECULAR_VARIANTS,
    TEXTURES,
    canonical_property,
    canonical_texture,
    fold,
    is_preview,
    suffix,
)

_LEVEL = re.compile(r"(?:level|mip)_?0*([1-9]\d{0,2})", re.IGNORECASE)

_RGB = re.compile(f"{layout.RGB}(?:{layout.LEVEL}([1-9]\\d{{0,2}}))?")
_WAVELENGTHS = {fold(name) for name in ("Wavelengths", "Wavelength", "WavelengthsNM", "WavelengthNM", "Lambda")}


@dataclass
class Candidate:
    """One resource that may be a texture.

    Attributes:
        key: canonical name of the texture.
        node: path of the resource.
        data: the leaf of level 0.
        levels: the leaves of the further mip levels by number.
        width: leaf of the extent along u, or None.
        height: leaf of the extent along v, or None.
        wavelengths: leaf of the wavelengths of a spectrum, or None.
        rgb: the leaves of what was made of a spectrum, by level (our own).
    """

    key: str
    node: str
    data: Leaf
    levels: dict[int, Leaf] = field(default_factory=dict)
    width: Leaf | None = None
    height: Leaf | None = None
    wavelengths: Leaf | None = None
    rgb: dict[int, Leaf] = field(default_factory=dict)

    @property
    def suffix(self) -> str:
        """The number of the representation its name belongs to, or ""."""
        return suffix(self.node.split("/")[3:])

    @property
    def is_spectrum(self) -> bool:
        """Whether it is a color of one channel a wavelength."""
        channels = (self.data.shape or (0,))[-1]
        return self.key in COLOR_KEYS and channels >= SPECTRUM_CHANNELS

    @property
    def is_legal(self) -> bool:
        """Whether its last extent is a number of channels that the texture may have."""
        return (self.data.shape or (0,))[-1] in TEXTURES[self.key].channels or self.is_spectrum

    @property
    def leaves(self) -> list[Leaf]:
        """All its leaves."""
        optional = (self.width, self.height, self.wavelengths)
        return [
            self.data,
            *self.levels.values(),
            *(leaf for leaf in optional if leaf is not None),
            *self.rgb.values(),
        ]


@dataclass
class Gathered:
    """The leaves of one material by what they are.

    Attributes:
        group: the name of the material's group.
        textures: candidates by canonical texture name.
        properties: leaves by AxF's property name.
        wavelengths: leaves that hold wavelengths and belong to no texture.
        previews: leaves of pictures by their path below the material.
        metadata: leaves of texts in a group of metadata, by their path below it.
        strings: the known strings found: kind of string ("diffuse", "specular", "variant", "fresnel", "filter")
            to (canonical value, leaf).
        own: leaves of our own descriptions by path below `axffit.Material`, by that group's suffix.
        rest: leaves that are none of these.
    """

    group: str
    textures: dict[str, list[Candidate]] = field(default_factory=dict)
    properties: dict[str, list[Leaf]] = field(default_factory=dict)
    strings: dict[str, list[tuple[str, Leaf]]] = field(default_factory=dict)
    wavelengths: list[Leaf] = field(default_factory=list)
    previews: dict[str, Leaf] = field(default_factory=dict)
    metadata: dict[str, Leaf] = field(default_factory=dict)
    own: dict[str, dict[str, Leaf]] = field(default_factory=dict)
    rest: list[Leaf] = field(default_factory=list)

    @classmethod
    def collect(cls, leaves: Iterable[Leaf], group: str) -> "Gathered":
        """Sort the leaves below a material's group."""
        gathered = cls(group)
        siblings: dict[tuple[str, ...], Candidate] = {}
        later = []
        for leaf in leaves:
            inside = leaf.parts[2:]
            described = None
            if len(inside) > 2 and inside[0] == layout.REPRESENTATIONS and not leaf.attribute:
                described = layout.OWN_GROUPS.fullmatch(inside[1])
            if described:
                gathered.own.setdefault(described[1] or "", {})["/".join(inside[2:])] = leaf
            elif not (gathered._preview(leaf) or gathered._texture(leaf, siblings)):
                later.append(leaf)
        for leaf in later:
            if not (
                gathered._sibling(leaf, siblings)
                or gathered._metadata(leaf)
                or gathered._property(leaf)
                or gathered._known_string(leaf)
            ):
                gathered.rest.append(leaf)
        return gathered

    def _preview(self, leaf: Leaf) -> bool:
        path = "/".join(leaf.parts[2:])
        shape = leaf.shape or ()
        pictorial = len(shape) == 2 or (len(shape) == 3 and shape[-1] in (1, 3, 4))
        if leaf.attribute or not (leaf.is_number and pictorial and is_preview(path)):
            return False
        self.previews[path] = leaf
        return True

    def _texture(self, leaf: Leaf, siblings: dict[tuple[str, ...], Candidate]) -> bool:
        if leaf.attribute or not leaf.is_number or leaf.shape == ():
            return False
        resource = leaf.parts[:-1] if fold(leaf.name) == fold(layout.DATA) else leaf.parts
        if len(resource) <= 2:
            return False
        group = resource[-2] if len(resource) > 3 else ""
        key = canonical_texture(resource[-1], group)
        if key is None:
            return False
        candidate = Candidate(key, "/" + "/".join(resource), leaf)
        self.textures.setdefault(key, []).append(candidate)
        siblings[resource] = candidate
        return True

    def _sibling(self, leaf: Leaf, siblings: dict[tuple[str, ...], Candidate]) -> bool:
        candidate = siblings.get(leaf.parts[:-1])
        if candidate is None and leaf.attribute:
            candidate = siblings.get(leaf.parts[:-2])
        if not leaf.is_number:
            return False
        if fold(leaf.name) in _WAVELENGTHS:
            if candidate is None or candidate.wavelengths is not None:
                self.wavelengths.append(leaf)
            else:
                candidate.wavelengths = leaf
            return True
        if candidate is None:
            return False
        own = _RGB.fullmatch(leaf.name)
        if own and not leaf.attribute:
            candidate.rgb[int(own[1] or 0)] = leaf
            return True
        level = _LEVEL.fullmatch(leaf.name)
        if level and not leaf.attribute:
            return candidate.levels.setdefault(int(level[1]), leaf) is leaf
        if fold(leaf.name) == fold(layout.WIDTH) and candidate.width is None:
            candidate.width = leaf
            return True
        if fold(leaf.name) == fold(layout.HEIGHT) and candidate.height is None:
            candidate.height = leaf
            return True
        return False

    def _property(self, leaf: Leaf) -> bool:
        if not leaf.is_number:
            return False
        in_data = fold(leaf.name) == fold(layout.DATA) and not leaf.attribute
        name = canonical_property(leaf.parts[-2] if in_data else leaf.name)
        if name is None:
            return False
        self.properties.setdefault(name, []).append(leaf)
        return True

    def _metadata(self, leaf: Leaf) -> bool:
        places = [k for k, part in enumerate(leaf.parts[:-1]) if k > 1 and fold("metadata") in fold(part)]
        if not places:
            return False
        name = "/".join(leaf.parts[places[0] + 1 :])
        text = leaf.text()
        if text is None or "\0" in text or name in self.metadata:
            return False
        self.metadata[name] = leaf
        return True

    def _known_string(self, leaf: Leaf) -> bool:
        text = leaf.text()
        if text is None or text.strip().lower() not in _KNOWN_STRINGS:
            return False
        kind, value = _KNOWN_STRINGS[text.strip().lower()]
        self.strings.setdefault(kind, []).append((value, leaf))
        return True


_KNOWN_STRINGS: dict[str, tuple[str, str]] = {
    **{key.lower(): ("diffuse", name) for name, key in DIFFUSE_MODELS.items()},
    **{key.lower(): ("specular", name) for name, key in SPECULAR_MODELS.items()},
    **{name.lower(): ("variant", name) for name in SPECULAR_VARIANTS},
    **{name.lower(): ("fresnel", name) for name in FRESNEL_VARIANTS},
    **{key.lower(): ("filter", name) for name, key in FILTERS.items()},
}
