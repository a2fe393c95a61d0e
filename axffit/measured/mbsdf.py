"""NVIDIA ``.mbsdf``: an isotropic BRDF on a regular grid of theta_in, theta_out and azimuth difference.

Layout: the ASCII header, then little-endian uint32 type (0 scalar, 1 RGB), theta count T and azimuth count P, then
float32 values indexed [theta_in, theta_out, azimuth, channel].

Values are f in 1/sr without the cosine, linear RGB. ``theta_in`` is taken as the light. Cells are sampled at their
centers, theta = (k + 1/2) 90° / T and azimuth = (k + 1/2) 180° / P, because that is where the format's own renderer
looks (normalized coordinates of a filtered 3-D texture); azimuth 0 is the retroreflective side, 180° the mirror side.
"""

import os
from pathlib import Path

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from axffit._types import RGB, Direction, Scalar
from axffit.brdf.base import as_parameter
from axffit.errors import InputError
from axffit.measured.evaluated import AbstractMeasuredBRDF
from axffit.measured.files import read_bytes, write_whole
from axffit.measured.measurements import Measurements, RGBChannels
from axffit.numerics import safe_atan2, safe_norm

HEADER = b"NVIDIA ARC MBSDF V1\nMBSDF_DATA_REFLECTION=\n"
MAGIC = HEADER.split(b" V1", 1)[0]
_CHANNELS = {0: 1, 1: 3}
_MAX_RESOLUTION = 4096


class MbsdfTable(AbstractMeasuredBRDF):
    """The table as a BRDF: trilinear between cell centers, held constant beyond the outer ones.

    ``values`` (T_in, T_out, P, 3), linear RGB, 1/sr.
    """

    values: Float[Array, "theta_in theta_out azimuth 3"] = eqx.field(converter=as_parameter)

    def value(self, wi: Direction, wo: Direction) -> RGB:
        """The interpolated value; the azimuth is that between the two directions, in [0, pi]."""
        along = wi[0] * wo[0] + wi[1] * wo[1]
        across = jnp.abs(wi[0] * wo[1] - wi[1] * wo[0])
        angles = (
            safe_atan2(safe_norm(wi[:2]), wi[2]) * 2.0,
            safe_atan2(safe_norm(wo[:2]), wo[2]) * 2.0,
            safe_atan2(across, along),
        )
        axes = [self._cell(angle / jnp.pi, size) for angle, size in zip(angles, self.values.shape[:3], strict=True)]
        (i0, i1, u), (j0, j1, v), (k0, k1, w) = axes
        corners = (
            (i, j, k, a * b * c)
            for i, a in ((i0, 1.0 - u), (i1, u))
            for j, b in ((j0, 1.0 - v), (j1, v))
            for k, c in ((k0, 1.0 - w), (k1, w))
        )
        return sum((weight * self.values[i, j, k] for i, j, k, weight in corners), jnp.zeros_like(wi))

    @staticmethod
    def _cell(unit: Scalar, size: int) -> tuple[Array, Array, Scalar]:
        position = jnp.clip(unit * size - 0.5, 0.0, size - 1)
        lower = jnp.floor(position)
        index = lower.astype(jnp.int32)
        return index, jnp.minimum(index + 1, size - 1), position - lower


