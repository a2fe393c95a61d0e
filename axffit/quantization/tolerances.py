"""Tolerances: one documented TOML in the package, and a user's file that changes part of it."""

import math
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from importlib import resources
from pathlib import Path
from typing import Any

from ..errors import InputError
from .maps import STATISTICS
from .measures import MEASURES

SCHEMA_VERSION = 1

LUT_CHECKS = ("truncated", "rounded")
BRDF_CHECKS = ("peak_relative", "log_ratio")


@dataclass(frozen=True)
class Tolerance:
    """One limit.

    Attributes:
        limit: the largest value allowed; infinity switches the check off.
        statistic: which statistic of a map is compared; "max" where there is only one number.
        reason: why the limit is what it is.
    """

    limit: float
    statistic: str = "max"
    reason: str = ""

    def allows(self, value: float) -> bool:
        """Whether a value is within. An infinite error is within only where the check is off."""
        return value <= self.limit


@dataclass(frozen=True)
class Tolerances:
    """Every limit of a verification, by dotted name: ``textures.normal.angle``, ``lut.rounded``, ``brdf.log_ratio``.

    Attributes:
        entries: the limits that are set; a measure without an entry is reported and not judged.
        source: where they come from: the package, or the user's file on top of it.
    """

    entries: Mapping[str, Tolerance]
    source: str = "axffit's defaults"

    def get(self, name: str) -> Tolerance | None:
        """The limit of that name, or None."""
        return self.entries.get(name)


def default_tolerances() -> Tolerances:
    """The limits of the package (``default_tolerances.toml``)."""
    text = resources.files("axffit.quantization").joinpath("default_tolerances.toml").read_text(encoding="utf-8")
    return Tolerances(dict(_entries(tomllib.loads(text), {}, "default_tolerances.toml")))


def read_tolerances(path: Path | str) -> Tolerances:
    """The limits of a user's file on top of the package's.

    Raises:
        InputError: the file cannot be read, is no TOML, or holds a key, statistic or limit that is not allowed.
    """
    defaults = default_tolerances().entries
    try:
        content = tomllib.loads(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); give a TOML file of tolerances") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: is not text; give a TOML file of tolerances in UTF-8") from None
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: is no TOML: {str(error).splitlines()[0]}; mend that line") from None
    changed = dict(_entries(content, defaults, str(path)))
    return Tolerances({**defaults, **changed}, f"{path} on top of axffit's defaults")


def known_names() -> tuple[str, ...]:
    """Every name a limit may have."""
    textures = [f"textures.{name}.{measure.name}" for name, measures in MEASURES.items() for measure in measures]
    return (*textures, *(f"lut.{check}" for check in LUT_CHECKS), *(f"brdf.{check}" for check in BRDF_CHECKS))


def _entries(
    content: Mapping[str, Any], defaults: Mapping[str, Tolerance], source: str
) -> Iterator[tuple[str, Tolerance]]:
    version = content.get("schema_version", SCHEMA_VERSION)
    if version != SCHEMA_VERSION:
        raise InputError(f"{source}: schema_version is {version!r}; this axffit reads {SCHEMA_VERSION}")
    for name, entry in _leaves({key: value for key, value in content.items() if key != "schema_version"}, "", source):
        if name not in known_names():
            raise InputError(f"{source}: unknown entry [{name}]; allowed: {', '.join(_names_near(name))}")
        yield name, _tolerance(entry, defaults.get(name, Tolerance(math.inf)), f"{source}: [{name}]", name)


def _leaves(table: Mapping[str, Any], prefix: str, source: str) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Tables that are entries (no longer the beginning of a known name), by dotted name."""
    for key, value in table.items():
        name = f"{prefix}{key}"
        if not isinstance(value, Mapping):
            raise InputError(f"{source}: {name} = {value!r} is not in a table; write [{name}] and limit = {value!r}")
        if any(known.startswith(f"{name}.") for known in known_names()):
            yield from _leaves(value, f"{name}.", source)
        else:
            yield name, value


def _names_near(name: str) -> list[str]:
    """The known names that share the most leading parts with an unknown one."""
    parts = name.split(".")
    for length in range(len(parts), 0, -1):
        near = [known for known in known_names() if known.split(".")[:length] == parts[:length]]
        if near:
            return near
    return ["textures.<AxF name>.<measure>", *(known for known in known_names() if not known.startswith("textures."))]


def _tolerance(entry: Mapping[str, Any], default: Tolerance, where: str, name: str) -> Tolerance:
    allowed = ("limit", "statistic", "reason") if name.startswith("textures.") else ("limit", "reason")
    for key in entry:
        if key not in allowed:
            raise InputError(f"{where}: unknown key {key!r}; allowed: {', '.join(allowed)}")
    limit = entry.get("limit", default.limit)
    if isinstance(limit, bool) or not isinstance(limit, int | float) or not limit >= 0:
        raise InputError(f"{where}: limit = {limit!r}; give a number of 0 or more, or inf to switch the check off")
    statistic = entry.get("statistic", default.statistic)
    if statistic not in STATISTICS:
        raise InputError(f"{where}: statistic = {statistic!r}; allowed: {', '.join(STATISTICS)}")
    reason = entry.get("reason", default.reason if limit == default.limit else "")
    if not isinstance(reason, str):
        raise InputError(f"{where}: reason = {reason!r}; give text")
    return replace(default, limit=float(limit), statistic=statistic, reason=reason)
