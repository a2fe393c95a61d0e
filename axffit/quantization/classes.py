"""Texel classes: every texel of a material, in every color channel, lies in one of at most a few thousand boxes.

A box holds ranges of what a BRDF bound depends on: the parameters before packing and their errors
(`bounds.TexelClass`). Texels are sorted into cells of a grid over the parameters before packing; the box of a cell is
the smallest one that holds what fell into it, so that a bound of the box holds for each of its texels. Where more than
`MOST` cells fill, the grid is made coarser along the axis with the most different values and boxes are merged: memory
does not depend on the size of the material.

The BRDF errors do not change when both BRDFs are multiplied by the same number, so colors are taken relative to the
specular color where there is one.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from ..axf import AxfMaterial, MaterialKind
from ..axf.appearance import car_paint_ior, model_parameters
from ..axf.maps import gather, grid_shape, texel_centers
from ..targets import PackedMaterial, target_named
from .bounds import NoBound, TexelClass
from .brdf_error import without_negative_colors
from .tiles import centers, of_packed_texels, of_texels
from .turns import angle, frames_of, polar, roomy, swing_and_twist, unit

MOST = 2000
"""Classes of a material at most."""

RUN = 2**14
"""Texels looked at together: about 30 MiB."""

ANGLES = ("tilt", "twist", "coat_tilt")
RANGES = (
    "roughness", "roughness_ratio", "roughness_y", "roughness_y_ratio", "f0", "f0_change", "specular", "specular_ratio",
    "diffuse", "diffuse_ratio", "gap", "gap_azimuth", "ior", "ior_change",
)  # fmt: skip
COLUMNS = (*ANGLES, *RANGES)
"""Sides of a box, by the names of `TexelClass`; angles begin at 0."""

_BITS = 9
"""Of a cell's number along one axis."""

_AXES: Mapping[str, Callable[[np.ndarray], np.ndarray]] = {
    "roughness": lambda x: np.log2(x) / np.log2(1.05) + 200,
    "roughness_y": lambda x: np.log2(x) / np.log2(1.05) + 200,
    "f0": lambda x: np.log2(np.maximum(x, 0.0) + 0.01) / 0.15 + 60,
    "diffuse": lambda x: 2.0 * np.log2(x + 2.0**-10) + 40,
    "gap": lambda x: np.degrees(x) / 0.25,
    "gap_azimuth": lambda x: np.degrees(x) / 10.0 + 40,
    "ior": lambda x: 100.0 * (x - 1.0),
}
"""The grid: 5 % in roughness, 0.15 octaves in F0, half an octave in diffuse over specular, 0.25° between normals."""


@dataclass(frozen=True, eq=False)
class Items:
    """Texels in one channel each, as boxes: smallest and largest values (n, columns)."""

    low: np.ndarray
    high: np.ndarray

    def cells(self) -> np.ndarray:
        """Numbers of the finest cells along each axis (n, axes); far ends of an axis share its last cell."""
        numbers = [_AXES[name](self.low[:, COLUMNS.index(name)]) for name in _AXES]
        return np.clip(np.nan_to_num(np.stack(numbers, axis=-1)), 0, 2**_BITS - 1).astype(np.int64)


