"""Sampled BRDFs: every reader returns one :class:`Measurements`."""

import os
from pathlib import Path

from axffit.brdf.base import AbstractBRDF
from axffit.errors import InputError
from axffit.measured import mbsdf as mbsdf
from axffit.measured import neural as neural
from axffit.measured.grid import HalfDifferenceGrid as HalfDifferenceGrid
from axffit.measured.grid import reference_grid as reference_grid
from axffit.measured.measurements import REC709_LUMINANCE as REC709_LUMINANCE
from axffit.measured.measurements import Measurements as Measurements
from axffit.measured.measurements import RGBChannels as RGBChannels
from axffit.measured.measurements import Wavelengths as Wavelengths

_ZIP = b"PK\x03\x04"
_KNOWN = "NVIDIA .mbsdf, neural encodings .npz"


def _format_of(path: Path) -> str:
    """``"mbsdf"`` or ``"neural"``, by the first bytes of the file."""
    try:
        with path.open("rb") as file:
            start = file.read(len(mbsdf.MAGIC))
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error}); give one of: {_KNOWN}") from None
    if not start:
        raise InputError(f"{path}: the file is empty; give one of: {_KNOWN}")
    if start == mbsdf.MAGIC:
        return "mbsdf"
    if start.startswith(_ZIP):
        return "neural"
    if path.suffix == ".mbsdf":
        # Leave the message to the reader: it says what the header should have been.
        return "mbsdf"
    raise InputError(f"{path}: no known sample format (starts with {start!r}); give one of: {_KNOWN}")


def _one_material(path: Path, material: str | None) -> None:
    if material is not None and material != path.stem:
        raise InputError(f"{path}: holds one material and no {material!r}; leave the material out")


def read(path: str | os.PathLike, material: str | None = None) -> Measurements:
    """The samples in ``path``; the format is recognized by content.

    Args:
        path: an NVIDIA ``.mbsdf`` or an ``.npz`` of neural encodings (sampled on the reference grid).
        material: which one, for files that hold several.

    Raises:
        InputError: the file is missing, damaged or of no known format, or the material is not in it.
    """
    path = Path(path)
    if _format_of(path) == "mbsdf":
        _one_material(path, material)
        return mbsdf.read(path)
    return neural.read(path, material)


def interpolant(path: str | os.PathLike, material: str | None = None) -> AbstractBRDF:
    """The samples in ``path`` as a BRDF that can be evaluated anywhere, for rendering and plots.

    Raises:
        InputError: as :func:`read`.
    """
    path = Path(path)
    if _format_of(path) == "mbsdf":
        _one_material(path, material)
        return mbsdf.interpolant(path)
    return neural.interpolant(path, material)
