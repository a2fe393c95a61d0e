"""Where two materials differ: the content of ``axffit diff`` (``schemas/diff.schema.json``)."""

import json
import math
from importlib import resources
from typing import Any

import numpy as np

from .. import __version__
from .material import AxfMaterial, AxfTexture, same_extras, same_pictures

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
    "representation",
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
    fields += _beside(a, b)
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


def _beside(a: AxfMaterial, b: AxfMaterial) -> list[dict[str, Any]]:
    """What a material holds besides what it reflects, where it differs: by name, or how often."""
    found = []
    if not same_pictures(a.previews, b.previews):
        found.append(_pair("previews", sorted(a.previews), sorted(b.previews)))
    if not same_extras(a.extras, b.extras):
        paths = ([extra.path for extra in each.extras] for each in (a, b))
        found.append(_pair("extras", *(sorted(each) for each in paths)))
    same = len(a.alternatives) == len(b.alternatives)
    if not (same and all(x.identical(y) for x, y in zip(a.alternatives, b.alternatives, strict=True))):
        found.append(_pair("alternatives", *([x.representation for x in each.alternatives] for each in (a, b))))
    return found


def _texture(key: str, a: AxfTexture | None, b: AxfTexture | None) -> dict[str, Any] | None:
    """How a texture differs, or None where it does not."""
    if a is None or b is None:
        return {"name": key, "only_in": "a" if b is None else "b", "what": ["missing"], "values": None}
    if a.identical(b):
        return None
    what = []
    if bool(a.levels) != bool(b.levels) or bool(a.spectra) != bool(b.spectra):
        what = ["spectra in one only, or converted in one only"]
        return {"name": key, "only_in": None, "what": what, "values": None}
    levels = (a.levels, b.levels) if a.levels else (a.spectra, b.spectra)
    shapes = tuple(tuple(level.shape for level in each) for each in levels)
    if shapes[0] != shapes[1]:
        what.append(f"shape: {_shapes(levels[0])} and {_shapes(levels[1])}")
    if levels[0][0].dtype != levels[1][0].dtype:
        what.append(f"type: {levels[0][0].dtype.name} and {levels[1][0].dtype.name}")
    if (a.width_mm, a.height_mm) != (b.width_mm, b.height_mm):
        what.append(f"size: {a.width_mm:g} x {a.height_mm:g} mm and {b.width_mm:g} x {b.height_mm:g} mm")
    values = _values(*levels) if shapes[0] == shapes[1] else None
    if values is not None and values["differing"]:
        what.append("values")
    if a.levels and not a.same_spectra(b):
        what.append("spectra")
    return {
        "name": key,
        "only_in": None,
        "what": what or ["bits of equal values (zeros' signs, NaN)"],
        "values": values,
    }


def _values(a: tuple[np.ndarray, ...], b: tuple[np.ndarray, ...]) -> dict[str, Any]:
    """The largest and the mean absolute difference over all levels; where only one value is finite it counts apart."""
    largest, where, total, count, differing, broken = 0.0, None, 0.0, 0, 0, 0
    for level, (x, y) in enumerate(zip(a, b, strict=True)):
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


def _shapes(levels: tuple[np.ndarray, ...]) -> str:
    finest = " x ".join(map(str, levels[0].shape))
    return f"{finest}, {len(levels)} levels" if len(levels) > 1 else finest


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
