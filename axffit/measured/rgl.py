"""RGL ``.bsdf``: BRDFs measured where they vary, on a grid warped by the visible microfacets (Dupuy and Jakob 2018).

A tensor file with ``theta_i`` [T], ``phi_i`` [P] (P <= 2: isotropic), ``ndf`` and ``sigma`` (2-D), ``vndf`` and
``luminance`` [P, T, n, n], ``spectra`` [P, T, W, n, n] with ``wavelengths`` [W] in nm, or ``rgb`` [P, T, 3, n, n], and
``description``. With u = (sqrt(2 theta / pi), (phi + pi) / (2 pi)), phi_m - phi_i in place of phi_m where isotropic,
the half vector's u_m is the warp by ``vndf`` of a node of the regular n x n grid, and

    f cos theta_o = spectra(node) ndf(u_m) / (4 sigma(u_i))

(without the factor where ``jacobian`` is 0). The samples are these nodes: nothing of the measurement is interpolated.
``luminance`` only serves renderers for drawing directions. wi is the light.
"""

import os
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from axffit.errors import InputError
from axffit.measured.angles import cell_edges, direction, polar_cells
from axffit.measured.measurements import Measurements, RGBChannels, Wavelengths
from axffit.measured.tensor_file import read_fields
from axffit.measured.warp import bilinear, sample

LEAST_COSINE = 1e-3
"""Samples whose viewer has a smaller cosine are invalid: the stored product says nothing there."""

_ISOTROPIC_AZIMUTHS = 2
_RANKS = {"theta_i": 1, "phi_i": 1, "ndf": 2, "sigma": 2, "vndf": 4, "luminance": 4}


def checked_fields(path: str | os.PathLike) -> dict[str, np.ndarray]:
    """The fields of a ``.bsdf`` file, float64, whose shapes agree with each other.

    Raises:
        InputError: the file is no tensor file, a field is missing, or shapes or values cannot be.
    """
    path = Path(path)
    raw = read_fields(path)
    color = "spectra" if "spectra" in raw else "rgb"
    missing = sorted({*_RANKS, color, *(["wavelengths"] if color == "spectra" else [])} - raw.keys())
    if missing:
        raise InputError(f"{path}: holds no {', '.join(missing)}; an RGL .bsdf needs {', '.join(_RANKS)} and a color")
    description = raw.get("description", np.empty(0, np.uint8))
    fields = {name: array.astype(np.float64) for name, array in raw.items() if name != "description"}
    shapes = {name: array.shape for name, array in fields.items()}
    for name, rank in (*_RANKS.items(), (color, 5)):
        if len(shapes[name]) != rank:
            raise InputError(f"{path}: {name} has shape {shapes[name]}; an RGL .bsdf has rank {rank} there")
        if not np.isfinite(fields[name]).all():
            raise InputError(f"{path}: {name} holds values that are not finite; copy the file again")
    grid = (*shapes["phi_i"], *shapes["theta_i"])
    channels = shapes["wavelengths"] if color == "spectra" else (3,)
    expected = {"vndf": (*grid, *shapes["vndf"][2:]), "luminance": (*grid, *shapes["luminance"][2:])}
    expected[color] = (*grid, *channels, *shapes["luminance"][2:])
    for name, shape in expected.items():
        if shapes[name] != shape:
            raise InputError(f"{path}: {name} has shape {shapes[name]}; with the other fields it must be {shape}")
    if min(min(shapes[name][-2:]) for name in ("ndf", "sigma", "vndf", "luminance")) < 2:
        raise InputError(f"{path}: a table of fewer than 2 x 2 values; copy the file again")
    for name in ("theta_i", "phi_i"):
        if not (np.diff(fields[name]) > 0).all():
            raise InputError(f"{path}: {name} does not rise: {fields[name].tolist()}")
    if not (fields["theta_i"][0] >= 0 and fields["theta_i"][-1] < np.pi / 2):
        raise InputError(f"{path}: theta_i reaches {fields['theta_i'][-1]:g}; radians in [0, pi/2) are allowed")
    if min(fields["vndf"].min(), fields["ndf"].min()) < 0 or not (fields["vndf"].sum(axis=(2, 3)) > 0).all():
        raise InputError(f"{path}: vndf or ndf holds negative densities, or none at all; copy the file again")
    fields["description"] = description
    return fields


