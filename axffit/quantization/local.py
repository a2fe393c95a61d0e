"""Texels before and after packing, each in the frame of the original's outermost normal.

A BRDF error is about light and viewer as a texel's own surface sees them, so that it does not matter how far its
normal is tilted in the map: (0, 0, 1) is the original's normal, the coat's where there is one. The frame's other axes
are those of `frames.tangent_frame`. What packing turned is turned against this frame.
"""

from dataclasses import dataclass

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from ..axf import AxfMaterial, MaterialKind, to_brdf
from ..axf.appearance import model_parameters, texel_model
from ..axf.maps import gather
from ..axf.ranges import ROUGHNESS_FLOOR
from ..brdf import AbstractBRDF, ClearCoat, Framed
from ..frames import tangent_frame
from .directions import LobeFrames


class Texels(eqx.Module):
    """BRDFs that differ between texels in some array leaves and share the others.

    Attributes:
        own: the BRDF with only the leaves that have the texels' axis.
        shared: the BRDF with all the others (a car paint's lobes, color table and flakes).
    """

    own: AbstractBRDF
    shared: AbstractBRDF

    def take(self, part: np.ndarray) -> "Texels":
        """Some of the texels."""
        return Texels(jax.tree.map(lambda leaf: leaf[part], self.own), self.shared)

    def reflect(self, wi: jax.Array, wo: jax.Array) -> jax.Array:
        """f i_z for directions (n, ..., 3), each texel its own."""

        def single(own: AbstractBRDF, wi: jax.Array, wo: jax.Array) -> jax.Array:
            return eqx.combine(own, self.shared).evaluate(wi, wo) * wi[..., 2:]

        return eqx.filter_vmap(single)(self.own, wi, wo)


@dataclass(frozen=True, eq=False)
class LocalTexels:
    """Texels of a material before and after, in their own frames.

    Attributes:
        before: the original's BRDFs.
        after: what the shader sees.
        frames: what shapes the original's lobes, in the same frames.
    """

    before: Texels
    after: Texels
    frames: LobeFrames


def local_texels(before: AxfMaterial, after: AxfMaterial, uv: np.ndarray) -> LocalTexels:
    """The texels at texture coordinates ``uv`` (n, 2) in their own frames; needs JAX with x64 enabled.

    Raises:
        InputError: a model that axffit does not evaluate.
    """
    sides = [_parameters(material, uv) for material in (before, after)]
    outermost = sides[0]["coat_normal" if before.has_clear_coat else "normal"]
    world = np.asarray(tangent_frame(jnp.asarray(outermost)))
    for side in sides:
        _turn(side, world)
    models = _models(before, sides[0], uv), _models(after, sides[1], uv)
    return LocalTexels(*models, _lobe_frames(before, sides[0], uv))


def _parameters(material: AxfMaterial, uv: np.ndarray) -> dict[str, np.ndarray]:
    parameters, _, _ = model_parameters(material, gather(material, uv))
    values = {name: np.asarray(value, np.float64) for name, value in parameters.items()}
    if material.kind is MaterialKind.CAR_PAINT:
        values["normal"], values["rotation"] = np.tile([0.0, 0.0, 1.0], (len(uv), 1)), np.zeros(len(uv))
    return values


def _turn(side: dict[str, np.ndarray], world: np.ndarray) -> None:
    """Normals and rotation as seen from frames (n, 3, 3) whose rows are the axes."""
    frame = np.asarray(tangent_frame(jnp.asarray(side["normal"]), jnp.asarray(side["rotation"])))
    local = np.einsum("nij,nkj->nik", frame, world)
    side["normal"] = local[:, 2]
    unturned = np.asarray(tangent_frame(jnp.asarray(local[:, 2])))
    x, y = (np.sum(local[:, 0] * unturned[:, k], axis=-1) for k in (0, 1))
    side["rotation"] = np.arctan2(y, x)
    coat = side["coat_normal"] / np.linalg.norm(side["coat_normal"], axis=-1, keepdims=True)
    side["coat_normal"] = np.einsum("nij,nj->ni", world, coat)


def _models(material: AxfMaterial, side: dict[str, np.ndarray], uv: np.ndarray) -> Texels:
    """The BRDFs; of a car paint only the normals belong to the texel."""
    if material.kind is MaterialKind.SVBRDF:
        flat = {name: jnp.asarray(value) for name, value in side.items()}
        return Texels(*eqx.partition(eqx.filter_vmap(texel_model(material))(flat), eqx.is_array))
    paint = to_brdf(material, uv=uv)
    assert isinstance(paint, ClearCoat)
    framed = Framed(paint.base, jnp.asarray(side["normal"]), jnp.asarray(side["rotation"]))
    model = eqx.tree_at(lambda m: (m.base, m.normal), paint, (framed, jnp.asarray(side["coat_normal"])))
    own = eqx.tree_at(
        lambda m: (m.base.normal, m.base.rotation, m.normal), jax.tree.map(lambda leaf: False, model), (True,) * 3
    )
    return Texels(*eqx.partition(model, own))


def _lobe_frames(material: AxfMaterial, side: dict[str, np.ndarray], uv: np.ndarray) -> LobeFrames:
    """Normals, rotations and roughness of the original's lobes."""
    if material.kind is MaterialKind.CAR_PAINT:
        spreads = np.atleast_1d(material.properties.get("CT_spreads", np.ones(1))).astype(np.float64)
        roughness = np.broadcast_to(spreads[:, None], (len(uv), len(spreads), 2))
        ior = np.full(len(uv), float(material.properties.get("IOR", 1.5)))
    else:
        lobe = side["lobe"].reshape(len(uv), -1)
        if material.specular_model in ("BlinnPhong", "Phong"):
            # A Gaussian of roughness sqrt(2 / (n + 2)) is about as wide as the lobe of exponent n.
            lobe = np.sqrt(2.0 / (lobe + 2.0))
        roughness = np.broadcast_to(np.maximum(lobe, ROUGHNESS_FLOOR), (len(uv), 2))[:, None]
        ior = side["ior"]
    bends = material.has_clear_coat and material.coat_refracts
    ior = np.where(bends & (ior > 0) & np.isfinite(ior), ior, 1.5 if bends else 1.0)
    coat = side["coat_normal"] if material.has_clear_coat else side["normal"]
    return LobeFrames(side["normal"], side["rotation"], np.minimum(roughness, 1.0), coat, ior)
