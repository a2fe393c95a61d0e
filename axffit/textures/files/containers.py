"""The image files by name, which of them suits a texture, and textures that take several files."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import InputError
from ..formats import format_named
from . import dds, exr, ktx2, png
from .image import TextureImage

AUTO = "auto"


@dataclass(frozen=True)
class Container:
    """One kind of image file.

    Attributes:
        name: as the command line has it.
        suffix: of its files.
        whole: whether one file holds all levels and slices.
        halving: whether each mip level must have half the texels of the one before along each side.
        holds: whether it stores the codes of a number format, by name.
        write: writes an image to a path.
        read: reads an image of a format (None: the file's own) from a path.
    """

    name: str
    suffix: str
    whole: bool
    halving: bool
    holds: Callable[[str], bool]
    write: Callable[[Path, TextureImage], None]
    read: Callable[[Path, str | None], TextureImage]

    def suits(self, image: TextureImage) -> bool:
        """Whether it can store the image."""
        return self.holds(image.format) and (image.halves or not self.halving)


def _container(
    name: str, module: Any, holds: Callable[[str], bool], *, whole: bool = True, halving: bool = False
) -> Container:
    return Container(name, module.SUFFIX, whole, halving, holds, module.write, module.read)


CONTAINERS: Mapping[str, Container] = {
    entry.name: entry
    for entry in (
        _container("exr", exr, exr.holds),
        _container("png", png, png.holds, whole=False),
        _container("dds", dds, dds.DXGI_FORMATS.__contains__, halving=True),
        _container("ktx2", ktx2, ktx2.VULKAN_FORMATS.__contains__, halving=True),
    )
}
"""Every kind of image file by name."""


@dataclass(frozen=True)
class StoredFile:
    """One file of a texture.

    Attributes:
        file: its name.
        level: the mip level it holds, or None for all.
        slice: the slice it holds, or None for all.
    """

    file: str
    level: int | None = None
    slice: int | None = None


def container_for(image: TextureImage, name: str = AUTO) -> Container:
    """The kind of file of that name, or for ``auto`` the usual one.

    Plain images go where people look at them: floats to EXR, UNORM and integers of 8 or 16 bits to PNG. Arrays and mip
    levels go to DDS; where DDS has no code, or levels do not halve, to PNG files of one level and slice each, to KTX2,
    or to EXR, whichever holds them.

    Raises:
        InputError: there is no such kind, or it cannot store the image; the message names those that can.
    """
    if name != AUTO and name not in CONTAINERS:
        raise InputError(f"unknown image format {name!r}; allowed: {AUTO}, {', '.join(CONTAINERS)}")
    plain = not image.is_array and len(image.levels) == 1
    floats_or_codes = ("exr", "png") if image.number_format.is_float else ("png", "exr")
    order = (*floats_or_codes, "dds", "ktx2") if plain else ("dds", "png", "ktx2", "exr")
    able = [kind for kind in order if CONTAINERS[kind].suits(image)]
    if not able or name not in (AUTO, *able):
        shapes = ", ".join("x".join(map(str, level.shape[:-1])) for level in image.levels)
        raise InputError(
            f"{image.format} of {shapes} texels cannot be stored as {name}; "
            + (f"choose {AUTO} or {', '.join(able)}" if able else "no image format holds it")
        )
    return CONTAINERS[able[0] if name == AUTO else name]


def save(folder: Path, stem: str, image: TextureImage, container: Container) -> tuple[StoredFile, ...]:
    """Write a texture into a folder, as one file or one for each level and slice.

    Raises:
        InputError: the container cannot store it.
        OSError: the disk; it names the file.
    """
    plain = not image.is_array and len(image.levels) == 1
    if container.whole or plain:
        stored = StoredFile(stem + container.suffix)
        _write(container, folder / stored.file, image)
        return (stored,)
    files = []
    for level in range(len(image.levels)):
        for index in range(image.slices):
            name = f"{stem}.level{level}" + (f".slice{index}" if image.is_array else "") + container.suffix
            files.append(StoredFile(name, level, index if image.is_array else None))
            _write(container, folder / name, TextureImage(image.format, (image.slice(level, index),)))
    return tuple(files)


def _write(container: Container, path: Path, image: TextureImage) -> None:
    try:
        container.write(path, image)
    except OSError as error:
        # A full disk is reported without the file's name.
        raise OSError(error.errno, error.strerror, str(path)) from error


def load(
    folder: Path, files: Sequence[StoredFile], container: Container, format: str, shapes: Sequence[tuple[int, ...]]
) -> TextureImage:
    """Read a texture of a known format and shape back from its files.

    Args:
        folder: where the files are.
        files: as `save` returned them.
        container: their kind.
        format: its number format.
        shapes: [H, W] or [D, H, W] of each level.

    Raises:
        InputError: a file is missing, damaged, or does not hold what it should.
    """
    expected = [(*shape, format_named(format).channels) for shape in shapes]
    if len(files) == 1 and files[0].level is None:
        path = folder / files[0].file
        levels = list(container.read(path, format).levels)
        if len(levels) == len(shapes):
            # A DDS array of one slice comes back as a plain image.
            levels = [
                codes[np.newaxis] if (1, *codes.shape) == shape else codes
                for codes, shape in zip(levels, expected, strict=True)
            ]
        if [codes.shape for codes in levels] != expected:
            found = ", ".join("x".join(map(str, codes.shape[:-1])) for codes in levels)
            raise InputError(f"{path}: holds {found} texels; expected {_listed(shapes)}")
        return TextureImage(format, tuple(levels))
    by_place = {(stored.level, stored.slice): folder / stored.file for stored in files}
    loaded = []
    for level, shape in enumerate(expected):
        places = [(level, index) for index in range(shape[0])] if len(shape) == 4 else [(level, None)]
        slices = []
        for place in places:
            if place not in by_place:
                raise InputError(
                    f"{folder}: no file is named for level {place[0]}, slice {place[1]} of {_listed(shapes)}"
                )
            image = container.read(by_place[place], format)
            if len(image.levels) != 1 or image.levels[0].shape != shape[-3:]:
                found = "x".join(map(str, image.levels[0].shape[:-1]))
                raise InputError(f"{by_place[place]}: holds {found} texels; expected {_listed([shape[-3:-1]])}")
            slices.append(image.levels[0])
        loaded.append(np.stack(slices) if len(shape) == 4 else slices[0])
    return TextureImage(format, tuple(loaded))


def _listed(shapes: Sequence[tuple[int, ...]]) -> str:
    return ", ".join("x".join(map(str, shape)) for shape in shapes)
