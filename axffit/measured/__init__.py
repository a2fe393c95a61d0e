"""Sampled BRDFs: every reader returns one :class:`Measurements`."""

import os
from pathlib import Path

from axffit.brdf.base import AbstractBRDF
from axffit.errors import InputError
from axffit.measured import mbsdf as mbsdf
from axffit.measured import neural as neural
from axffit.measured.color import to_rgb as to_rgb
from axffit.measured.formats import FORMATS as FORMATS
from axffit.measured.formats import Format as Format
from axffit.measured.formats import format_of as format_of
from axffit.measured.grid import HalfDifferenceGrid as HalfDifferenceGrid
from axffit.measured.grid import reference_grid as reference_grid
from axffit.measured.measurements import REC709_LUMINANCE as REC709_LUMINANCE
from axffit.measured.measurements import Measurements as Measurements
from axffit.measured.measurements import RGBChannels as RGBChannels
from axffit.measured.measurements import Wavelengths as Wavelengths
from axffit.measured.resampled import resampled as resampled


def _named(form: Format, path: Path, material: str | None) -> dict[str, str | None]:
    """The material as the reader takes it.

    Raises:
        InputError: the file holds one material of another name.
    """
    if form.named:
        return {"material": material}
    if material is not None and material != path.stem:
        raise InputError(f"{path}: holds one material and no {material!r}; leave the material out")
    return {}


def read(path: str | os.PathLike, material: str | None = None) -> Measurements:
    """The samples in ``path``; the format is recognized by content, then by suffix (`axffit.measured.FORMATS`).

    Args:
        path: a file of any format of the table; neural encodings are sampled on the reference grid.
        material: which one, for files that hold several.

    Raises:
        InputError: the file is missing, damaged or of no known format, or the material is not in it.
    """
    path = Path(path)
    form = format_of(path)
    return form.read(path, **_named(form, path, material))


def interpolant(path: str | os.PathLike, material: str | None = None) -> AbstractBRDF:
    """The samples in ``path`` as a BRDF that can be evaluated anywhere, for rendering and plots.

    Tables and neural encodings are interpolated as their formats say; other samples are `resampled`.

    Raises:
        InputError: as :func:`read`, or no sample is valid.
    """
    path = Path(path)
    form = format_of(path)
    named = _named(form, path, material)
    own = {mbsdf.read: mbsdf.interpolant, neural.read: neural.interpolant}.get(form.read)
    return resampled(form.read(path, **named)) if own is None else own(path, **named)
