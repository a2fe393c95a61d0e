"""What readers of sample files share: bytes and text with errors in one line, rows of numbers, whole files or none."""

import os
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from axffit.errors import InputError

LARGEST_TEXT = 1 << 30
"""Bytes beyond which a file of text is refused unread."""


def read_bytes(path: Path, what: str, *, most: int = -1) -> bytes:
    """The content of ``path``, or its first ``most`` bytes; ``what`` names the format in the error.

    Raises:
        InputError: the file cannot be read.
    """
    try:
        with path.open("rb") as file:
            return file.read(most)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error}); give a readable {what} file") from None


def read_lines(path: Path, what: str) -> list[str]:
    """The lines of a file of text (UTF-8, any line ending), without their ends.

    Raises:
        InputError: the file cannot be read, is not text, or is larger than 1 GiB.
    """
    data = read_bytes(path, what)
    if len(data) > LARGEST_TEXT:
        raise InputError(f"{path}: {len(data)} bytes of text; at most {LARGEST_TEXT} are read, give a part of it")
    if b"\0" in data:
        raise InputError(f"{path}: holds zero bytes and is no {what}; save it as UTF-8 text")
    try:
        return data.decode("utf-8-sig").splitlines()
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: byte {error.start} is no UTF-8 text; save the {what} as UTF-8") from None


def numbers(path: Path, rows: Iterable[tuple[int, Sequence[str]]], columns: int, what: str) -> np.ndarray:
    """Rows of text fields as float64 (N, columns).

    Args:
        path: for the errors.
        rows: line number from 1, fields.
        columns: fields that each row must have.
        what: what a row is, for the errors.

    Raises:
        InputError: a row has more or fewer fields, a field is no number, or there is no row.
    """
    found: list[list[float]] = []
    for line, fields in rows:
        if len(fields) != columns:
            raise InputError(
                f"{path}: line {line}: {len(fields)} fields, a {what} has {columns}; "
                "the file may be truncated: copy it again, or complete the line"
            )
        try:
            found.append([float(field) for field in fields])
        except ValueError:
            wrong = next(field for field in fields if not _is_number(field))
            raise InputError(f"{path}: line {line}: {wrong!r} is no number; a {what} has {columns} numbers") from None
    if not found:
        raise InputError(f"{path}: holds no {what}; the file may be truncated: copy it again")
    return np.array(found, np.float64)


def _is_number(field: str) -> bool:
    try:
        float(field)
    except ValueError:
        return False
    return True


def write_whole(path: str | os.PathLike, data: bytes | str) -> None:
    """Write ``data`` (text as UTF-8) beside ``path`` and rename it there: never leaves a half-written file."""
    path = Path(path)
    data = data.encode("utf-8") if isinstance(data, str) else data
    with tempfile.NamedTemporaryFile(dir=path.parent, prefix=path.name, suffix=".part", delete=False) as file:
        try:
            file.write(data)
            file.close()
            os.replace(file.name, path)
        except BaseException:
            Path(file.name).unlink(missing_ok=True)
            raise


def as_text(rows: Iterable[Iterable[float]], separator: str = ",") -> str:
    """Rows of numbers as text that reads back to the same float64."""
    return "".join(separator.join(repr(float(x)) for x in row) + "\n" for row in rows)
