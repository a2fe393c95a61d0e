"""Where two materials differ: the content of ``axffit diff`` (``schemas/diff.schema.json``)."""

import json
import math
from importlib import resources
from typing import Any

import numpy as np

from .. import __version__
from .material import AxfMaterial, AxfTexture

SCHEMA_VERSION = 1

_DESCRIBED = (
    "id",
    "name",
    "kind",
    "diffuse_model",
    "specular_model",
    "specular_variant",
    "fresnel_variant",
    "anisotropic",
)


def difference(a: AxfMaterial, b: AxfMaterial) -> dict[str, Any]:
    """Everything in which two materials differ, JSON-ready; equal means the same bits.

    Returns:
        ``same``, and lists of what differs: ``fields`` (the id and name, kind, models), ``properties`` and ``metadata``
        with both values (None where one has none), and ``textures``: the keys that only one has, and for those of
        both the size of the difference, the largest and mean absolute one, how many texels differ, and where most.
    """
    fields = [
        _pair(name, _text(getattr(a, name)), _text(getattr(b, name)))
        for name in _DESCRIBED
        if getattr(a, name) != getattr(b, name)
    ]
    properties = [
        _pair(key, _listed(a.properties.get(key)), _listed(b.properties.get(key)))
        for key in _both(a.properties, b.properties)
        if not _same(a.properties.get(key), b.properties.get(key))
    ]
    metadata = [
        _pair(key, a.metadata.get(key), b.metadata.get(key))
        for key in _both(a.metadata, b.metadata)
        if a.metadata.get(key) != b.metadata.get(key)
    ]
    textures = [
        found
        for key in _both(a.textures, b.textures)
        if (found := _texture(key, a.textures.get(key), b.textures.get(key))) is not None
    ]
    return {
        "schema": "axffit.diff",
        "schema_version": SCHEMA_VERSION,
        "axffit_version": __version__,
        "a": a.id,
        "b": b.id,
        "same": not (fields or properties or metadata or textures),
        "fields": fields,
        "properties": properties,
        "metadata": metadata,
        "textures": textures,
    }


def _texture(key: str, a: AxfTexture | None, b: AxfTexture | None) -> dict[str, Any] | None:
    """How a texture differs, or None where it does not."""
    if a is None or b is None:
        return {"name": key, "only_in": "a" if b is None else "b", "what": ["missing"], "values": None}
    if a.identical(b):
        return None
    what = []
    shapes = tuple(level.shape for level in a.levels), tuple(level.shape for level in b.levels)
    if shapes[0] != shapes[1]:
        what.append(f"shape: {_shapes(a)} and {_shapes(b)}")
    if a.data.dtype != b.data.dtype:
        what.append(f"type: {a.data.dtype.name} and {b.data.dtype.name}")
    if (a.width_mm, a.height_mm) != (b.width_mm, b.height_mm):
        what.append(f"size: {a.width_mm:g} x {a.height_mm:g} mm and {b.width_mm:g} x {b.height_mm:g} mm")
    values = _values(a, b) if shapes[0] == shapes[1] else None
    if values is not None and values["differing"]:
        what.append("values")
    return {
        "name": key,
        "only_in": None,
        "what": what or ["bits of equal values (zeros' signs, NaN)"],
        "values": values,
    }


def _values(a: AxfTexture, b: AxfTexture) -> dict[str, Any]:
    """The largest and the mean absolute difference over all levels; where only one value is finite it counts apart."""
    largest, where, total, count, differing, broken = 0.0, None, 0.0, 0, 0, 0
    for level, (x, y) in enumerate(zip(a.levels, b.levels, strict=True)):
        x, y = x.astype(np.float64), y.astype(np.float64)
        with np.errstate(invalid="ignore"):
            error = np.where(x == y, 0.0, np.abs(x - y))
        odd = ~np.isfinite(error)
        broken += int(np.count_nonzero(odd & ~(np.isnan(x) & np.isnan(y))))
        differing += int(np.count_nonzero((x != y) & ~(np.isnan(x) & np.isnan(y))))
        error[odd] = 0.0
        total += float(error.sum())
        count += error.size
        index = np.unravel_index(int(np.argmax(error)), error.shape)
        if error[index] > largest:
            largest, where = float(error[index]), [level, *(int(n) for n in index)]
    return {
        "largest": largest,
        "at_level_and_index": where,
        "mean": total / count,
        "differing": differing,
        "count": count,
        "finite_in_one_only": broken,
    }


def _shapes(texture: AxfTexture) -> str:
    levels = f", {len(texture.levels)} levels" if len(texture.levels) > 1 else ""
    return " x ".join(map(str, texture.data.shape)) + levels


def _pair(name: str, a: Any, b: Any) -> dict[str, Any]:
    return {"name": name, "a": a, "b": b}


def _text(value: Any) -> Any:
    return value.value if hasattr(value, "value") else value


def _listed(value: Any) -> Any:
    """A property as JSON holds it."""
    if value is None:
        return None
    if isinstance(value, np.ndarray):
        return [_listed(each) for each in value]
    return value.item() if math.isfinite(value) else str(value)


def _same(a: Any, b: Any) -> bool:
    if a is None or b is None:
        return a is b
    return a.dtype == b.dtype and np.shape(a) == np.shape(b) and a.tobytes() == b.tobytes()


def _both(a: Any, b: Any) -> list[str]:
    """Keys of both, those of the first in its order."""
    return [*a, *(key for key in b if key not in a)]


def schema() -> dict[str, Any]:
    """The JSON schema of `difference`."""
    text = resources.files("axffit.axf").joinpath("schemas/diff.schema.json").read_text(encoding="utf-8")
    return json.loads(text)
