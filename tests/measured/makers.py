"""Small valid files of every format, for the laws that all readers obey."""

from pathlib import Path

import numpy as np

from axffit.measured import mbsdf, merl, tensor_file, utia
from axffit.measured.files import as_text

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


def utia_file(path: Path) -> None:
    utia.write_table(path, np.random.default_rng(RNG_SEED).uniform(0.01, 2.0, (utia.COUNT, utia.COUNT, 3)))


ZEMAX_HEADER = """# made
Source Measured
Symmetry PlaneSymmetrical
SpectralContent Monochrome
ScatterType BRDF
SampleRotation 1
0
AngleOfIncidence 2
15 45
ScatterAzimuth 3
0 90 180
ScatterRadial 4
0 10 30 60
"""


def zemax_values() -> np.ndarray:
    """Values (incidence 2, azimuth 3, radial 4), zero beyond the horizon."""
    values = np.arange(24.0).reshape(2, 3, 4) + 1.0
    values[1, 2, 3] = 0.0
    return values


def zemax_file(path: Path) -> None:
    blocks = [f"TIS {0.5 + k}\n" + as_text(block, "\t") for k, block in enumerate(zemax_values())]
    path.write_text(ZEMAX_HEADER + "Monochrome\nDataBegin\n" + "".join(blocks) + "DataEnd\n")


ASTM_HEADER = """LAB_NAME made
SAMPLE_NAME "a paint"
NUM_POINTS 3
VARS theta_i,phi_i,theta_s,phi_s,465nm,525nm,630nm
"""
ASTM_ROWS = [
    [0.1, 0, 0.2, 3, 0.11, 0.12, 0.13],
    [0.5, 1, 0.6, -1, 0.21, 0.22, 0.23],
    [1.0, 0.0, 1.2, 0.5, 1, 2, 3],
]


def astm_file(path: Path) -> None:
    path.write_text(ASTM_HEADER + as_text(ASTM_ROWS))


def alta_file(path: Path) -> None:
    rows = [[0.3, 0.4, 0.1, 0.5], [0.3, -0.4, 0.2, 0.6], [0.8, 0.0, 0.0, 0.7]]
    header = '#SAMPLE "tape"\n#DIM 3 1\n#PARAM_IN ISOTROPIC_TL_TV_PROJ_DPHI\n#PARAM_OUT INV_STERADIAN_COSINE_FACTOR\n'
    path.write_text(header + as_text(rows, "  "))


def nist_file(path: Path) -> None:
    angles = [[-0.001, 0, 60, -170], [-75, 0, 75, 0], [-75, 0, 30, 90]]
    rows = [[w, *a, 0.3 + 0.01 * k, 0.5] for w in (0.351, 0.532) for k, a in enumerate(angles)]
    path.write_text("lambda,thetai,phi,thetar,phir,f_r11,f_r12/f_r11\n" + as_text(rows))


MULTIANGLE_ROWS = {"45as-15": 0.9, "45as15": 1.2, "45as25": 0.6, "45as45": 0.3, "45as75": 0.2, "45as110": 0.15}


def multiangle_file(path: Path) -> None:
    rows = "".join(f"{name},{r},{r / 2},{r / 4}\n" for name, r in MULTIANGLE_ROWS.items())
    path.write_text("# instrument: made\ngeometry,R,G,B\n" + rows)


PLAIN_ROWS = [[10, 0, 20, 180, 0.3], [30, 20, 40, 200, 0.2], [60, 0, 60, 180, 4.5]]


def plain_file(path: Path) -> None:
    path.write_text("# name: made\ntheta_i,phi_i,theta_o,phi_o,f\n" + as_text(PLAIN_ROWS))


MAKERS = {
    "paint.mbsdf": mbsdf_file,
    "paint.binary": merl_file,
    "paint.bsdf": rgl_file,
    "paint.bin": utia_file,
    "paint.zemax": zemax_file,
    "paint.astm": astm_file,
    "paint.alta": alta_file,
    "ptfe.csv": nist_file,
    "multiangle.csv": multiangle_file,
    "plain.csv": plain_file,
}
"""By file name: how to make it."""
