"""What a material's group holds, sorted by name: candidates for textures, properties, known strings, the rest."""

import re
from collections.abc import Iterable
from dataclasses import dataclass, field

from . import layout
from .hdf5 import Leaf
from .names import (
    DIFFUSE_MODELS,
    FILTERS,
    FRESNEL_VARIANTS,
    SPECULAR_MODELS,
    SPECULAR_VARIANTS,
    TEXTURES,
    canonical_property,
    canonical_texture,
    fold,
)

_LEVEL = re.compile(r"(?:level|mip)_?0*([1-9]\d{0,2})", re.IGNORECASE)


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
    """

    key: str
    node: str
    data: Leaf
    levels: dict[int, Leaf] = field(default_factory=dict)
    width: Leaf | None = None
    height: Leaf | None = None

    @property
    def rank_of_choice(self) -> tuple[int, str]:
        """Sorting key: a legal number of channels first, then the name without a representation's suffix."""
        shape = self.data.shape or ()
        legal = bool(shape) and shape[-1] in TEXTURES[self.key].channels
        return (0 if legal else 1, self.node)


@dataclass
class Gathered:
    """The leaves of one material by what they are.

    Attributes:
        group: the name of the material's group.
        textures: candidates by canonical texture name.
        properties: leaves by AxF's property name.
        strings: the known strings found: kind of string ("diffuse", "specular", "variant", "fresnel", "filter")
            to (canonical value, leaf).
        own: leaves of our own description by path below `axffit.Material`.
        rest: leaves that are none of these.
    """

    group: str
    textures: dict[str, list[Candidate]] = field(default_factory=dict)
    properties: dict[str, list[Leaf]] = field(default_factory=dict)
    strings: dict[str, list[tuple[str, Leaf]]] = field(default_factory=dict)
    own: dict[str, Leaf] = field(default_factory=dict)
    rest: list[Leaf] = field(default_factory=list)

    @classmethod
    def collect(cls, leaves: Iterable[Leaf], group: str) -> "Gathered":
        """Sort the leaves below a material's group."""
        gathered = cls(group)
        siblings: dict[tuple[str, ...], Candidate] = {}
        later = []
        for leaf in leaves:
            inside = leaf.parts[2:]
            if inside[:2] == (layout.REPRESENTATIONS, layout.OWN_GROUP):
                gathered.own["/".join(inside[2:])] = leaf
            elif not gathered._texture(leaf, siblings):
                later.append(leaf)
        for leaf in later:
            if not (gathered._sibling(leaf, siblings) or gathered._property(leaf) or gathered._known_string(leaf)):
                gathered.rest.append(leaf)
        return gathered

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
        if candidate is None or not leaf.is_number:
            return False
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
