"""Global heaps of an HDF5 file, looked at before libhdf5 does.

Texts and lists of any length lie in global heaps ("GCOL"), collections of objects one behind the other. libhdf5 walks
a collection by the sizes that it states and never returns from an object of total size 0 (seen in HDF5 2.0.0: free
space of size 0, found by changed bytes), so that a file of one wrong byte would hang whoever reads a text of it.

Layout (HDF5 File Format Specification, III.E): signature, version 1, 3 reserved bytes, size of the collection; then
for each object its index (2 bytes), reference count (2), reserved (4), size, and the data padded to 8 bytes. Index 0
is free space, whose size includes its header.
"""

import mmap
from pathlib import Path

from ..errors import InputError

_SIGNATURE = b"GCOL\1"
_HEADER = 16
"""Bytes of a collection's and of an object's header; sizes of 4 bytes are padded to as many."""


def check_heaps(path: str | Path, size_bytes: int) -> None:
    """Refuse a file with a heap in which libhdf5 would not come to an end.

    Args:
        path: the file.
        size_bytes: how many bytes the file writes a size in (superblock).

    Raises:
        InputError: a heap has an object of total size 0.
    """
    with open(path, "rb") as stream, mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as content:
        start = content.find(_SIGNATURE)
        while start >= 0:
            if not _ends(content, start, size_bytes):
                raise InputError(f"damaged: the heap at byte {start} has an object of size 0; get a fresh copy")
            start = content.find(_SIGNATURE, start + 1)


def _ends(content: mmap.mmap, start: int, size_bytes: int) -> bool:
    """Whether a walk through the collection that starts there comes to an end."""

    def size_at(place: int) -> int:
        return int.from_bytes(content[place : place + size_bytes], "little")

    end = min(start + size_at(start + 8), len(content))
    place = start + _HEADER
    while place + _HEADER <= end:
        free = content[place : place + 2] == b"\0\0"
        size = size_at(place + 8)
        # In 64 bits, as libhdf5 adds: a size near 2^64 comes round to 0.
        step = (size if free else _HEADER + (size + 7 & ~7)) % 2**64
        if step == 0:
            return False
        place += step
    return True
