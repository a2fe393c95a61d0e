"""Small valid files of every format, for the laws that all readers obey."""

from pathlib import Path

import numpy as np

from axffit.measured import mbsdf, merl, tensor_file

RNG_SEED = 6


def mbsdf_file(path: Path) -> None:
    mbsdf.write_table(path, np.random.default_rng(RNG_SEED).uniform(0.1, 0.5, (4, 4, 5, 3)))


def merl_file(path: Path) -> None:
    table = np.broadcast_to(np.arange(90.0)[:, None, None, None] + [0.1, 0.2, 0.3], (*merl.SHAPE, 3)).copy()
    table[5] = -1.0
    merl.write_table(path, table)


def rgl_fields(*, azimuths: int = 1, wavelengths: int = 0, size: int = 16, seed: int = RNG_SEED) -> dict:
    """Smooth random fields that an RGL file could hold; anisotropic ones span the full circle."""
    rng = np.random.default_rng(seed)
    theta = np.linspace(0.0, 1.3, 6) if azimuths == 1 else np.linspace(0.1, 1.2, 4)
    phi = np.zeros(1) if azimuths == 1 else np.linspace(-np.pi, np.pi, azimuths)
    grid = (len(phi), len(theta))
    v, u = np.meshgrid(np.linspace(0, 1, size), np.linspace(0, 1, size), indexing="ij")
    # A lobe of half vectors about the normal (small u) over a floor, wider for some directions.
    width = rng.uniform(0.2, 0.5, (*grid, 1, 1))
    vndf = np.exp(-((u / width) ** 2)) * (1.5 + np.sin(2 * np.pi * v)) * (u + 0.05) + 0.01
    channels = wavelengths or 3
    color = rng.uniform(0.6, 1.4, (*grid, channels, size, size))
    # The same direction has the same value: both ends of the azimuth, and all azimuths at the pole.
    color[..., -1, :] = color[..., 0, :]
    color[..., 0] = color[..., :1, 0]
    if azimuths > 1:
        vndf[-1], color[-1] = vndf[0], color[0]
    else:
        # At normal incidence there is no azimuth to refer to.
        vndf[:, 0], color[:, 0] = vndf[:, 0].mean(axis=1, keepdims=True), color[:, 0, :, :1]
    fields = {
        "description": np.frombuffer(b"a made material", np.uint8),
        "theta_i": theta,
        "phi_i": phi,
        "ndf": np.exp(-((u / 0.5) ** 2)) + 0.02 * (1.0 + (u * np.cos(2 * np.pi * v) if azimuths > 1 else 0.0)),
        "sigma": 0.4 + 0.3 * u + (0.05 * np.cos(2 * np.pi * v) if azimuths > 1 else 0.0),
        "vndf": vndf,
        "luminance": color.mean(axis=2),
        "jacobian": np.ones(1, np.uint8),
    }
    fields |= {"spectra": color, "wavelengths": np.linspace(400, 700, channels)} if wavelengths else {"rgb": color}
    return {name: a if a.dtype == np.uint8 else a.astype(np.float32) for name, a in fields.items()}


def rgl_file(path: Path) -> None:
    tensor_file.write_fields(path, rgl_fields(size=4))


MAKERS = {
    "paint.mbsdf": mbsdf_file,
    "paint.binary": merl_file,
    "paint.bsdf": rgl_file,
}
"""By file name: how to make it."""
