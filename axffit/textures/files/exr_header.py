"""The headers and chunk tables of an OpenEXR file, checked before its library is asked for pixels.

OpenEXR opens a file whose end is missing without an error, leaves parts out, and prints to stderr. So the structure
is checked here (OpenEXR, "File Layout"): every declared chunk must lie within the file, and no part may declare more
than such a file can hold.
"""

import struct
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from ...errors import InputError
from .image import check_bytes, check_size

_MAGIC = b"\x76\x2f\x31\x01"
_DEEP, _TILED, _MULTIPART = 0x800, 0x200, 0x1000
_MAXIMUM_PARTS = 2**16
# Scan lines of a chunk by compression: none, RLE, ZIPS, ZIP, PIZ, PXR24, B44, B44A, DWAA, DWAB.
_LINES = (1, 1, 1, 16, 32, 16, 32, 32, 32, 256)
_TYPES = ("uint", "half", "float")


@dataclass(frozen=True)
class Part:
    """One part of a file.

    Attributes:
        name: its name, "" in a file of one part.
        width: texels along u.
        height: texels along v.
        channels: channel names to "uint", "half" or "float".
        format: the number format axffit noted, or "".
    """

    name: str
    width: int
    height: int
    channels: Mapping[str, str]
    format: str

    @property
    def texel_bytes(self) -> int:
        """Bytes of a texel, uncompressed."""
        return sum(2 if kind == "half" else 4 for kind in self.channels.values())


def parts_of(path: Path, content: bytes) -> list[Part]:
    """The parts of a scan-line file that is whole.

    Raises:
        InputError: it is no such file, cut off, damaged, or of a kind that is not read.
    """
    if content[:4] != _MAGIC:
        raise InputError(f"{path}: no OpenEXR file; its first bytes are {content[:4]!r}")
    try:
        return _parts(path, content)
    except (struct.error, IndexError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{path}: an OpenEXR file that is cut off or damaged in its headers") from error


def _parts(path: Path, content: bytes) -> list[Part]:
    (version,) = struct.unpack_from("<I", content, 4)
    if version & 0xFF != 2 or version & (_DEEP | _TILED):
        raise InputError(f"{path}: OpenEXR version and flags {version:#x}; only scan lines of version 2 are read")
    multiple = bool(version & _MULTIPART)
    headers, at = [], 8
    while True:
        header, at = _header(content, at)
        if multiple and not header:
            break
        headers.append(header)
        if not multiple:
            break
        if len(headers) > _MAXIMUM_PARTS:
            raise InputError(f"{path}: more than {_MAXIMUM_PARTS} parts; the file is damaged")
    parts = [_part(path, header, len(content)) for header in headers]
    check_bytes(path, sum(part.width * part.height * part.texel_bytes for part in parts), stored=len(content))
    for number, (part, header) in enumerate(zip(parts, headers, strict=True)):
        at = _check_chunks(path, content, at, _chunks(path, part, header), number if multiple else None)
    return parts


def _header(content: bytes, at: int) -> tuple[dict[str, bytes], int]:
    """Attributes of one header, and where the next begins."""
    attributes = {}
    while content[at]:
        name_end = content.index(0, at)
        type_end = content.index(0, name_end + 1)
        (size,) = struct.unpack_from("<i", content, type_end + 1)
        start = type_end + 5
        if size < 0 or start + size > len(content):
            raise ValueError("attribute beyond the file")
        attributes[content[at:name_end].decode("utf-8")] = content[start : start + size]
        at = start + size
    return attributes, at + 1


def _part(path: Path, header: Mapping[str, bytes], stored: int) -> Part:
    for required in ("channels", "dataWindow", "compression"):
        if required not in header:
            raise InputError(f"{path}: an OpenEXR header without {required}; the file is damaged")
    kind = header.get("type", b"scanlineimage")
    if kind != b"scanlineimage" or "tiles" in header:
        raise InputError(f"{path}: an OpenEXR part of type {kind.decode('latin-1')!r}; save it as scan lines")
    left, top, right, bottom = struct.unpack("<4i", header["dataWindow"])
    channels = dict(_channels(path, header["channels"]))
    part = Part(
        name=header.get("name", b"").decode("utf-8"),
        width=right - left + 1,
        height=bottom - top + 1,
        channels=channels,
        format=header.get("axffit.format", b"").decode("utf-8"),
    )
    check_size(path, part.width, part.height, 1, part.texel_bytes, stored=stored)
    return part


def _channels(path: Path, listed: bytes) -> list[tuple[str, str]]:
    channels, at = [], 0
    while listed[at]:
        end = listed.index(0, at)
        name = listed[at:end].decode("utf-8")
        kind, _, along_x, along_y = struct.unpack_from("<iI2i", listed, end + 1)
        if not 0 <= kind < len(_TYPES) or (along_x, along_y) != (1, 1):
            raise InputError(
                f"{path}: channel {name} has type {kind}, sampled {along_x} x {along_y}; allowed: 0-2, 1x1"
            )
        channels.append((name, _TYPES[kind]))
        at = end + 17
    return channels


def _chunks(path: Path, part: Part, header: Mapping[str, bytes]) -> int:
    compression = header["compression"][0]
    if compression >= len(_LINES):
        raise InputError(f"{path}: OpenEXR compression {compression}; save it with ZIP")
    return -(-part.height // _LINES[compression])


def _check_chunks(path: Path, content: bytes, at: int, count: int, part: int | None) -> int:
    """Refuses a chunk that lies beyond the file or belongs to another part; returns where the next table begins."""
    offsets = struct.unpack_from(f"<{count}Q", content, at)
    for offset in offsets:
        if not 0 < offset < len(content):
            raise InputError(f"{path}: an OpenEXR file that is cut off or was never finished: a chunk is missing")
        start = offset
        if part is not None:
            (owner,) = struct.unpack_from("<i", content, offset)
            if owner != part:
                raise InputError(f"{path}: a chunk of part {part} says it is of part {owner}; the file is damaged")
            start += 4
        _, size = struct.unpack_from("<2i", content, start)
        if size < 0 or start + 8 + size > len(content):
            raise InputError(f"{path}: an OpenEXR file that is cut off: a chunk of {size} bytes reaches beyond its end")
    return at + 8 * count