def read(path: str | os.PathLike) -> Measurements:
    """The measured directions of a ``.bsdf`` file: P · T · n · n samples (P = 1 where isotropic).

    Raises:
        InputError: as :func:`checked_fields`.
    """
    path = Path(path)
    fields = checked_fields(path)
    spectral = "spectra" in fields
    isotropic = len(fields["phi_i"]) <= _ISOTROPIC_AZIMUTHS
    azimuths = fields["phi_i"][:1] if isotropic else fields["phi_i"]
    polar = polar_cells(fields["theta_i"])
    width = np.diff(cell_edges(azimuths, -np.inf, np.inf)) if not isotropic else np.ones(1)
    parts = [
        _slice(fields, p, t, polar[t] * width[p], isotropic=isotropic)
        for p in range(len(azimuths))
        for t in range(len(polar))
    ]
    wi, wo, values, valid, weights = (np.concatenate(column) for column in zip(*parts, strict=True))
    channels = Wavelengths(fields["wavelengths"]) if spectral else RGBChannels(white="D65")
    size = fields["luminance"].shape[2:]
    provenance = {
        "file": path.name,
        "format": f"RGL .bsdf, {'isotropic' if isotropic else 'anisotropic'}, {'spectral' if spectral else 'RGB'}",
        "grid": f"{len(azimuths)} x {len(polar)} incidences, {size[1]} x {size[0]} warped half vectors each: the nodes",
        "cosine": f"f cos(theta_o) as stored, divided by cos(theta_o); invalid below {LEAST_COSINE:g}",
        "noise": "not stated by the file",
    }
    if not spectral:
        provenance["color"] = "RGB as stored, taken as linear sRGB with D65; the file states no space"
    words = bytes(fields["description"].astype(np.uint8)).decode("utf-8", "replace").strip("\0 \n")
    if words:
        provenance["description"] = words
    return Measurements(wi, wo, values, valid, weights, None, channels, provenance, path.stem)


def _slice(
    fields: Mapping[str, np.ndarray], p: int, t: int, incident: float, *, isotropic: bool
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """wi, wo, values, valid and weights of one direction of light; ``incident`` is the solid angle it stands for."""
    theta_i, phi_i = fields["theta_i"][t], fields["phi_i"][p]
    rows, columns = fields["luminance"].shape[2:]
    y, x = (a.ravel() for a in np.meshgrid(np.linspace(0, 1, rows), np.linspace(0, 1, columns), indexing="ij"))
    u, v, density = sample(fields["vndf"][p, t], x, y)
    theta_m = 0.5 * np.pi * u * u
    half = direction(theta_m, 2.0 * np.pi * v - np.pi + (phi_i if isotropic else 0.0))
    light = direction(theta_i, phi_i)
    cosine = half @ light
    wo = 2.0 * cosine[:, None] * half - light
    wo /= np.linalg.norm(wo, axis=1, keepdims=True)
    stored = fields["spectra" if "spectra" in fields else "rgb"][p, t].reshape(-1, rows * columns).T
    factor = np.ones(rows * columns)
    if fields.get("jacobian", np.ones(1)).any():
        u_i = np.array([np.sqrt(2.0 * theta_i / np.pi), (phi_i + np.pi) / (2.0 * np.pi)])
        area = bilinear(fields["sigma"], u_i[:1], u_i[1:])[0]
        factor = bilinear(fields["ndf"], u, v) / (4.0 * area) if area > 0 else np.full(rows * columns, np.nan)
    seen = (wo[:, 2] >= LEAST_COSINE) & (cosine > 0)
    values = stored * (factor / np.where(seen, wo[:, 2], 1.0))[:, None]
    # Of the cell of a node: half at the edges. Then du_m / du, d(omega_m) / du_m and d(omega_o) / d(omega_m).
    cell = np.outer(*(np.diff(cell_edges(np.linspace(0, 1, n), 0.0, 1.0)) for n in (rows, columns))).ravel()
    spread = 2.0 * np.pi**2 * u * np.sin(theta_m) * 4.0 * np.maximum(cosine, 0.0)
    weights = incident * cell * spread / np.maximum(density, 1e-12 * density.max())
    return np.broadcast_to(light, wo.shape), wo, values, seen & np.isfinite(values).all(axis=1), weights
