r"""RGL's container of named arrays: ``tensor_file``, version 1.0 (Dupuy and Jakob 2018).

Layout, little-endian: ``tensor_file\0``, bytes 1 and 0 (the version), uint32 number of fields; then per field uint16
length of the name, the name, uint16 rank, uint8 type, uint64 offset of its data, uint64 for each size. Types: 1 u8,
2 i8, 3 u16, 4 i16, 5 u32, 6 i32, 7 u64, 8 i64, 9 f16, 10 f32, 11 f64.
"""

import math
import os
import struct
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from axffit.errors import InputError
from axffit.measured.files import read_bytes, write_whole

MAGIC = b"tensor_file\0"
VERSION = b"\x01\x00"
TYPES = {
    1: "<u1",
    2: "<i1",
    3: "<u2",
    4: "<i2",
    5: "<u4",
    6: "<i4",
    7: "<u8",
    8: "<i8",
    9: "<f2",
    10: "<f4",
    11: "<f8",
}
_MOST_FIELDS, _HIGHEST_RANK = 1000, 16
_ALIGNMENT = 8


def read_fields(path: str | os.PathLike) -> dict[str, np.ndarray]:
    """The arrays of a tensor file by name.

    Raises:
        InputError: the file cannot be read, has another header or version, or a field does not lie inside it.
    """
    path = Path(path)
    data = read_bytes(path, ".bsdf (tensor file)")
    start = len(MAGIC) + len(VERSION)
    if not data.startswith(MAGIC):
        raise InputError(f"{path}: not a tensor file: it starts with {data[:12]!r}, expected {MAGIC!r}")
    if data[len(MAGIC) : start] != VERSION:
        raise InputError(f"{path}: version {tuple(data[len(MAGIC) : start])} of the tensor file; only (1, 0) is known")
    (count,), position = _unpack(path, data, "<I", start)
    if not 1 <= count <= _MOST_FIELDS:
        raise InputError(
            f"{path}: {count} fields in the header, 1 to {_MOST_FIELDS} expected; is the byte order little-endian?"
        )
    fields = {}
    for _ in range(count):
        (length,), position = _unpack(path, data, "<H", position)
        (raw,), position = _unpack(path, data, f"{length}s", position)
        (rank, kind, offset), position = _unpack(path, data, "<HBQ", position)
        name = raw.decode("ascii", "replace")
        if kind not in TYPES or rank > _HIGHEST_RANK:
            raise InputError(f"{path}: field {name!r} has type {kind}, rank {rank}; allowed are 1 to 11, 0 to 16")
        shape, position = _unpack(path, data, f"<{rank}Q", position)
        size = math.prod(shape)
        end = offset + size * np.dtype(TYPES[kind]).itemsize
        if end > len(data):
            raise InputError(
                f"{path}: truncated: field {name!r} ends at byte {end}, the file has {len(data)}; copy the file again"
            )
        fields[name] = np.frombuffer(data, TYPES[kind], size, offset).reshape(shape) if size else np.empty(shape)
    return fields


def _unpack(path: Path, data: bytes, form: str, position: int) -> tuple[tuple, int]:
    end = position + struct.calcsize(form)
    if end > len(data):
        raise InputError(f"{path}: truncated: {len(data)} bytes, the header goes on; copy the file again")
    return struct.unpack_from(form, data, position), end


def write_fields(path: str | os.PathLike, fields: Mapping[str, np.ndarray]) -> None:
    """Write arrays as a tensor file, each in its own type.

    Raises:
        ValueError: an array's type is none of the format's.
    """
    kinds = {np.dtype(text): kind for kind, text in TYPES.items()}
    arrays = {name: np.ascontiguousarray(array).reshape(np.shape(array)) for name, array in fields.items()}
    for name, array in arrays.items():
        if array.dtype.newbyteorder("<") not in kinds:
            raise ValueError(f"{name} has type {array.dtype}: give integers of 8 to 64 bits or floats of 16 to 64")
    size = len(MAGIC + VERSION) + 4 + sum(13 + len(name.encode()) + 8 * array.ndim for name, array in arrays.items())
    header, body = [MAGIC + VERSION + struct.pack("<I", len(arrays))], []
    position = size
    for name, array in arrays.items():
        padding = -position % _ALIGNMENT
        kind = kinds[array.dtype.newbyteorder("<")]
        header.append(struct.pack(f"<H{len(name.encode())}sHB", len(name.encode()), name.encode(), array.ndim, kind))
        header.append(struct.pack(f"<Q{array.ndim}Q", position + padding, *array.shape))
        body.append(bytes(padding) + array.astype(TYPES[kind]).tobytes())
        position += len(body[-1])
    write_whole(path, b"".join(header + body))