def read_table(path: str | os.PathLike) -> np.ndarray:
    """The raw table (T, T, P, C) float32 of a ``.mbsdf`` file, C = 1 or 3.

    Raises:
        InputError: the file is missing, has another header or type, or not as many bytes as its header promises.
    """
    path = Path(path)
    data = read_bytes(path, ".mbsdf")
    start = len(HEADER) + 12
    if not data.startswith(HEADER):
        raise InputError(
            f"{path}: not a .mbsdf file: it starts with {data[:24]!r}, expected {HEADER[:24]!r}; "
            "give a version 1 file with a reflection part"
        )
    if len(data) < start:
        raise InputError(f"{path}: truncated: {len(data)} bytes, the header alone has {start}; copy the file again")
    kind, theta_count, azimuth_count = (int(x) for x in np.frombuffer(data, "<u4", 3, len(HEADER)))
    if kind not in _CHANNELS:
        raise InputError(f"{path}: type {kind} in the header; a .mbsdf holds 0 (scalar) or 1 (RGB)")
    if not (1 <= theta_count <= _MAX_RESOLUTION and 1 <= azimuth_count <= _MAX_RESOLUTION):
        raise InputError(
            f"{path}: resolution {theta_count} x {theta_count} x {azimuth_count} in the header; "
            f"each must be 1 to {_MAX_RESOLUTION}; is the byte order little-endian?"
        )
    shape = (theta_count, theta_count, azimuth_count, _CHANNELS[kind])
    expected = start + 4 * int(np.prod(shape, dtype=np.int64))
    if len(data) != expected:
        state = "truncated" if len(data) < expected else "too long"
        raise InputError(
            f"{path}: {state}: {len(data)} bytes, {expected} expected for {' x '.join(map(str, shape))} float32; "
            "copy the file again"
        )
    return np.frombuffer(data, "<f4", offset=start).reshape(shape).copy()


def write_table(path: str | os.PathLike, table: np.ndarray) -> None:
    """Write ``table`` (T, T, P, C), C = 1 or 3, as a ``.mbsdf`` file; never leaves a half-written one."""
    table = np.asarray(table)
    kinds = {channels: kind for kind, channels in _CHANNELS.items()}
    if table.ndim != 4 or table.shape[0] != table.shape[1] or table.shape[3] not in kinds:
        raise ValueError(f"table has shape {table.shape}: give (T, T, P, 1 or 3)")
    sizes = np.array([kinds[table.shape[3]], table.shape[0], table.shape[2]], "<u4")
    write_whole(path, HEADER + sizes.tobytes() + np.ascontiguousarray(table, "<f4").tobytes())


def grid_directions(theta_count: int, azimuth_count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Directions wi, wo and solid-angle weights sin theta_in · sin theta_out of every cell, in the file's order."""
    theta = (np.arange(theta_count) + 0.5) * (np.pi / 2) / theta_count
    azimuth = (np.arange(azimuth_count) + 0.5) * np.pi / azimuth_count
    t_in, t_out, phi = (a.ravel() for a in np.meshgrid(theta, theta, azimuth, indexing="ij"))
    wi = np.stack([np.sin(t_in), np.zeros_like(t_in), np.cos(t_in)], axis=1)
    wo = np.stack([np.sin(t_out) * np.cos(phi), np.sin(t_out) * np.sin(phi), np.cos(t_out)], axis=1)
    weights = np.sin(t_in) * np.sin(t_out)
    return wi, wo, weights / weights.sum()


def read(path: str | os.PathLike) -> Measurements:
    """A ``.mbsdf`` file as :class:`~axffit.measured.Measurements`; scalar files become gray RGB.

    Raises:
        InputError: as :func:`read_table`.
    """
    table = read_table(path)
    wi, wo, weights = grid_directions(table.shape[0], table.shape[2])
    values = np.broadcast_to(table.reshape(-1, table.shape[3]).astype(np.float64), (len(wi), 3))
    provenance = {
        "file": Path(path).name,
        "format": "NVIDIA .mbsdf, version 1, reflection part",
        "grid": f"{table.shape[0]} x {table.shape[1]} x {table.shape[2]} theta_in x theta_out x azimuth, cell centers",
        "channels": "scalar, repeated as gray" if table.shape[3] == 1 else "RGB as stored",
        "cosine": "values are f without the cosine, as stored",
        "light": "theta_in is taken as the light's",
        "noise": "not stated by the file",
    }
    return Measurements(
        wi, wo, values, np.ones(len(wi), bool), weights, None, RGBChannels(), provenance, Path(path).stem
    )


def interpolant(path: str | os.PathLike) -> MbsdfTable:
    """The file as a BRDF that can be evaluated anywhere, negative values clipped to 0."""
    table = np.maximum(read_table(path), 0.0)
    return MbsdfTable(np.broadcast_to(table, (*table.shape[:3], 3)))
