"""Reading .axf files: tolerant in what is recognized, honest about what is not.

No public specification says how AxF spells everything, so textures, values and model names are found by name
anywhere under a material. What had to be concluded is listed in `AxfMaterial.inferred`, every node that was not
used in `AxfMaterial.unrecognized` and `AxfFile.unrecognized`. These nodes themselves are kept as `extras`, and the
writer puts them back.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ..errors import InputError
from . import layout
from .described import described_material
from .extras import AxfExtra
from .gather import Gathered
from .hdf5 import MAXIMUM_KEPT, Leaf, Tree, Unread, one_line, opened, walk
from .infer import inferred_material
from .material import AxfFile, AxfMaterial
from .names import TEXTURES, fold
from .validation import check


def read(path: str | Path, *, validate: bool = True, guarded: bool = True) -> AxfFile:
    """Read an .axf file.

    Args:
        path: the file.
        validate: refuse values outside their legal range; False reads a file in order to show what is wrong with it.
        guarded: read the file in another process first, which libhdf5 may crash in place of this one (`guard`); False
            is for files one trusts.

    Raises:
        InputError: the file is missing, no AxF, damaged, reaches outside itself, declares more than can be read,
            or (with `validate`) a material breaks a rule of `validation`. The message names file and node.
    """
    with opened(path, guarded=guarded) as file:
        try:
            return _read(walk(file), str(path), validate=validate)
        except InputError as error:
            raise InputError(f"{path}: {error}") from error


def _read(tree: Tree, source: str, *, validate: bool) -> AxfFile:
    root = {leaf.name: leaf for leaf in tree.leaves if leaf.attribute and len(leaf.parts) == 1}
    own = layout.OWN_VERSION in root
    inferred = []
    version = _version(root)
    if version is None:
        version = (0, 0, 0)
        inferred.append("no AxF version in the root attributes: taken as 0.0.0")
    materials: list[tuple[int, AxfMaterial]] = []
    leaves: dict[tuple[str, ...], list[Leaf]] = {
        group: [] for group in tree.groups if len(group) == 2 and fold(group[0]) == fold(layout.MATERIALS)
    }
    if not leaves:
        raise InputError(f"no material; an AxF file has a group /{layout.MATERIALS}/<material id>")
    unread: dict[tuple[str, ...], list[Unread]] = {group: [] for group in leaves}
    elsewhere: list[Leaf | Unread] = []
    for leaf in tree.leaves:
        if not (leaf.attribute and leaf.parts in _ROOT):
            # An attribute of the group of all materials may be called as a material is.
            inside = not (leaf.attribute and len(leaf.parts) == 2)
            (leaves.get(leaf.parts[:2], elsewhere) if inside else elsewhere).append(leaf)
    for node in tree.unread:
        inside = not (node.attribute and len(node.parts) == 2)
        (unread.get(node.parts[:2], elsewhere) if inside else elsewhere).append(node)
    keeper = _Keeper(MAXIMUM_KEPT)
    for group in leaves:
        index, material = _material(Gathered.collect(leaves[group], group[-1]), unread[group], keeper, own=own)
        if validate:
            check(material)
        materials.append((index, material))
    materials.sort(key=lambda entry: entry[0])
    if len({material.id for _, material in materials}) < len(materials):
        raise InputError("two materials share an id; give each its own")
    extras, lines = keeper.keep(elsewhere, 0)
    return AxfFile(
        tuple(material for _, material in materials),
        version=version,
        unrecognized=lines,
        inferred=tuple(inferred),
        source=source,
        extras=extras,
    )


def _material(gathered: Gathered, unread: list[Unread], keeper: "_Keeper", *, own: bool) -> tuple[int, AxfMaterial]:
    rest: list[Leaf] = []
    index = 0
    if own and gathered.own:
        index, material = described_material(gathered, rest)
    else:
        material = inferred_material(gathered, rest)
        metadata = {path: leaf.text() or "" for path, leaf in gathered.metadata.items()}
        material = replace(material, metadata=metadata)
    # An empty group where AxF has groups says nothing; whoever writes the material makes it again.
    said = [node for node in unread if not (node.is_empty_group and layout.is_container(node.parts[2:], _NODES))]
    extras, lines = keeper.keep([*rest, *said], 2)
    previews = {path: leaf.array() for path, leaf in gathered.previews.items()}
    return index, replace(material, previews=previews, extras=extras, unrecognized=lines)


@dataclass
class _Keeper:
    """Takes what was not used as it is, up to ``room`` bytes of a file."""

    room: int

    def keep(self, nodes: Sequence[Leaf | Unread], above: int) -> tuple[tuple[AxfExtra, ...], tuple[str, ...]]:
        """The nodes below the first ``above`` names, and a line on each; one that cannot be kept says why."""
        extras, lines = [], []
        for node in nodes:
            reason = ""
            if node.size > self.room:
                reason = f" (not kept: {node.size / 2**20:.0f} MiB)"
            else:
                try:
                    extra = node.keep()
                except (OSError, RuntimeError, ValueError, KeyError, TypeError, MemoryError) as error:
                    reason = f" (not kept: {one_line(error)})"
                else:
                    extras.append(extra.beside(extra.parts[above:]))
                    self.room -= node.size
            lines.append(node.line + reason)
        return tuple(extras), tuple(lines)


_NODES = tuple(texture.node for texture in TEXTURES.values())
_ROOT = {(name,) for name in (*layout.VERSION_ATTRIBUTES, layout.OWN_VERSION, layout.OWN_LAYOUT)}


def _version(root: dict[str, Leaf]) -> tuple[int, int, int] | None:
    numbers = []
    for name in layout.VERSION_ATTRIBUTES:
        leaf = root.get(name)
        if leaf is None or not leaf.is_number:
            return None
        number = np.asarray(leaf.array()).reshape(-1)[0]
        if not 0 <= number < 2**32 or number != np.trunc(number):
            raise InputError(f"{leaf.path} is {number}; an AxF version is a whole number below 2^32")
        numbers.append(int(number))
    return numbers[0], numbers[1], numbers[2]
