"""From an AxF material before and after packing to the forms and classes that `bracket` takes."""

import jax
import jax.numpy as jnp
import numpy as np

from ...axf import AxfMaterial, MaterialKind
from ...axf.appearance import car_paint_base, car_paint_ior, model_parameters, texel_model
from ...axf.maps import gather
from ...brdf import CarPaint, ClearCoat, Framed, Sum
from ..turns import angle, frames_of, polar, roomy, swing_and_twist, unit
from .form import Coat, Form, NoBound, Paint
from .texel_class import TexelClass

CHANNELS = 3


def form_of(before: AxfMaterial, after: AxfMaterial, channel: int) -> Form:
    """The form of one color channel of a material; that of an SVBRDF is the same for all three.

    Args:
        before: the original material.
        after: what the shader sees.
        channel: 0 to 2.

    Raises:
        InputError: a model that axffit does not evaluate.
        NoBound: a car paint whose values, apart from the colors, are not those of the original.
    """
    coat: Coat | None = None
    if before.has_clear_coat:
        coat = "refracting" if before.coat_refracts else "straight"
    if before.kind is MaterialKind.CAR_PAINT:
        return Form(coat=coat or "straight", paint=_paint(before, after, channel))
    model = texel_model(before)(_one_texel(before))
    model = model.base if isinstance(model, ClearCoat) else model
    assert isinstance(model, Framed)
    assert isinstance(model.base, Sum)
    diffuse, specular = model.base.terms
    return Form(type(diffuse), type(specular), type(getattr(specular, "fresnel")), coat)  # noqa: B009


def _one_texel(material: AxfMaterial) -> dict[str, jax.Array]:
    parameters, _, _ = model_parameters(material, gather(material, np.zeros(2)))
    return {name: jnp.asarray(value) for name, value in parameters.items()}


def _paint(before: AxfMaterial, after: AxfMaterial, channel: int) -> Paint:
    one, other = (car_paint_base(material) for material in (before, after))
    names = ("diffuse", "coefficients", "f0", "spreads")
    lobes = [[np.asarray(getattr(paint, name)) for name in names] for paint in (one, other)]
    # A target pads its arrays with lobes that reflect nothing.
    count = len(lobes[0][1])
    same = all(np.array_equal(a, b[..., :count] if b.ndim else b) for a, b in zip(*lobes, strict=True))
    if not same or np.any(lobes[1][1][count:] != 0):
        raise NoBound(f"{before.id}: the packed car paint has other lobes than the original")
    coefficients, f0, spreads = (tuple(float(x) for x in values) for values in lobes[0][1:])
    colors, colors_after = (np.maximum(_colors(paint), 0.0) for paint in (one, other))
    own = (colors[..., channel], colors_after[..., channel])
    return Paint(float(lobes[0][0]), coefficients, f0, spreads, *own, colors)


def _colors(paint: CarPaint) -> np.ndarray:
    return np.asarray(paint.color_table.values, np.float64)


def classes_of(before: AxfMaterial, after: AxfMaterial, uv: np.ndarray, channel: int) -> list[TexelClass]:
    """The class of every single texel at texture coordinates ``uv`` (n, 2): boxes that are points, but for the tilts.

    Negative colors of the original count as 0. A color that is 0 before and not after has no ratio: the class of such
    a texel is refused.

    Raises:
        NoBound: a texel whose errors no class can hold, for example a normal that is lost altogether.
    """
    sides = [_texels(material, uv) for material in (before, after)]
    old, new = sides
    frames = [frames_of(side["normal"], side["rotation"]) for side in sides]
    tilt, twist = swing_and_twist(frames[0], frames[1])
    coats = [unit(side["coat_normal"]) for side in sides]
    local = np.einsum("nij,nj->ni", frames[0], coats[0])
    gap, azimuth = polar(local)
    coat_tilt = angle(*coats)
    lobe = [side["lobe"].reshape(len(uv), -1) for side in sides]
    classes = []
    for k in range(len(uv)):
        values: dict = {"tilt": float(roomy(tilt)[k]), "twist": float(roomy(twist)[k])}
        values["roughness"], values["roughness_ratio"] = _ratio("roughness", lobe[0][k, 0], lobe[1][k, 0])
        if lobe[0].shape[-1] == 2:
            values["roughness_y"], values["roughness_y_ratio"] = _ratio("roughness", lobe[0][k, 1], lobe[1][k, -1])
        for name in ("diffuse", "specular"):
            values[name], values[f"{name}_ratio"] = _ratio(name, old[name][k, channel], new[name][k, channel])
        f0 = (old["f0"][k, channel], new["f0"][k, channel])
        values["f0"], values["f0_change"] = _change(*f0)
        values["ior"], values["ior_change"] = _change(old["ior"][k], new["ior"][k])
        if before.has_clear_coat:
            values["coat_tilt"] = float(roomy(coat_tilt)[k])
            values["gap"], values["gap_azimuth"] = _around(gap[k], 0.0), _around(azimuth[k], -np.inf)
        try:
            classes.append(TexelClass(**values))
        except ValueError as error:
            raise NoBound(f"texel {k}: {error}") from error
    return classes


def _texels(material: AxfMaterial, uv: np.ndarray) -> dict[str, np.ndarray]:
    """Parameters of the texels in float64."""
    parameters, _, _ = model_parameters(material, gather(material, uv))
    values = {name: np.asarray(value, np.float64) for name, value in parameters.items()}
    values |= {name: np.maximum(values[name], 0.0) for name in ("diffuse", "specular", "f0")}
    if material.kind is MaterialKind.CAR_PAINT:
        values["ior"] = np.full(len(uv), float(car_paint_ior(material)[0]))
        values["normal"] = np.broadcast_to([0.0, 0.0, 1.0], (len(uv), 3))
    return values


def _around(angle: float, least: float) -> tuple[float, float]:
    return max(float(angle) - 2.0**-40, least), float(angle) + 2.0**-40


def _ratio(name: str, before: float, after: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """Range before and range of after / before, rounded outwards."""
    if before == 0 and after != 0:
        raise NoBound(f"{name}: is 0 before and {after} after, which no ratio describes")
    ratio = after / before if before != 0 else 1.0
    exact = ratio * before == after
    ends = (ratio, ratio) if exact else (np.nextafter(ratio, -np.inf), np.nextafter(ratio, np.inf))
    return (float(before), float(before)), (float(ends[0]), float(ends[1]))


def _change(before: float, after: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """Range before and range of after - before; the difference of two floats of textures is exact or nearly so."""
    change = float(after - before)
    ends = sorted((change * (1 - 2.0**-52), change * (1 + 2.0**-52)))
    return (float(before), float(before)), (max(ends[0], -float(before)), ends[1])
