"""The process that reads untrusted HDF5 first, started by `guard`.

Answers on the standard output to the lines of the standard input, each a path as JSON: `walking` now and then,
`declared <bytes>` when everything but the values was looked at, then `done`. What libhdf5 can say is wrong with a file
is not its concern; a file that makes libhdf5 crash ends the process, one that makes it loop leaves it without an
answer.
"""

import contextlib
import itertools
import json
import sys

from ..errors import InputError
from .hdf5 import Leaf, opened, walk

_FAILURES = (OSError, RuntimeError, ValueError, KeyError, TypeError, MemoryError)

_STEP = 500
"""Nodes between two signs of life."""


def main() -> None:
    """Answer until the input ends."""
    _answer("ready")
    for line in sys.stdin:
        with contextlib.suppress(*_FAILURES):
            _read(json.loads(line))
        _answer("done")


def _read(path: str) -> None:
    """Everything that a reader may ask libhdf5 for."""
    with opened(path, guarded=False) as file:
        numbers = itertools.count(1)
        tree = walk(file, lambda: None if next(numbers) % _STEP else _answer("walking"))
        _answer(f"declared {sum(node.size for node in (*tree.leaves, *tree.unread))}")
        for node in (*tree.leaves, *tree.unread):
            if isinstance(node, Leaf):
                with contextlib.suppress(InputError):
                    node.array() if node.is_number else node.text()
            if not isinstance(node, Leaf) or not node.is_number:
                with contextlib.suppress(*_FAILURES):
                    node.keep()


def _answer(text: str) -> None:
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()
