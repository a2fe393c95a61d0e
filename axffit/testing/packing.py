"""What a target makes of a material: whether it is packed as the engine wants it, and comes back."""

from collections.abc import Callable, Iterator
from functools import cache
from types import ModuleType

import numpy as np

from axffit.axf import AxfMaterial
from axffit.axf.validation import problems
from axffit.errors import InputError
from axffit.targets import PackedMaterial

OF_TEXEL, OF_TEXTURE = 2.0**-8, 2.0**-14
"""By which shares of its texel's and of its texture's largest value a second packing may move a value, in sum.

That is four steps of a half and four of a 16-bit integer: targets that convert primaries or restore a normal's third
component compute with rounded values, and may round the other way the second time.
"""


def checks(material: AxfMaterial, target: ModuleType) -> Iterator[tuple[str, Callable[[], None]]]:
    """Name and function of each check; a function raises ``AssertionError`` where the material fails.

    - ``obligations``: what is packed meets every obligation that ``target.validate`` knows.
    - ``unpacks``: what comes back is a valid material.
    - ``stable``: packed and unpacked once more, it has the same textures and properties, and values that moved by
      no more than :data:`OF_TEXEL` and :data:`OF_TEXTURE` allow.
    """

    @cache
    def packed() -> PackedMaterial:
        return _pack(material, target)

    @cache
    def unpacked() -> AxfMaterial:
        return target.unpack(packed())

    def obligations() -> None:
        broken = target.validate(packed())
        assert not broken, f"{len(broken)} obligations broken; {broken[0]}"

    def unpacks() -> None:
        broken = list(problems(unpacked()))
        assert not broken, f"what comes back is no valid material: {broken[0]}"

    def stable() -> None:
        _demand_same(unpacked(), target.unpack(_pack(unpacked(), target)))

    yield from (("obligations", obligations), ("unpacks", unpacks), ("stable", stable))


def _pack(material: AxfMaterial, target: ModuleType) -> PackedMaterial:
    try:
        return target.pack(material)
    except InputError as error:
        raise AssertionError(f"cannot be packed: {error}") from None


def _demand_same(once: AxfMaterial, twice: AxfMaterial) -> None:
    for kind, first, second in (
        ("texture", once.textures, twice.textures),
        ("property", once.properties, twice.properties),
    ):
        changed = sorted(set(first) ^ set(second))
        assert not changed, f"{kind} {changed[0]} is in only one of what was unpacked and what is packed again"
    for key, texture in once.textures.items():
        again = twice.textures[key]
        shapes = [[level.shape for level in each.levels] for each in (texture, again)]
        assert shapes[0] == shapes[1], f"texture {key} has levels of shapes {shapes[0]}, packed again {shapes[1]}"
        for before, after in zip(texture.levels, again.levels, strict=True):
            excess = np.nan_to_num(_moved(before, after) - _allowed(before), nan=np.inf)
            worst = np.unravel_index(np.argmax(excess), excess.shape)
            assert excess[worst] <= 0, (
                f"texture {key} is {before[worst]} at {tuple(map(int, worst))}, packed again {after[worst]}"
            )
    for key, value in once.properties.items():
        again = twice.properties[key]
        assert np.shape(value) == np.shape(again), f"property {key} is {value}, packed again {again}"
        assert np.allclose(value, again, rtol=OF_TEXEL, atol=0), f"property {key} is {value}, packed again {again}"


def _moved(before: np.ndarray, after: np.ndarray) -> np.ndarray:
    a, b = before.astype(np.float64), after.astype(np.float64)
    with np.errstate(invalid="ignore"):
        return np.where((a == b) | (np.isnan(a) & np.isnan(b)), 0.0, np.abs(a - b))


def _allowed(values: np.ndarray) -> np.ndarray:
    size = np.abs(np.nan_to_num(values.astype(np.float64)))
    return OF_TEXEL * size.max(axis=-1, keepdims=True) + OF_TEXTURE * size.max()
