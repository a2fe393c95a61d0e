"""What a file holds, in numbers: the content of ``axffit inspect`` (``schemas/inspect.schema.json``)."""

import json
import math
from importlib import resources
from typing import Any

import numpy as np

from .. import __version__
from .material import AxfFile, AxfMaterial, AxfTexture, MaterialKind
from .profiles import minimum_version, profiles
from .ranges import TEXTURE_RANGES, Outside
from .validation import problems

SCHEMA_VERSION = 1


def describe(file: AxfFile) -> dict[str, Any]:
    """Everything a file holds except the texels themselves, JSON-ready.

    Args:
        file: as `read` gives it; read with ``validate=False`` it is described whatever is wrong with it.

    Returns:
        The version, what was inferred and not recognized, and of each material its models, properties, metadata,
        every texture's size, type and range of values, and the rules it breaks.
    """
    return {
        "schema": "axffit.inspect",
        "schema_version": SCHEMA_VERSION,
        "axffit_version": __version__,
        "file": file.source,
        "axf_version": list(file.version),
        "inferred": list(file.inferred),
        "unrecognized": list(file.unrecognized),
        "kept": [extra.path for extra in file.extras],
        "materials": [describe_material(material) for material in file.materials],
    }


def describe_material(material: AxfMaterial) -> dict[str, Any]:
    """One material, JSON-ready."""
    return {
        "id": material.id,
        "name": material.name,
        "kind": material.kind.value,
        "models": _models(material),
        "clear_coat": {"present": material.has_clear_coat, "refracts": material.coat_refracts},
        "textures": {key: describe_texture(key, texture) for key, texture in material.textures.items()},
        "properties": {key: _plain(value) for key, value in material.properties.items()},
        "metadata": dict(material.metadata),
        "previews": {path: list(picture.shape) for path, picture in material.previews.items()},
        "representation": material.representation,
        "alternatives": [describe_material(entry) for entry in material.alternatives],
        "profiles": [
            {"profile": each.profile, "version": each.version, "obstacles": list(each.obstacles)}
            for each in profiles(material)
        ],
        "minimum_version": None if (least := minimum_version(material)) is None else list(least),
        "kept": [extra.path for extra in material.extras],
        "inferred": list(material.inferred),
        "unrecognized": list(material.unrecognized),
        "problems": list(problems(material)),
    }


def describe_texture(key: str, texture: AxfTexture) -> dict[str, Any]:
    """One texture, JSON-ready.

    Counts are of values, over all channels of the finest level: ``negative``, ``nan``, ``infinite``, and
    ``outside`` of the range that AxF gives the quantity; of a spectrum that was not converted they are of the
    spectra. Smallest, largest and mean value are those of each channel's
    finite values, None where there is none.
    """
    data = texture.data if texture.levels else texture.spectra[0]
    legal = TEXTURE_RANGES[key]
    values = data.reshape(-1, data.shape[-1]).astype(np.float64)
    finite = np.where(np.isfinite(values), values, np.nan)
    channels = [column[~np.isnan(column)] for column in finite.T]
    return {
        "node": texture.source,
        "type": data.dtype.name,
        "size": [int(n) for n in data.shape[-3:-1][::-1]] if data.ndim > 2 else None,
        "slices": int(data.shape[0]) if data.ndim == 4 else None,
        "levels": len(texture.stored),
        "channels": int(data.shape[-1]),
        "spectrum": _spectrum(texture),
        "width_mm": _number(texture.width_mm),
        "height_mm": _number(texture.height_mm),
        "constant": bool(texture.is_constant),
        "unit": legal.unit,
        "minimum": [_number(channel.min()) if channel.size else None for channel in channels],
        "maximum": [_number(channel.max()) if channel.size else None for channel in channels],
        "mean": [_number(channel.mean()) if channel.size else None for channel in channels],
        "negative": int(np.count_nonzero(values < 0)),
        "nan": int(np.count_nonzero(np.isnan(values))),
        "infinite": int(np.count_nonzero(np.isinf(values))),
        "range": str(legal),
        "outside": int(np.count_nonzero(legal.beyond(values))),
        "outside_means": "refused" if legal.outside is Outside.ERROR else "counted",
    }


def _spectrum(texture: AxfTexture) -> dict[str, Any] | None:
    if not texture.spectra:
        return None
    wavelengths = texture.wavelengths
    return {
        "channels": int(texture.spectra[0].shape[-1]),
        "wavelengths_nm": None if wavelengths is None else [_number(each) for each in wavelengths],
        "converted": bool(texture.levels),
        "unconverted": texture.unconverted or None,
    }


def _models(material: AxfMaterial) -> dict[str, Any]:
    if material.kind is MaterialKind.CAR_PAINT:
        lobes = material.properties.get("CT_coeffs")
        return {"diffuse": "Lambert", "specular": "CookTorrance", "lobes": 0 if lobes is None else len(lobes)}
    return {
        "diffuse": material.diffuse_model,
        "specular": material.specular_model,
        "specular_variant": material.specular_variant,
        "fresnel_variant": material.fresnel_variant,
        "anisotropic": bool(material.anisotropic),
    }


def _number(value: float) -> float | None:
    """A float that JSON can hold."""
    return float(value) if math.isfinite(value) else None


def _plain(value: Any) -> Any:
    """A property as JSON holds it; a number that is not finite as its name."""
    if isinstance(value, np.ndarray):
        return [_plain(each) for each in value]
    number = value.item()
    return number if math.isfinite(number) else str(number)


def schema() -> dict[str, Any]:
    """The JSON schema of `describe`."""
    text = resources.files("axffit.axf").joinpath("schemas/inspect.schema.json").read_text(encoding="utf-8")
    return json.loads(text)
