"""Folders that appear whole or not at all: built beside their place, made durable, then exchanged."""

import contextlib
import ctypes
import os
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from ..errors import InputError

PREFIX = ".axffit-"
"""How the names of unfinished folders begin; after a kill one may be left over, and may be deleted."""


@contextlib.contextmanager
def staging(folder: Path) -> Iterator[Path]:
    """A new, empty folder inside ``folder`` (made where it is missing); gone at the end, whatever happens.

    Raises:
        InputError: the folder cannot be made or written.
    """
    made = [parent for parent in (folder, *folder.parents) if not parent.exists()]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        place = Path(tempfile.mkdtemp(prefix=PREFIX, suffix=".tmp", dir=folder))
    except OSError as error:
        _remove_empty(made)
        raise InputError(f"{folder}: cannot be written ({error.strerror}); choose another folder") from error
    try:
        yield place
    finally:
        shutil.rmtree(place, ignore_errors=True)
        _remove_empty(made)


def publish(place: Path, folder: Path, names: Sequence[str]) -> None:
    """Move the sub-folders of ``place`` into ``folder``; what had their names lies in ``place`` afterwards.

    Everything is on the disk before the first one moves. Each moves in one step where the system can exchange two
    names (Linux); elsewhere the old one steps aside first. If one cannot be moved, those before it go back.

    Args:
        place: a folder on the same file system, as `staging` gives it.
        folder: where to.
        names: the sub-folders.

    Raises:
        OSError: a sub-folder cannot be made durable or moved; ``folder`` is as it was.
    """
    _make_durable(place)
    with contextlib.ExitStack() as undo:
        for name in names:
            undo.callback(_swap(place / name, folder / name))
        undo.pop_all()
    _flush(folder)


def _swap(new: Path, old: Path) -> Callable[[], object]:
    """Puts ``new`` in the place of ``old`` and the other way round; returns what undoes it."""
    if not os.path.lexists(old):
        os.rename(new, old)
        return lambda: os.rename(old, new)
    if _exchange(new, old):
        return lambda: _exchange(new, old)
    aside = new.with_name(f"{new.name}.old")
    os.rename(old, aside)
    try:
        os.rename(new, old)
    except OSError:
        os.rename(aside, old)
        raise

    def back() -> None:
        os.rename(old, new)
        os.rename(aside, old)

    return back


def _exchange(first: Path, second: Path) -> bool:
    """Exchanges two names in one step; False where the system or the file system cannot."""
    if not sys.platform.startswith("linux"):
        return False
    rename = getattr(ctypes.CDLL(None, use_errno=True), "renameat2", None)
    if rename is None:
        return False
    # AT_FDCWD and RENAME_EXCHANGE of linux/fcntl.h and linux/fs.h.
    return rename(-100, os.fsencode(first), -100, os.fsencode(second), 2) == 0


def _make_durable(place: Path) -> None:
    for folder, _, files in os.walk(place):
        for name in files:
            _flush(Path(folder) / name)
        _flush(Path(folder))


def _flush(path: Path) -> None:
    """Hands a file or folder to the disk; Windows cannot open folders, and there it is left to the system."""
    if os.name == "nt":
        return
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def _remove_empty(folders: Sequence[Path]) -> None:
    for folder in folders:
        with contextlib.suppress(OSError):
            folder.rmdir()
