"""Maps of a whole stack, chunk by chunk, so that a run killed at any moment goes on where it was.

The work folder holds ``manifest.json`` (everything that the result depends on), ``pixels.f32`` (the stack, one plane an
image and channel) and ``chunk_00000.npy`` ... (finished texels). Each is written under another name and renamed, so it
is there whole or not at all. A chunk depends on nothing but its own pixels: the maps of a run that was killed are those
of one that was not, bit for bit. A folder of other inputs, options or versions is refused.
"""

import json
import os
import platform
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import numpy as np
from jaxtyping import Float, Int

import axffit
from axffit.errors import InputError
from axffit.fitting.texels.batch import LANES
from axffit.fitting.texels.maps import Map, layout
from axffit.fitting.texels.noise import Noise
from axffit.fitting.texels.problem import TexelModel
from axffit.fitting.texels.reweighted import FittedTexels, fit_pixels
from axffit.fitting.texels.stack import Stack

CHUNK = 4096
"""Texels of a chunk file: 100 MB in flight with 64 images of three channels."""

Progress = Callable[[str, float], None]


class StackMaps(NamedTuple):
    """Maps of a surface: as :class:`axffit.fitting.texels.reweighted.FittedTexels`, with axes (height, width, ...)."""

    values: dict[str, Float[np.ndarray, "height width channels"]]
    errors: dict[str, Float[np.ndarray, "height width channels"]]
    chi_square: Float[np.ndarray, "height width"]
    outcome: Int[np.ndarray, "height width"]


def fit_stack(
    stack: Stack,
    model: TexelModel,
    noise: Noise,
    work: Path,
    *,
    chunk: int = CHUNK,
    lanes: int = LANES,
    progress: Progress | None = None,
) -> StackMaps:
    """The maps of a stack of images.

    Args:
        stack: images and directions.
        model: what is fitted.
        noise: of the pixels.
        work: folder of the intermediate files, made if need be; an interrupted run's folder is taken up.
        chunk: texels a chunk file.
        lanes: texels in flight at once.
        progress: called with what is being done and how much of it is (0 to 1).

    Raises:
        InputError: images that cannot be used, too few of them, or a folder of another run.
    """
    tell = progress or (lambda _stage, _share: None)
    shape = stack.image(0).shape
    height, width, channels = shape
    samples, needed = len(stack.files) * channels, model.parameters(channels)
    if samples <= needed:
        raise InputError(
            f"{stack.source}: {len(stack.files)} images of {channels} channels for {needed} parameters a texel; "
            "give more images or a smaller model"
        )
    work.mkdir(parents=True, exist_ok=True)
    _agree(work / "manifest.json", _manifest(stack, model, noise, shape, chunk, lanes))
    pixels = _staged(work / "pixels.f32", stack, shape, tell)
    texels = height * width
    rows = []
    for number, first in enumerate(range(0, texels, chunk)):
        tell("fitting the texels", first / texels)
        path = work / f"chunk_{number:05d}.npy"
        count = min(chunk, texels - first)
        rows.append(_chunk(path, stack, model, pixels[:, :, first : first + count], noise, lanes))
    return _assembled(np.concatenate(rows, axis=1), layout(model, channels), (height, width))


def _manifest(
    stack: Stack, model: TexelModel, noise: Noise, shape: tuple[int, ...], chunk: int, lanes: int
) -> dict[str, Any]:
    """Everything that the maps' bits depend on."""
    libraries = {name: version(name) for name in ("jax", "jaxlib", "numpy", "optimistix")}
    return {
        "inputs": stack.fingerprints(),
        "model": asdict(model),
        "noise": asdict(noise),
        "shape": list(shape),
        "chunk": chunk,
        "lanes": lanes,
        "versions": {"axffit": axffit.__version__, **libraries, "machine": platform.machine()},
    }


def _agree(path: Path, manifest: dict[str, Any]) -> None:
    """Write the manifest, or refuse a folder that has another."""
    if not path.exists():
        with _whole(path) as file:
            file.write(json.dumps(manifest, indent=1).encode())
        return
    try:
        held = json.loads(path.read_text(encoding="utf-8"))
        different = [key for key in manifest if held.get(key) != manifest[key]]
    except (ValueError, AttributeError) as error:
        raise InputError(f"{path}: is no manifest of a run ({error}); choose another work folder") from error
    if different:
        raise InputError(
            f"{path.parent}: holds a run with other {', '.join(different)}; give the same ones to go on with it, or "
            "another work folder"
        )


@contextmanager
def _whole(path: Path) -> Iterator[BinaryIO]:
    """A file that appears under its name when it is complete."""
    temporary = path.with_name(f".{path.name}.part")
    with temporary.open("wb") as file:
        yield file
        file.flush()
        os.fsync(file.fileno())
    os.replace(temporary, path)


def _staged(path: Path, stack: Stack, shape: tuple[int, ...], tell: Progress) -> np.memmap:
    """The stack as (channels, n, texels), one image in memory at a time."""
    height, width, channels = shape
    planes = (len(stack.files), channels, height * width)
    if not path.exists():
        with _whole(path) as file:
            for index, name in enumerate(stack.files):
                tell("reading the images", index / len(stack.files))
                image = stack.image(index)
                if image.shape != shape:
                    raise InputError(f"{name}: is {image.shape}, the first image {shape}; give images of one size")
                file.write(np.ascontiguousarray(np.moveaxis(image, -1, 0)).tobytes())
    return np.moveaxis(np.memmap(path, np.float32, "r", shape=planes), 1, 0)


def _chunk(
    path: Path, stack: Stack, model: TexelModel, pixels: Float[np.ndarray, "c n texels"], noise: Noise, lanes: int
) -> Float[np.ndarray, "rows texels"]:
    """A chunk's rows from its file, or fitted and written to it."""
    if not path.exists():
        rows = _rows(fit_pixels(model, stack.wi, stack.wo, np.asarray(pixels, np.float64), noise, lanes))
        with _whole(path) as file:
            np.save(file, rows)
    return np.load(path)


def _rows(fitted: FittedTexels) -> Float[np.ndarray, "rows texels"]:
    """All maps of some texels in one array: values and errors of each, chi-square, outcome."""
    parts = [part for map_ in fitted.maps.values() for part in map_]
    return np.concatenate([*parts, fitted.chi_square[None], fitted.outcome[None].astype(np.float64)])


def _assembled(rows: Float[np.ndarray, "rows texels"], channels: Any, shape: tuple[int, int]) -> StackMaps:
    maps, at = {}, 0
    for name, count in channels.items():
        maps[name] = Map(rows[at : at + count], rows[at + count : at + 2 * count])
        at += 2 * count

    def surface(array: np.ndarray) -> np.ndarray:
        return array.T.reshape(*shape, -1)

    return StackMaps(
        {name: surface(map_.values) for name, map_ in maps.items()},
        {name: surface(map_.errors) for name, map_ in maps.items()},
        rows[at].reshape(shape),
        rows[at + 1].astype(np.int8).reshape(shape),
    )
