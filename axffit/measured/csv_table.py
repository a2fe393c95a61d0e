"""CSV with a header line and comments ``# key: value`` before it: what the readers of CSV share."""

import csv
from pathlib import Path
from typing import NamedTuple

import numpy as np

from axffit.errors import InputError
from axffit.measured.files import numbers, read_lines


class CsvTable(NamedTuple):
    """``notes`` by key in lower case, ``names`` of the columns, and the rows as text with their line numbers."""

    notes: dict[str, str]
    names: list[str]
    rows: list[tuple[int, list[str]]]

    def numbers(self, path: Path, *, first: int = 0) -> np.ndarray:
        """The columns from ``first`` on as float64.

        Raises:
            InputError: a row has another number of fields than the header, or a field is no number.
        """
        for line, fields in self.rows:
            if len(fields) != len(self.names):
                raise InputError(
                    f"{path}: line {line}: {len(fields)} fields, the header names {len(self.names)} columns; "
                    "the file may be truncated: copy it again, or complete the line"
                )
        rows = ((line, fields[first:]) for line, fields in self.rows)
        return numbers(path, rows, len(self.names) - first, "row")


def header_names(text: str) -> list[str]:
    """The fields of the first line that is neither blank nor a comment, in lower case; [] without one."""
    for line in text.splitlines():
        if line.strip() and not line.lstrip().startswith("#"):
            return [field.strip().lower() for field in next(csv.reader([line]))]
    return []


def read_csv(path: Path, what: str) -> CsvTable:
    """The table of a CSV file; separators are commas, comments start with ``#``.

    Raises:
        InputError: the file cannot be read, has no header, or names a column twice.
    """
    notes: dict[str, str] = {}
    names: list[str] = []
    rows: list[tuple[int, list[str]]] = []
    for number, line in enumerate(read_lines(path, what), 1):
        if not line.strip():
            continue
        if line.lstrip().startswith("#"):
            key, _, value = line.lstrip()[1:].partition(":")
            notes[key.strip().lower()] = value.strip()
            continue
        fields = [field.strip() for field in next(csv.reader([line]))]
        if names:
            rows.append((number, fields))
        else:
            names = fields
    if not rows:
        raise InputError(f"{path}: no rows below the header; a {what} has some; is the file truncated?")
    if len(set(names)) != len(names):
        raise InputError(f"{path}: the header names a column twice: {', '.join(names)}")
    return CsvTable(notes, names, rows)


def note(path: Path, table: CsvTable, key: str, allowed: tuple[str, ...]) -> str:
    """The comment ``# key: value``, the first of ``allowed`` where it is missing.

    Raises:
        InputError: the value is none of ``allowed``.
    """
    value = table.notes.get(key, allowed[0])
    if value not in allowed:
        raise InputError(f"{path}: # {key}: {value}; allowed are {', '.join(allowed)}")
    return value
