"""Reading .axf files: tolerant in what is recognized, honest about what is not.

No public specification says how AxF spells everything, so textures, values and model names are found by name
anywhere under a material. What had to be concluded is listed in `AxfMaterial.inferred`, every node that was not
used in `AxfMaterial.unrecognized` and `AxfFile.unrecognized`.
"""

from pathlib import Path

import numpy as np

from ..errors import InputError
from . import layout
from .gather import Gathered
from .hdf5 import Leaf, Tree, opened, printable, walk
from .infer import interpret
from .material import AxfFile, AxfMaterial
from .names import fold
from .validation import check


def read(path: str | Path, *, validate: bool = True) -> AxfFile:
    """Read an .axf file.

    Args:
        path: the file.
        validate: refuse values outside their legal range; False reads a file in order to show what is wrong with it.

    Raises:
        InputError: the file is missing, no AxF, damaged, reaches outside itself, declares more than can be read,
            or (with `validate`) a material breaks a rule of `validation`. The message names file and node.
    """
    with opened(path) as file:
        try:
            return _read(walk(file), str(path), validate=validate)
        except InputError as error:
            raise InputError(f"{path}: {error}") from error


def _read(tree: Tree, source: str, *, validate: bool) -> AxfFile:
    root = {leaf.name: leaf for leaf in tree.leaves if leaf.attribute and len(leaf.parts) == 1}
    own = layout.OWN_VERSION in root
    used = {leaf.path for name, leaf in root.items() if name in _ROOT_NAMES}
    inferred = []
    version = _version(root)
    if version is None:
        version = (0, 0, 0)
        inferred.append("no AxF version in the root attributes: taken as 0.0.0")
    materials: list[tuple[int, AxfMaterial]] = []
    ids = [group[-1] for group in tree.groups if len(group) == 2 and fold(group[0]) == fold(layout.MATERIALS)]
    if not ids:
        raise InputError(f"no material; an AxF file has a group /{layout.MATERIALS}/<material id>")
    claimed: set[str] = set()
    for name in ids:
        below = [leaf for leaf in tree.leaves if _is_below(leaf.parts, name)]
        claimed.update(leaf.path for leaf in below)
        gathered = Gathered.collect(below, name)
        index, material = interpret(gathered, _links(tree, name), own=own)
        if validate:
            check(material)
        materials.append((index, material))
    used |= claimed
    outside = [leaf.path for leaf in tree.leaves if leaf.path not in used]
    outside += [link for link in tree.links if not any(link.startswith(_prefix(name)) for name in ids)]
    materials.sort(key=lambda entry: entry[0])
    return AxfFile(
        tuple(material for _, material in materials),
        version=version,
        unrecognized=tuple(outside),
        inferred=tuple(inferred),
        source=source,
    )


_ROOT_NAMES = (*layout.VERSION_ATTRIBUTES, layout.OWN_VERSION, layout.OWN_LAYOUT)


def _version(root: dict[str, Leaf]) -> tuple[int, int, int] | None:
    numbers = []
    for name in layout.VERSION_ATTRIBUTES:
        leaf = root.get(name)
        if leaf is None or not leaf.is_number:
            return None
        number = np.asarray(leaf.array()).reshape(-1)[0]
        if not np.isfinite(number):
            raise InputError(f"{leaf.path} is {number}; an AxF version is a whole number")
        numbers.append(int(number))
    return numbers[0], numbers[1], numbers[2]


def _is_below(parts: tuple[str, ...], material: str) -> bool:
    return len(parts) > 2 and fold(parts[0]) == fold(layout.MATERIALS) and parts[1] == material


def _prefix(material: str) -> str:
    return printable(f"/{layout.MATERIALS}/{material}/")


def _links(tree: Tree, material: str) -> list[str]:
    return [link for link in tree.links if link.startswith(_prefix(material))]
