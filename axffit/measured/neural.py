"""Neural encodings of measured BRDFs (Sztrajman et al., CGF 40(6), 2021): 675 weights a material, many in one file.

File: an ``.npz`` with ``names`` (n,) and ``weights`` (n, 675). A weight vector is fc1 6x21, b1 21, fc2 21x21, b2 21,
fc3 21x3, b3 3, matrices row-major and applied as x @ W. The encodings are smooth approximations: no measurement noise,
and not the raw samples.
"""

import os
import zipfile
from pathlib import Path

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from axffit._types import RGB, Direction
from axffit.brdf.base import as_parameter
from axffit.errors import InputError
from axffit.frames import directions_to_half_difference
from axffit.measured.evaluated import AbstractMeasuredBRDF
from axffit.measured.grid import HalfDifferenceGrid, reference_grid
from axffit.measured.measurements import Measurements, RGBChannels

WEIGHT_COUNT = 675
_LAYERS = ((6, 21), (21, 21), (21, 3))


class NeuralEncoding(AbstractMeasuredBRDF):
    """One material: f = max(exp(network(x)) - 1, 0), 1/sr, linear RGB, without the cosine.

    x = (h, d), half and difference vector with phi_h = 0: (sin theta_h, 0, cos theta_h, sin theta_d cos phi_d,
    sin theta_d sin phi_d, cos theta_d); two hidden layers of 21 rectified units. ``weights`` (675,).
    """

    weights: Float[Array, "675"] = eqx.field(converter=as_parameter)

    def value(self, wi: Direction, wo: Direction) -> RGB:
        """The network's value; phi_d is folded into [0, pi) (reciprocity), the range the encodings were fitted on."""
        theta_h, theta_d, phi_d, _ = directions_to_half_difference(wi, wo)
        phi_d = jnp.where(phi_d < 0, phi_d + jnp.pi, phi_d)
        half = [jnp.sin(theta_h), jnp.zeros_like(theta_h), jnp.cos(theta_h)]
        difference = [jnp.sin(theta_d) * jnp.cos(phi_d), jnp.sin(theta_d) * jnp.sin(phi_d), jnp.cos(theta_d)]
        x, start = jnp.stack(half + difference), 0
        for rows, columns in _LAYERS:
            matrix = self.weights[start : start + rows * columns].reshape(rows, columns)
            start += rows * columns
            x = x @ matrix + self.weights[start : start + columns]
            start += columns
            x = x if columns == 3 else jax.nn.relu(x)
        return jnp.maximum(jnp.expm1(x), 0.0)


def read_weights(path: str | os.PathLike) -> dict[str, np.ndarray]:
    """Weight vectors (675,) float64 by material name, in the file's order.

    Raises:
        InputError: the file is missing or damaged, or holds other arrays than ``names`` (n,) and ``weights`` (n, 675).
    """
    path = Path(path)
    try:
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as file:
            arrays = {key: file[key] for key in file.files} if isinstance(file, np.lib.npyio.NpzFile) else {}
    except (OSError, ValueError, EOFError, KeyError, zipfile.BadZipFile) as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise InputError(f"{path}: cannot be read as .npz ({reason}); copy the file again") from None
    names, weights = arrays.get("names"), arrays.get("weights")
    if names is None or weights is None:
        raise InputError(
            f"{path}: holds arrays {sorted(arrays)}; "
            f"neural encodings need 'names' (n,) and 'weights' (n, {WEIGHT_COUNT})"
        )
    if names.ndim != 1 or names.dtype.kind not in "US" or weights.shape != (len(names), WEIGHT_COUNT):
        raise InputError(
            f"{path}: 'names' has shape {names.shape} and type {names.dtype}, 'weights' {weights.shape}; "
            f"expected text (n,) and (n, {WEIGHT_COUNT})"
        )
    if weights.dtype.kind != "f" or not np.all(np.isfinite(weights)):
        raise InputError(f"{path}: 'weights' must be finite floating-point numbers, got {weights.dtype}")
    labels = [name.decode() if isinstance(name, bytes) else str(name) for name in names]
    return dict(zip(labels, weights.astype(np.float64), strict=True))


def interpolant(path: str | os.PathLike, material: str | None = None) -> NeuralEncoding:
    """The encoding of one material as a BRDF; ``material`` may be left out where the file holds only one.

    Raises:
        InputError: as :func:`read_weights`, or the material is not in the file.
    """
    materials = read_weights(path)
    if material is None and len(materials) == 1:
        material = next(iter(materials))
    if material not in materials:
        wanted = "holds several materials" if material is None else f"has no material {material!r}"
        raise InputError(f"{path}: {wanted}; name one of: {', '.join(sorted(materials))}")
    with jax.enable_x64(new_val=True):
        return NeuralEncoding(materials[material])


def read(
    path: str | os.PathLike, material: str | None = None, *, grid: HalfDifferenceGrid | None = None
) -> Measurements:
    """One material sampled on ``grid`` (the reference grid by default).

    Raises:
        InputError: as :func:`interpolant`.
    """
    encoding = interpolant(path, material)
    grid = reference_grid() if grid is None else grid
    with jax.enable_x64(new_val=True):
        values = np.array(eqx.filter_jit(lambda e, wi, wo: e.evaluate(wi, wo))(encoding, grid.wi, grid.wo))
    name = material if material is not None else next(iter(read_weights(path)))
    provenance = {
        "file": f"{Path(path).name}: {name}",
        "format": "neural encoding, 675 weights (Sztrajman et al. 2021): a smooth approximation of the measurement",
        "grid": f"{len(grid.wi)} directions of a half/difference grid",
        "cosine": "values are f without the cosine, as encoded",
        "noise": "none: the encoding is smooth",
    }
    return Measurements(
        grid.wi, grid.wo, values, np.ones(len(grid.wi), bool), grid.weights, None, RGBChannels(), provenance, name
    )
