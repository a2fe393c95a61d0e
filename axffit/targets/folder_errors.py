"""What packing changed, in AxF's own units: the errors that stand in a folder's `material.json`."""

from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np

from ..axf import AxfMaterial, AxfTexture
from ..axf.ranges import EXPONENT_RANGE, PROPERTY_RANGES, TEXTURE_RANGES
from .base import PackedMaterial, PackedTexture
from .encoding import blocks


@dataclass(frozen=True)
class TextureError:
    """Absolute errors of decode(encode(x)) against x over all channels and kept levels of a texture.

    Attributes:
        quantity: what was compared.
        unit: AxF's unit of the texture.
        largest: largest error.
        mean: mean error.
        compared: numbers compared.
        left_out: numbers left out because one side is not finite (an index of refraction may be).
    """

    quantity: str
    unit: str
    largest: float
    mean: float
    compared: int
    left_out: int

    def to_json(self) -> dict[str, Any]:
        """The numbers under the names of `material.json`."""
        return {
            "quantity": self.quantity,
            "unit": self.unit,
            "max": self.largest,
            "mean": self.mean,
            "compared": self.compared,
            "left_out": self.left_out,
        }


def texture_errors(material: AxfMaterial, packed: PackedMaterial, target: ModuleType) -> dict[str, TextureError | str]:
    """Per texture of a packed material its errors, or why there are none.

    Args:
        material: what was packed.
        packed: what the target made of it.
        target: the target's module; its `unpack` says what the shader will see.
    """
    back = target.unpack(packed, defaults=False)
    return {name: _error(texture, material, back) for name, texture in packed.textures.items()}


def _error(texture: PackedTexture, material: AxfMaterial, back: AxfMaterial) -> TextureError | str:
    if texture.defaulted:
        return "AxF has no such texture; this is the target's default"
    key = texture.axf_name
    before, after = _levels(material, key), _levels(back, key)
    if before is None or after is None:
        return f"the target made this texture from others; {key} does not come back as such"
    kept = min(len(before), len(after))
    if [level.shape for level in before[:kept]] != [level.shape for level in after[:kept]]:
        return f"the target changed the size or channels of {key}: it does not come back texel for texel"
    # An anisotropy axis is the same after half a turn.
    period = np.pi if key == "anisrotation" else None
    largest, total, compared, left_out = 0.0, 0.0, 0, 0
    for old, new in zip(before[:kept], after[:kept], strict=True):
        for run, rows in blocks(old):
            found = new.reshape(-1, new.shape[-1])[run].astype(np.float64)
            used = np.isfinite(rows) & np.isfinite(found)
            error = np.abs(found[used] - rows[used].astype(np.float64))
            if period is not None:
                error = np.abs(error - period * np.rint(error / period))
            largest = max(largest, float(error.max(initial=0.0)))
            total += float(error.sum())
            compared += int(error.size)
            left_out += int(used.size - error.size)
    quantity = "|decode(encode(x)) - x|" + (" modulo pi" if period is not None else "")
    if kept < len(before):
        quantity += f" on {kept} of {len(before)} mip levels; the target has no others"
    mean = total / compared if compared else 0.0
    return TextureError(quantity, _unit(key, material), largest, mean, compared, left_out)


def _levels(material: AxfMaterial, key: str) -> tuple[np.ndarray, ...] | None:
    if key in material.textures:
        return material.textures[key].levels
    if key in material.properties and np.ndim(material.properties[key]) == 1:
        return AxfTexture((np.asarray(material.properties[key]).reshape(1, -1, 1),)).levels
    return None


def _unit(key: str, material: AxfMaterial) -> str:
    if key == "specularlobe" and material.specular_model in ("BlinnPhong", "Phong"):
        return EXPONENT_RANGE.unit
    return (TEXTURE_RANGES.get(key) or PROPERTY_RANGES[key]).unit
