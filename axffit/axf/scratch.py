"""Large arrays outside of memory: ordinary NumPy arrays whose pages lie in a temporary file.

The maps of a 4096² material, its codes and what comes back are 4 GiB together. Each is worked on from one end to the
other, so only the part at hand needs memory: `empty` makes an array whose pages the system can take back, and
`let_go` gives them back at once. Its values stay, and any later use brings them in again.

The file has no name and goes with the array. It lies where `tempfile` puts files (``TMPDIR``); a folder in memory
(tmpfs) saves nothing. Where the system cannot promise room for it, the array is an ordinary one in memory.
"""

import math
import mmap
import os
import tempfile
from typing import Any

import numpy as np

LARGE = 2**22
"""Bytes from which on an array goes to a file: below, all maps of a material together are no burden."""


class _Pages(mmap.mmap):
    """A mapping of our own: to give back pages of another kind could lose what they hold."""


def empty(shape: tuple[int, ...], dtype: Any) -> np.ndarray:
    """An array to be filled, in memory or (from `LARGE` bytes on) in a temporary file."""
    dtype = np.dtype(dtype)
    size = math.prod(shape) * dtype.itemsize
    if size >= LARGE and hasattr(os, "posix_fallocate"):
        try:
            with tempfile.TemporaryFile(prefix="axffit-") as file:
                # Without room for all of it a later write would end the process.
                os.posix_fallocate(file.fileno(), 0, size)
                pages = _Pages(file.fileno(), size)
        except OSError:
            pass
        else:
            return np.frombuffer(pages, dtype).reshape(shape)
    return np.empty(shape, dtype)


def let_go(*arrays: np.ndarray) -> None:
    """Give back the memory of arrays made by `empty`, or of what they are views of; nothing happens to any other."""
    for array in arrays:
        owner: Any = array
        while isinstance(owner, np.ndarray):
            owner = owner.base
        if isinstance(owner, memoryview):
            owner = owner.obj
        if isinstance(owner, _Pages) and hasattr(mmap, "MADV_DONTNEED"):
            owner.madvise(mmap.MADV_DONTNEED)
