"""An AxF material as a surface: maps filtered at any place, flakes included."""

from collections.abc import Mapping
from typing import Any

import jax
import numpy as np

from axffit import brdf
from axffit.axf.appearance import car_paint_base, car_paint_ior, model_parameters, texel_model
from axffit.axf.maps import DEFAULTS, SPATIAL_KEYS, reference_map, stretch
from axffit.axf.material import AxfMaterial, AxfTexture, MaterialKind

_MAP_OF = {
    "diffuse": "diffusecolor",
    "specular": "specularcolor",
    "lobe": "specularlobe",
    "f0": "fresnel",
    "normal": "normal",
    "rotation": "anisrotation",
    "ior": "clearcoatior",
    "coat_normal": "clearcoatnormal",
    "coat_color": "clearcoatcolor",
}
"""The AxF map behind each parameter of a texel's model."""

_ONE_CHANNEL = ("rotation", "ior")


def to_svbrdf(material: AxfMaterial, *, clamp_angles: bool = False, mirror_tiles: bool = False) -> brdf.SVBRDF:
    """What a material reflects at any place of its surface.

    Maps are filtered bilinearly, between mip levels that are 2x2 means (AxF gives levels only for flakes, which are
    kept as given). A texture coordinate of 1 is the extent of the largest map in millimeters, or of the flakes.

    Args:
        material: an SVBRDF or a car paint.
        clamp_angles: whether flakes are looked up at no more than 1 radian, as the AxF SDK does.
        mirror_tiles: whether every other tile of the flakes is mirrored, as the AxF SDK does to hide the tiling.

    Raises:
        InputError: the material has a model that axffit does not evaluate.
    """
    if material.kind is MaterialKind.CAR_PAINT:
        return _car_paint(material, clamp_angles=clamp_angles, mirror_tiles=mirror_tiles)
    reference = reference_map(material)
    raw = {key: _texels(material, key) for key in SPATIAL_KEYS}
    parameters, _, _ = model_parameters(material, raw)
    model = texel_model(material)

    def build(_: None, texel: Mapping[str, jax.Array]) -> brdf.AbstractBRDF:
        scalar = (*_ONE_CHANNEL, *(("lobe",) if parameters["lobe"].ndim == 2 else ()))
        return model({name: value[0] if name in scalar else value for name, value in texel.items()})

    maps = {
        name: _mapped(value if value.ndim == 3 else value[..., None], material, _MAP_OF[name], reference)
        for name, value in parameters.items()
    }
    alpha, height = (
        _mapped(raw[key], material, key, reference) if key in material.textures else None
        for key in ("opacity", "height")
    )
    return brdf.SVBRDF(maps, build, None, _size_mm(reference), alpha, height)


def _car_paint(material: AxfMaterial, *, clamp_angles: bool, mirror_tiles: bool) -> brdf.SVBRDF:
    flakes, values = material.textures.get("btfflakes"), material.properties
    reference = reference_map(material) or flakes
    shared: dict[str, Any] = {"base": car_paint_base(material), "ior": car_paint_ior(material)[0]}
    if flakes is not None:
        lut = values["thetaFI_sliceLUT"]
        shared["flakes"] = brdf.Flakes(
            brdf.texture_map(flakes.levels, tiles=stretch(flakes, reference), mirrored=mirror_tiles),
            tuple(int(entry) for entry in lut),
            num_theta_f=int(values["num_thetaF"]),
            num_theta_i=int(values["num_thetaI"]),
            max_theta_i=int(values["max_thetaI"]),
            clamp_angles=clamp_angles,
        )
    refracting = material.coat_refracts

    def build(shared: dict[str, Any], texel: Mapping[str, jax.Array]) -> brdf.AbstractBRDF:
        base = shared["base"]
        if "flakes" in shared:
            base = base.with_flakes(shared["flakes"].at(texel["uv"], texel["footprint"]))
        return brdf.ClearCoat(base, shared["ior"], texel["coat_normal"], texel["coat_color"], refracting=refracting)

    maps = {
        name: _mapped(_texels(material, _MAP_OF[name]), material, _MAP_OF[name], reference)
        for name in ("coat_normal", "coat_color")
    }
    return brdf.SVBRDF(maps, build, shared, _size_mm(reference))


def _texels(material: AxfMaterial, key: str) -> np.ndarray:
    """A map's finest level [H, W, C] in float32; 1x1 for an absent or constant one."""
    texture = material.textures.get(key)
    if texture is None:
        return np.asarray(DEFAULTS[key], np.float32)[None, None, :]
    return (texture.data[:1, :1] if texture.is_constant else texture.data).astype(np.float32)


def _mapped(texels: np.ndarray, material: AxfMaterial, key: str, reference: AxfTexture | None) -> brdf.TextureMap:
    texture = material.textures.get(key)
    tiles = np.ones(2) if texture is None else stretch(texture, reference)
    return brdf.texture_map(_mip_levels(texels), tiles=tiles.astype(np.float32))


def _mip_levels(texels: np.ndarray) -> list[np.ndarray]:
    """The map and its halvings by 2x2 means, as long as both sides are even."""
    levels = [texels]
    while texels.shape[0] % 2 == 0 and texels.shape[1] % 2 == 0:
        height, width, channels = texels.shape
        texels = texels.reshape(height // 2, 2, width // 2, 2, channels).mean(axis=(1, 3), dtype=np.float32)
        levels.append(texels)
    return levels


def _size_mm(reference: AxfTexture | None) -> tuple[float, float]:
    return (1.0, 1.0) if reference is None else (reference.width_mm, reference.height_mm)
