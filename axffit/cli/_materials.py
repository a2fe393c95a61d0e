"""Which materials a verb works on: files and folders of files, and the packed folders that belong to them."""

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from axffit.errors import InputError

if TYPE_CHECKING:
    from axffit.axf import AxfFile

SUFFIX = ".axf"


class Wanted(NamedTuple):
    """A material to be judged.

    Attributes:
        file: the .axf file.
        index: its place in the file.
        id: its id.
        packed: the folder of textures another program packed, or None.
    """

    file: Path
    index: int
    id: str
    packed: Path | None = None


def axf_files(given: Sequence[Path]) -> list[Path]:
    """The files, and for a folder every .axf file below it, sorted; each once, whatever names it twice.

    Raises:
        InputError: a folder holds none.
    """
    found: dict[Path, Path] = {}
    for path in given:
        for file in _below(path) if path.is_dir() else [path]:
            found.setdefault(file.resolve(), file)
    return list(found.values())


def _below(folder: Path) -> list[Path]:
    files = [
        Path(place) / name
        for place, _, names in os.walk(folder)
        for name in names
        if name.lower().endswith(SUFFIX) and not name.startswith(".")
    ]
    if not files:
        raise InputError(f"{folder}: holds no {SUFFIX} file; name a file, or a folder with some below it")
    return sorted(files)


def wanted_materials(
    files: Sequence[Path], read: "Callable[[Path], AxfFile]", material: str | None, packed: Path | None
) -> list[Wanted]:
    """Every material of every file, or the one of that id of each; with its packed folder where ``packed`` is given.

    Raises:
        InputError: a file cannot be read, has no such material, or none at all; a material has no packed folder.
    """
    wanted = []
    for path in files:
        file = read(path)
        if material is not None or not file.materials:
            file.material(material)  # says that there is none
        ids = [entry.id for entry in file.materials]
        wanted += [Wanted(path, index, id) for index, id in enumerate(ids) if material in (None, id)]
    return wanted if packed is None else _with_packed(wanted, packed, named=material is not None)


def _with_packed(wanted: Sequence[Wanted], folder: Path, *, named: bool) -> list[Wanted]:
    """Each material with the sub-folder of its id; a material named with --material takes the only folder there is."""
    from axffit.targets.folder import material_folders
    from axffit.targets.folder_json import FILE
    from axffit.targets.folder_parse import parse

    by_id: dict[str, Path] = {}
    for path in material_folders(folder):
        id = parse(path / FILE).fields["id"]
        if id in by_id:
            raise InputError(f"{folder}: {by_id[id].name} and {path.name} both hold {id!r}; name one of them")
        by_id[id] = path
    if named and len(wanted) == 1 and len(by_id) == 1:
        return [wanted[0]._replace(packed=next(iter(by_id.values())))]
    for entry in wanted:
        if entry.id not in by_id:
            raise InputError(
                f"{folder}: holds no material {entry.id!r} of {entry.file}; it holds "
                f"{', '.join(map(repr, by_id))}; choose with --material"
            )
    return [entry._replace(packed=by_id[entry.id]) for entry in wanted]
