"""The table of formats: how each is recognized, by content and then by suffix, and who reads it."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from axffit.errors import InputError
from axffit.measured import (
    alta,
    astm,
    mbsdf,
    merl,
    multiangle,
    neural,
    nist,
    plain_csv,
    rgl,
    tensor_file,
    utia,
    zemax,
)
from axffit.measured.csv_table import header_names
from axffit.measured.measurements import Measurements

HEAD = 1 << 16
"""Bytes of a file that recognition sees."""

_ZIP = b"PK\x03\x04"


class Format(NamedTuple):
    """A kind of file.

    Attributes:
        name: for people.
        recognizes: whether the first `HEAD` bytes and the size of a file are those of this kind.
        suffixes: that are tried where no content is recognized, so that the reader itself says what is wrong.
        read: the reader; takes the path and the name of a material where `named`.
        named: whether a file may hold several materials.
    """

    name: str
    recognizes: Callable[[bytes, int], bool]
    suffixes: tuple[str, ...]
    read: Callable[..., Measurements]
    named: bool = False


def _text(head: bytes) -> str:
    """The beginning of a file as text, its last line dropped where it may be cut off; empty for binary files."""
    if b"\0" in head:
        return ""
    return (head[: head.rindex(b"\n")] if len(head) == HEAD and b"\n" in head else head).decode("utf-8-sig", "replace")


def _begins_a_line(*words: str) -> Callable[[bytes, int], bool]:
    """Recognizes text with a line that begins with one of ``words``."""
    return lambda head, _: any(line.split()[:1] in ([word] for word in words) for line in _text(head).splitlines())


def _has_columns(recognizes: Callable[[list[str]], bool]) -> Callable[[bytes, int], bool]:
    """Recognizes CSV by the names of its columns."""
    return lambda head, _: recognizes(header_names(_text(head)))


def _is_utia(head: bytes, size: int) -> bool:
    return size == utia.SIZE or head.startswith(utia.EXR_MAGIC)


FORMATS = (
    Format("NVIDIA .mbsdf", lambda head, _: head.startswith(mbsdf.MAGIC), (".mbsdf",), mbsdf.read),
    Format("neural encodings .npz", lambda head, _: head.startswith(_ZIP), (".npz",), neural.read, named=True),
    Format("MERL .binary", lambda head, _: head.startswith(merl.HEADER), (".binary",), merl.read),
    Format("RGL .bsdf", lambda head, _: head.startswith(tensor_file.MAGIC), (".bsdf",), rgl.read),
    Format("UTIA .bin or .exr", _is_utia, (".bin", ".exr"), utia.read),
    Format("Zemax BSDF text", _begins_a_line("ScatterType", "ScatterRadial"), (".zemax",), zemax.read),
    Format("ASTM E1392 text", _begins_a_line("VARS"), (".astm",), astm.read),
    Format("ALTA text", _begins_a_line("#DIM", "#PARAM_IN"), (".alta",), alta.read),
    Format("NIST PTFE CSV", _has_columns(nist.recognizes), (), nist.read),
    Format("multi-angle CSV", _has_columns(multiangle.recognizes), (), multiangle.read),
    Format("plain CSV", _has_columns(plain_csv.recognizes), (".csv", ".txt"), plain_csv.read),
)


def format_of(path: Path) -> Format:
    """The format of a file, by content, then by suffix.

    Raises:
        InputError: the file cannot be read, is empty, or is of no known format.
    """
    known = ", ".join(form.name for form in FORMATS)
    try:
        with path.open("rb") as file:
            head = file.read(HEAD)
            size = path.stat().st_size
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error}); give one of: {known}") from None
    if not head:
        raise InputError(f"{path}: the file is empty; give one of: {known}")
    for form in FORMATS:
        if form.recognizes(head, size):
            return form
    for form in FORMATS:
        if path.suffix.lower() in form.suffixes:
            return form
    raise InputError(f"{path}: no known sample format (starts with {head[:24]!r}); give one of: {known}")
