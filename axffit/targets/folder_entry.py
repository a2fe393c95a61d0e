"""One object of a JSON file, read with every type checked; messages name the entry."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ..errors import InputError

_WORDS = {"NaN": math.nan, "Infinity": math.inf, "-Infinity": -math.inf}
_KINDS = {
    str: "a text",
    int: "a whole number",
    float: "a number",
    bool: "true or false",
    list: "a list",
    dict: "an object",
}


@dataclass(frozen=True)
class Entry:
    """A JSON object and where it stands.

    Raises:
        InputError: from every method, for an entry that is missing or of another type.
    """

    content: Any
    where: str

    def __post_init__(self) -> None:
        if not isinstance(self.content, dict):
            raise InputError(f"{self.where}: is {_kind(self.content)}; it must be an object of names and values")

    def get(self, name: str, kind: type) -> Any:
        """The value of that name and type; a float may be an integer or one of the words for NaN and infinity."""
        if name not in self.content:
            raise InputError(f"{self.where}: has no {name!r}; export the material again")
        value = self.content[name]
        if kind is float and isinstance(value, str) and value in _WORDS:
            return _WORDS[value]
        if kind is float and isinstance(value, int) and not isinstance(value, bool):
            return _as_float(value, f"{self.where}.{name}")
        if not isinstance(value, kind) or (kind is int and isinstance(value, bool)):
            raise InputError(f"{self.where}.{name}: is {_kind(value)}; it must be {_KINDS[kind]}")
        return value

    def maybe(self, name: str, kind: type) -> Any:
        """The value of that name and type, or None."""
        return self.get(name, kind) if name in self.content else None

    def one_of(self, name: str, allowed: Any) -> str:
        """A text that is one of those allowed."""
        value = self.get(name, str)
        if value not in allowed:
            raise InputError(f"{self.where}.{name} is {value!r}; allowed: {', '.join(allowed)}")
        return value

    def entry(self, name: str) -> "Entry":
        """The object of that name."""
        return Entry(self.get(name, dict), f"{self.where}: {name}")

    def entries(self, name: str) -> list["Entry"]:
        """The list of objects of that name."""
        return [Entry(item, f"{self.where}: {name}[{i}]") for i, item in enumerate(self.get(name, list))]

    def texts(self, name: str) -> list[str]:
        """The list of texts of that name."""
        return [Entry({"it": item}, f"{self.where}: {name}[{i}]").get("it", str) for i, item in self._items(name)]

    def numbers(self, name: str, kind: type) -> list[Any]:
        """The list of numbers of that name."""
        return [Entry({"it": item}, f"{self.where}: {name}[{i}]").get("it", kind) for i, item in self._items(name)]

    def value(self, name: str) -> Any:
        """A value of a target: a number, or a list of numbers as a tuple."""
        value = self.content[name]
        if isinstance(value, list):
            return tuple(self.numbers(name, float))
        if isinstance(value, int) and abs(value) >= 2**63:
            raise InputError(f"{self.where}.{name}: is a number of {value.bit_length()} bits; it must fit 64 bits")
        return self.get(name, int if isinstance(value, int) else float)

    def _items(self, name: str) -> Sequence[tuple[int, Any]]:
        return list(enumerate(self.get(name, list)))


def _kind(value: Any) -> str:
    return {**_KINDS, type(None): "null"}[type(value)]


def _as_float(value: int, where: str) -> float:
    try:
        return float(value)
    except OverflowError:
        raise InputError(f"{where}: is {len(str(value))} digits long; it must fit a float") from None
