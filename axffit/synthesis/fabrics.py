"""Cotton lace: a net of threads with embroidered flowers, and nothing between them."""

import numpy as np

from ..axf import AxfMaterial
from .fields import blend, cells, normals_of, smooth_step, staggered
from .material import SEED, labels, svbrdf_material, with_dark_noise
from .noise import fractal_noise, unit_grid

EXTENT_MM = 30.0

NET = (12, 14)
"""Meshes of the net along u and v."""

FLOWERS = (2, 2)


def lace(size: int = 64, seed: int = SEED) -> AxfMaterial:
    """Lace: Lambert and a weak isotropic Ward lobe, opacity of the threads, height in millimeters."""
    rng = np.random.Generator(np.random.PCG64(seed))
    u, v = unit_grid(size)
    mesh = cells(u, v, staggered(NET))
    blur = 0.5 * NET[0] / size
    border = mesh.second - mesh.nearest
    net = 1.0 - smooth_step(0.17 - blur, 0.17 + blur, border)

    bloom = cells(u, v, staggered(FLOWERS))
    angle = np.arctan2(bloom.offset[..., 1], bloom.offset[..., 0]) + 1.9 * bloom.row
    blur = 0.5 * FLOWERS[0] / size
    outline = 0.33 * (0.72 + 0.28 * np.cos(5.0 * angle))
    inward = outline - bloom.nearest
    petals = smooth_step(-blur, blur, inward)
    cord = 1.0 - smooth_step(0.018, 0.018 + 2.0 * blur, np.abs(inward))
    # An eyelet in the middle and one in each petal.
    middle = smooth_step(0.035 - blur, 0.035 + blur, bloom.nearest)
    along = 0.20 - bloom.nearest
    sideways = bloom.nearest * np.mod(angle + np.pi / 5.0, 0.4 * np.pi) - bloom.nearest * np.pi / 5.0
    eyelet = smooth_step(0.03 - blur, 0.03 + blur, np.hypot(0.6 * along, sideways))
    flower = np.maximum(petals * middle * eyelet, cord)
    opacity = np.maximum(net, flower)

    stitches = np.cos(45.0 * angle) * petals
    frayed = fractal_noise(rng, u, v, (40, 40), octaves=2, size=4 * size)
    thread = 1.0 - smooth_step(0.0, 0.34, border)
    height = 0.18 * thread * (1.0 - petals) + 0.30 * petals + 0.16 * cord + 0.02 * stitches + 0.02 * frayed
    shade = np.clip(0.80 + 0.08 * frayed + 0.06 * stitches + 0.10 * cord, 0.0, 1.0) * (0.35 + 0.65 * opacity)
    maps = {
        "diffusecolor": with_dark_noise(rng, blend((0.0, 0.0, 0.0), (0.80, 0.775, 0.70), shade)),
        "normal": normals_of(height, EXTENT_MM),
        "specularcolor": np.full(3, 0.5),
        "specularlobe": np.full(1, 0.45),
        "fresnel": np.full(3, 0.045),
        "opacity": opacity[..., None],
        "height": height[..., None],
    }
    return svbrdf_material(
        "lace",
        "Cotton lace",
        maps,
        extent_mm=EXTENT_MM,
        metadata=labels("lace", size, seed),
        fresnel_variant="Schlick1994",
    )
