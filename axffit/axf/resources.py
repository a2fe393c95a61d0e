"""From the leaves of one resource to a texture: levels, sizes, spectra."""

from dataclasses import replace

import numpy as np

from .. import spectrum
from ..errors import InputError
from . import layout
from .gather import Candidate
from .hdf5 import Leaf
from .material import AxfTexture


def texture_of(candidate: Candidate, elsewhere: list[Leaf], rest: list[Leaf], inferred: list[str]) -> AxfTexture:
    """The texture of a resource in a file that axffit did not write.

    Args:
        candidate: the resource.
        elsewhere: leaves of the material that hold wavelengths and belong to no resource.
        rest: takes the leaves that were not used; of `elsewhere` none.
        inferred: takes what had to be concluded.

    Raises:
        InputError: a size is not one finite number.
    """
    levels = tuple(_level(leaf, inferred) for leaf in _levels(candidate.data, candidate.levels, rest))
    width, height = _sizes(candidate, levels[0], inferred)
    rest += candidate.rgb.values()
    if not candidate.is_spectrum:
        rest += [] if candidate.wavelengths is None else [candidate.wavelengths]
        return AxfTexture(levels, width, height, candidate.node)
    known = _wavelengths(candidate, elsewhere, levels[0].shape[-1], rest, inferred)
    return _converted(AxfTexture((), width, height, candidate.node, levels, known), inferred)


def own_texture(candidate: Candidate, rest: list[Leaf], inferred: list[str]) -> AxfTexture:
    """The texture of a resource as axffit writes it; only a spectrum without its RGB leaves something to conclude.

    Raises:
        InputError: a size or the wavelengths are wrong.
    """
    stored = tuple(_level(leaf, inferred) for leaf in _levels(candidate.data, candidate.levels, rest))
    width, height = _sizes(candidate, stored[0], inferred)
    if not candidate.is_spectrum:
        rest += [*candidate.rgb.values(), *([] if candidate.wavelengths is None else [candidate.wavelengths])]
        return AxfTexture(stored, width, height, candidate.node)
    wavelengths = None if candidate.wavelengths is None else candidate.wavelengths.array().astype(np.float64)
    if 0 in candidate.rgb:
        further = {number: leaf for number, leaf in candidate.rgb.items() if number}
        levels = tuple(_level(leaf, inferred) for leaf in _levels(candidate.rgb[0], further, rest))
        return AxfTexture(levels, width, height, candidate.node, stored, wavelengths)
    rest += candidate.rgb.values()
    return _converted(AxfTexture((), width, height, candidate.node, stored, wavelengths), inferred)


def _converted(texture: AxfTexture, inferred: list[str]) -> AxfTexture:
    """The spectral texture with its RGB, or with the reason why it has none."""
    reason = (
        f"the file gives no wavelengths for its {texture.spectra[0].shape[-1]} channels; "
        f"put a list {layout.WAVELENGTHS} beside its {layout.DATA}"
    )
    if texture.wavelengths is not None:
        try:
            levels = tuple(spectrum.to_rgb(level, texture.wavelengths) for level in texture.spectra)
        except InputError as error:
            reason = str(error)
        else:
            inferred.append(f"{texture.source} is a spectrum: converted to linear RGB under illuminant E")
            return replace(texture, levels=levels)
    inferred.append(f"{texture.source} is a spectrum and was not converted: {reason}")
    return replace(texture, unconverted=reason)


def single(leaf: Leaf) -> float:
    """The one finite number that a leaf holds, as float32.

    Raises:
        InputError: it holds something else.
    """
    array = leaf.array()
    if array.size != 1 or not np.isfinite(array).all():
        raise InputError(f"{leaf.path} is {array.reshape(-1)[:4].tolist()}; it must be one finite number")
    with np.errstate(over="ignore"):
        return float(np.float32(array.reshape(-1)[0]))


def _levels(first: Leaf, others: dict[int, Leaf], rest: list[Leaf]) -> list[Leaf]:
    """Level 0 and those that follow without a gap."""
    leaves = [first]
    for number in sorted(others):
        if number == len(leaves):
            leaves.append(others[number])
        else:
            rest.append(others[number])
    return leaves


def _level(leaf: Leaf, inferred: list[str]) -> np.ndarray:
    array = leaf.array()
    if array.dtype == np.float64:
        inferred.append(f"{leaf.path} holds float64: rounded to AxF's float32")
        with np.errstate(over="ignore"):
            array = array.astype(np.float32)
    # A uniform value may be stored as the bare list of its channels.
    return array.reshape(1, 1, -1) if array.ndim == 1 else array


def _sizes(candidate: Candidate, finest: np.ndarray, inferred: list[str]) -> tuple[float, float]:
    sizes = []
    for leaf, axis, name in ((candidate.width, -2, layout.WIDTH), (candidate.height, -3, layout.HEIGHT)):
        if leaf is not None:
            sizes.append(single(leaf))
        elif candidate.key == "brdfcolors" or finest.ndim < 3 or finest.shape[axis] == 1:
            sizes.append(0.0)
        else:
            sizes.append(float(finest.shape[axis]))
            inferred.append(f"{candidate.node} has no {name}: taken as 1 mm a texel")
    return sizes[0], sizes[1]


def _wavelengths(
    candidate: Candidate, elsewhere: list[Leaf], channels: int, rest: list[Leaf], inferred: list[str]
) -> np.ndarray | None:
    """Wavelengths in nm: of the resource, else of the material, else what 31 channels imply."""
    beside = [] if candidate.wavelengths is None else [candidate.wavelengths]
    for leaf in (*beside, *elsewhere):
        values = leaf.array()
        known = spectrum.in_nanometers(values) if values.size == channels else None
        if known is not None:
            if leaf not in beside:
                inferred.append(f"{candidate.node}: wavelengths of {leaf.path}")
            if not np.array_equal(known, values.reshape(-1)):
                inferred.append(f"{leaf.path} in nanometers: by the size of its numbers")
            return known
    rest += beside
    guess = spectrum.default_wavelengths(channels)
    if guess is not None:
        inferred.append(f"{candidate.node}: 31 channels without wavelengths: taken as 400-700 nm by 10 nm")
    return guess
