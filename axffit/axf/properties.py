"""The properties of an AxF material and the types AxF stores them in."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import InputError


@dataclass(frozen=True)
class PropertyType:
    """How AxF stores a property: its numpy type, whether it is an array, and other names it goes by."""

    dtype: type
    array: bool = False
    aliases: tuple[str, ...] = ()

    def convert(self, value: Any, where: str) -> Any:
        """The value in AxF's own type: a numpy scalar, or a read-only one-dimensional array.

        Raises:
            InputError: the value is not a number (or a list of numbers), or does not fit the type.
        """
        given = np.asarray(value)
        if given.dtype.kind not in "iufb" or given.size == 0:
            raise InputError(f"{where}: {value!r} is not a number; give {self.wanted}")
        flat = given.reshape(-1)
        if not self.array and flat.size != 1:
            raise InputError(f"{where}: {flat.size} values where AxF has one; give {self.wanted}")
        if self.array and given.ndim > 1 and flat.size != max(given.shape):
            raise InputError(f"{where}: shape {given.shape} where AxF has a list; give {self.wanted}")
        if np.dtype(self.dtype).kind == "i":
            limits = np.iinfo(self.dtype)
            if not np.all(np.isfinite(flat)) or np.any(flat != np.trunc(flat)):
                raise InputError(f"{where}: {value!r} is not a whole number; give {self.wanted}")
            if np.any(flat.astype(np.float64) < limits.min) or np.any(flat.astype(np.float64) > limits.max):
                raise InputError(f"{where}: {value!r} does not fit 32 bits; give {self.wanted}")
        with np.errstate(over="ignore"):
            converted = flat.astype(self.dtype)
        if np.any(np.isfinite(flat) & ~np.isfinite(converted)):
            raise InputError(f"{where}: {value!r} does not fit float32; give {self.wanted}")
        if not self.array:
            return converted[0]
        converted.flags.writeable = False
        return converted

    @property
    def wanted(self) -> str:
        """The type in words."""
        number = "whole number" if np.dtype(self.dtype).kind == "i" else "number"
        return f"a list of {number}s" if self.array else f"one {number}"


PROPERTY_TYPES: Mapping[str, PropertyType] = {
    "CT_diffuse": PropertyType(np.float32),
    "CT_coeffs": PropertyType(np.float32, array=True, aliases=("CT_coefs", "CT_coefficients")),
    "CT_F0s": PropertyType(np.float32, array=True, aliases=("CT_F0",)),
    "CT_spreads": PropertyType(np.float32, array=True, aliases=("CT_spread",)),
    "num_thetaF": PropertyType(np.int32),
    "num_thetaI": PropertyType(np.int32),
    "max_thetaI": PropertyType(np.int32),
    "thetaFI_sliceLUT": PropertyType(np.int32, array=True),
    "IOR": PropertyType(np.float32),
    "cc_no_refraction": PropertyType(np.int32),
}
"""Every property by AxF's own spelling."""
