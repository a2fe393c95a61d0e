"""Small materials, samples and models that the tests of reports share."""

import jax.numpy as jnp
import numpy as np

from axffit import axf, report
from axffit.brdf import GGX, CarPaint, ClearCoat, Lambert, Schlick1994
from axffit.measured import HalfDifferenceGrid, Measurements, reference_grid

HOSTILE = '<script>alert("1")</script> & "paint\' {{ 7 * 7 }}'
"""A name that would do harm wherever it is not escaped."""


def ggx() -> GGX:
    return GGX(np.array([0.5, 0.4, 0.3]), np.float64(0.2), Schlick1994(np.float64(0.3)))


def grid() -> HalfDifferenceGrid:
    return reference_grid(12, 9, 8)


def samples(name: str = "paint") -> Measurements:
    """GGX over Lambert, without noise."""
    directions = grid()
    model = Lambert(np.array([0.1, 0.05, 0.02])) + ggx()
    values = np.asarray(model.evaluate(jnp.asarray(directions.wi), jnp.asarray(directions.wo)))
    valid = np.ones(len(values), bool)
    provenance = {"file": "made <here>"}
    return Measurements(
        directions.wi, directions.wo, values, valid, directions.weights, None, name=name, provenance=provenance
    )


def material(name: str = "Steel", id: str = "steel") -> axf.AxfMaterial:
    """An isotropic Ward SVBRDF of 6 × 4 texels, with a negative color."""
    rng = np.random.default_rng(3)
    color = rng.uniform(0.1, 0.8, (4, 6, 3)).astype(np.float32)
    color[1, 2, 0] = -0.01
    normal = np.concatenate([rng.normal(0, 0.1, (4, 6, 2)), np.ones((4, 6, 1))], axis=-1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    maps = {
        "diffusecolor": color,
        "specularcolor": rng.uniform(0.1, 0.5, (4, 6, 3)).astype(np.float32),
        "specularlobe": rng.uniform(0.2, 0.4, (4, 6, 1)).astype(np.float32),
        "normal": normal.astype(np.float32),
    }
    textures = {key: axf.AxfTexture((value,), 10.0, 10.0) for key, value in maps.items()}
    return axf.AxfMaterial(id=id, name=name, kind=axf.MaterialKind.SVBRDF, textures=textures)


def coated() -> ClearCoat:
    return ClearCoat(CarPaint(0.05, [0.02], [0.5], [0.2]), 1.5)


RUN = report.Run('axffit demo --out "<b>"', seed=7)