@dataclass(frozen=True, eq=False)
class ClassTable:
    """The classes of a material.

    Attributes:
        keys: the cells, rising (K,).
        shifts: how often each axis of the grid was halved.
        low: smallest values (K, columns).
        high: largest values (K, columns).
        items: texels of each class, a texel's three channels counted apart where its classes differ by channel (K,).
        anisotropic: whether lobes have two roughnesses.
    """

    keys: np.ndarray
    shifts: tuple[int, ...]
    low: np.ndarray
    high: np.ndarray
    items: np.ndarray
    anisotropic: bool

    def __len__(self) -> int:
        return len(self.keys)

    def index_of(self, items: Items) -> np.ndarray:
        """The class of each item (n,); -1 for what lies in no cell of the table."""
        keys = _keys(items.cells(), self.shifts)
        at = np.minimum(np.searchsorted(self.keys, keys), len(self.keys) - 1)
        return np.where(self.keys[at] == keys, at, -1)

    def merged(self, chosen: np.ndarray) -> TexelClass:
        """The smallest class that holds some of the classes, chosen by index.

        Raises:
            NoBound: it lies outside what a bound covers.
        """
        low, high = self.low[chosen].min(axis=0), self.high[chosen].max(axis=0)
        if not (np.isfinite(low).all() and np.isfinite(high).all()):
            name = COLUMNS[int(np.argmin(np.isfinite(low) & np.isfinite(high)))]
            raise NoBound(f"{name}: changes beyond what a ratio or a difference describes")
        values: dict = {name: float(high[k]) for k, name in enumerate(COLUMNS) if name in ANGLES}
        values |= {name: (float(low[k]), float(high[k])) for k, name in enumerate(COLUMNS) if name in RANGES}
        if not self.anisotropic:
            values["roughness_y"] = None
        try:
            return TexelClass(**values)
        except ValueError as error:
            raise NoBound(str(error)) from error

    def halves(self, chosen: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
        """Some classes in two parts, across the axis of the grid along which they are spread the most."""
        shifts = np.asarray(self.shifts)
        bins = (self.keys[chosen, None] >> (_BITS * np.arange(len(_AXES)))) % 2**_BITS << shifts
        least, most = bins.min(axis=0), bins.max(axis=0)
        axis = int(np.argmax(most - least))
        if most[axis] == least[axis]:
            return None
        upper = bins[:, axis] > (least[axis] + most[axis]) // 2
        return chosen[~upper], chosen[upper]


def class_table(
    material: AxfMaterial, packed: PackedMaterial, progress: Callable[[float], None] = lambda fraction: None
) -> ClassTable:
    """The classes of all texels of a material, run by run.

    Args:
        material: the original; its negative colors count as 0.
        packed: the packed material, with the names and values of the target that reads it.
        progress: called with the part that is done.

    Raises:
        InputError: the packed material cannot be read.
        NoBound: lobes that are isotropic before and not after.
    """
    height, width = grid_shape(material)
    merged = _Merged(np.zeros(0, np.int64), np.zeros((0, len(COLUMNS))), np.zeros((0, len(COLUMNS))), np.zeros(0, int))
    shifts = np.zeros(len(_AXES), np.int64)
    for start in range(0, height * width, RUN):
        stop = min(start + RUN, height * width)
        items = items_of(material, packed, texel_centers(material, *np.divmod(np.arange(start, stop), width)))
        own = _Merged(_keys(items.cells(), shifts), items.low, items.high, np.ones(len(items.low), int)).merge()
        merged = merged.append(own).merge()
        while len(merged.keys) > MOST:
            bins = (merged.keys[:, None] >> (_BITS * np.arange(len(_AXES)))) % 2**_BITS
            axis = int(np.argmax([len(np.unique(column)) for column in bins.T]))
            shifts[axis] += 1
            bins[:, axis] >>= 1
            merged = _Merged(_keys(bins, np.zeros_like(shifts)), merged.low, merged.high, merged.items).merge()
        progress(stop / (height * width))
    return ClassTable(
        merged.keys,
        tuple(int(shift) for shift in shifts),
        merged.low,
        merged.high,
        merged.items,
        material.kind is MaterialKind.SVBRDF and _has_two_roughnesses(material),
    )


@dataclass(frozen=True, eq=False)
class _Merged:
    """Boxes by key."""

    keys: np.ndarray
    low: np.ndarray
    high: np.ndarray
    items: np.ndarray

    def append(self, other: "_Merged") -> "_Merged":
        pairs = zip(vars(self).values(), vars(other).values(), strict=True)
        return _Merged(*(np.concatenate(pair) for pair in pairs))

    def merge(self) -> "_Merged":
        """Boxes of the same key as one, keys rising."""
        order = np.argsort(self.keys, kind="stable")
        keys, first = np.unique(self.keys[order], return_index=True)
        ends = (np.minimum.reduceat(self.low[order], first), np.maximum.reduceat(self.high[order], first))
        return _Merged(keys, *ends, np.add.reduceat(self.items[order], first))


def _keys(cells: np.ndarray, shifts: np.ndarray | tuple[int, ...]) -> np.ndarray:
    """One number a cell."""
    return np.sum((cells >> np.asarray(shifts)) << (_BITS * np.arange(len(_AXES))), axis=-1)


def _has_two_roughnesses(material: AxfMaterial) -> bool:
    lobe = material.textures.get("specularlobe")
    return bool(material.anisotropic) and lobe is not None and lobe.channels == 2


def items_of(material: AxfMaterial, packed: PackedMaterial, uv: np.ndarray) -> Items:
    """The boxes of texels at ``uv`` (n, 2) of the original's grid, for a car paint (n), else (3 n): red, green, blue.

    Errors as in `class_table`.
    """
    before = without_negative_colors(of_texels(material, uv))
    after = target_named(packed.target).unpack(of_packed_texels(packed, material, uv))
    old, new = (_parameters(side, len(uv)) for side in (before, after))
    values = _angles(before, old, new)
    values["ior"], values["ior_change"] = _change(old["ior"], new["ior"])
    ones = np.ones(len(uv))
    constant = {"roughness_ratio": ones, "roughness_y_ratio": ones, "specular_ratio": ones, "diffuse_ratio": ones}
    constant |= {"roughness": ones, "roughness_y": ones, "f0": ones, "specular": ones}
    constant |= {"f0_change": 0 * ones, "diffuse": 0 * ones}
    sides: dict[str, tuple[np.ndarray, np.ndarray]] = {name: (value, value) for name, value in constant.items()}
    if material.kind is MaterialKind.CAR_PAINT:
        return _stack({**sides, **values})
    lobes = [side["lobe"].reshape(len(uv), -1) for side in (old, new)]
    if lobes[0].shape[1] < lobes[1].shape[1]:
        raise NoBound(f"{material.id}: lobes are isotropic before and anisotropic after")
    for k, name in enumerate(("roughness", "roughness_y")[: lobes[0].shape[1]]):
        values[name], values[f"{name}_ratio"] = _ratio(lobes[0][:, k], lobes[1][:, min(k, lobes[1].shape[1] - 1)])
    channels = []
    for channel in range(3):
        colors = dict(values)
        one, other = ({key: side[key][:, channel] for key in ("diffuse", "specular", "f0")} for side in (old, new))
        for name in ("diffuse", "specular"):
            colors[name], colors[f"{name}_ratio"] = _ratio(one[name], other[name])
        _relative_to_specular(colors)
        if material.fresnel_variant is not None:
            colors["f0"], colors["f0_change"] = _change(one["f0"], other["f0"])
        channels.append(_stack({**sides, **colors}))
    return Items(*(np.concatenate([getattr(each, end) for each in channels]) for end in ("low", "high")))


def _stack(values: dict[str, tuple[np.ndarray, np.ndarray]]) -> Items:
    return Items(*(np.stack([values[name][end] for name in COLUMNS], axis=-1) for end in (0, 1)))


def _parameters(material: AxfMaterial, count: int) -> dict[str, np.ndarray]:
    """Parameters of the texels in float64."""
    parameters, _, _ = model_parameters(material, gather(material, centers(count)))
    values = {name: np.asarray(value, np.float64) for name, value in parameters.items()}
    if material.kind is MaterialKind.CAR_PAINT:
        values["ior"] = np.full(count, float(car_paint_ior(material)[0]))
        values["normal"], values["rotation"] = np.broadcast_to([0.0, 0.0, 1.0], (count, 3)), np.zeros(count)
    return values


def _angles(
    before: AxfMaterial, old: dict[str, np.ndarray], new: dict[str, np.ndarray]
) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Angles between normals before and after, of the lobe's axes, and between coat and base."""
    frames = [frames_of(side["normal"], side["rotation"]) for side in (old, new)]
    swing, twist = swing_and_twist(frames[0], frames[1])
    coats = [unit(side["coat_normal"]) for side in (old, new)]
    coated = float(before.has_clear_coat)
    local = np.einsum("nij,nj->ni", frames[0], coats[0]) * coated
    gap, azimuth = polar(local)
    # Around an isotropic lobe every azimuth is the same.
    azimuth = azimuth * (coated if before.kind is MaterialKind.SVBRDF and _has_two_roughnesses(before) else 0.0)
    room = 2.0**-40
    return {
        "tilt": (0 * swing, roomy(swing)),
        "twist": (0 * twist, roomy(twist)),
        "coat_tilt": (0 * swing, roomy(angle(*coats)) * coated),
        "gap": (np.maximum(gap - room, 0.0), np.where(local.any(axis=-1), gap + room, 0.0)),
        "gap_azimuth": (azimuth - room * coated, azimuth + room * coated),
    }


_Range = tuple[np.ndarray, np.ndarray]


def _ratio(before: np.ndarray, after: np.ndarray) -> tuple[_Range, _Range]:
    """Ranges before, and of after / before, rounded outwards; infinite where 0 becomes something else."""
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(before != 0, after / before, np.where(after == 0, 1.0, np.inf))
        exact = (ratio * before == after) | (before == 0)
    low, high = (np.where(exact, ratio, np.nextafter(ratio, end)) for end in (-np.inf, np.inf))
    return (before, before), (np.maximum(low, np.minimum(ratio, 0.0)), high)


def _change(before: np.ndarray, after: np.ndarray) -> tuple[_Range, _Range]:
    """Ranges before, and of after - before, rounded outwards; never below -before where after is not negative."""
    change = after - before
    ends = np.sort([change * (1 - 2.0**-52), change * (1 + 2.0**-52)], axis=0)
    return (before, before), (np.where(after >= 0, np.maximum(ends[0], -before), ends[0]), ends[1])


def _relative_to_specular(colors: dict[str, _Range]) -> None:
    """Divides both colors by the specular one, where that is not 0; the diffuse one is rounded outwards."""
    specular, diffuse = colors["specular"][0], colors["diffuse"][0]
    divides = specular > 2.0**-64
    quotient = np.where(divides, diffuse / np.where(divides, specular, 1.0), diffuse)
    inexact = divides & (quotient > 0)
    low, high = (np.where(inexact, np.nextafter(quotient, end), quotient) for end in (0.0, np.inf))
    colors["diffuse"] = (low, high)
    one = np.where(divides, 1.0, specular)
    colors["specular"] = (one, one)
