"""Tolerances: one documented TOML in the package, and a user's file that changes part of it (docs/tolerances.md).

A limit is looked for in four places, a later one counting: the package's general entries, its section of the target
that reads, the user's general entries, and the user's section of that target.
"""

import math
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from importlib import resources
from pathlib import Path
from typing import Any, Literal, get_args

from ..errors import InputError
from ..targets import TARGETS
from .filtered import FILTERED_MEASURES
from .measures import MEASURES
from .statistics import STATISTICS

SCHEMA_VERSION = 1

LUT_CHECKS = ("truncated", "rounded")

Kind = Literal["peak_relative", "log_ratio"]
KINDS: tuple[Kind, ...] = get_args(Kind)
"""Definitions (b) and (c) of the BRDF errors (`definitions`)."""


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
        targets: target name to all limits that hold for it, where they differ from ``entries``.
    """

    entries: Mapping[str, Tolerance]
    source: str = "axffit's defaults"
    targets: Mapping[str, Mapping[str, Tolerance]] = field(default_factory=dict)

    def get(self, name: str) -> Tolerance | None:
        """The limit of that name, or None."""
        return self.entries.get(name)

    def for_target(self, target: str) -> "Tolerances":
        """The limits that hold where this target's shader reads."""
        return Tolerances(self.targets.get(target, self.entries), self.source)

    def levels_apart(self, axf_name: str) -> dict[str, set[int]]:
        """Measures of a texture to the mip levels that have a limit of their own."""
        apart: dict[str, set[int]] = {}
        for name in self.entries:
            parts = name.split(".")
            if parts[:2] == ["textures", axf_name] and len(parts) == 5:
                apart.setdefault(parts[2], set()).add(int(parts[4]))
        return apart


def default_tolerances() -> Tolerances:
    """The limits of the package (``default_tolerances.toml``)."""
    text = resources.files("axffit.quantization").joinpath("default_tolerances.toml").read_text(encoding="utf-8")
    content = tomllib.loads(text)
    return _on_top_of(Tolerances({}), content, "default_tolerances.toml", "axffit's defaults")


def read_tolerances(path: Path | str) -> Tolerances:
    """The limits of a user's file on top of the package's.

    Raises:
        InputError: the file cannot be read, is no TOML, or holds a key, statistic or limit that is not allowed.
    """
    try:
        content = tomllib.loads(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); give a TOML file of tolerances") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: is not text; give a TOML file of tolerances in UTF-8") from None
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: is no TOML: {str(error).splitlines()[0]}; mend that line") from None
    return _on_top_of(default_tolerances(), content, str(path), f"{path} on top of axffit's defaults")


def known_names() -> tuple[str, ...]:
    """Every name a limit may have; one of a texture's may have ``.level.<number>`` behind it."""
    measures = {
        name: [*(m.name for m in measures), *FILTERED_MEASURES.get(name, ())] for name, measures in MEASURES.items()
    }
    textures = [f"textures.{name}.{measure}" for name, names in measures.items() for measure in names]
    return (*textures, *(f"lut.{check}" for check in LUT_CHECKS), *(f"brdf.{check}" for check in KINDS))


Entries = Mapping[str, Mapping[str, Any]]
"""Dotted names to the keys a file gives them."""


def _on_top_of(base: Tolerances, content: Mapping[str, Any], file: str, source: str) -> Tolerances:
    version = content.get("schema_version", SCHEMA_VERSION)
    if version != SCHEMA_VERSION:
        raise InputError(f"{file}: schema_version is {version!r}; this axffit reads {SCHEMA_VERSION}")
    sections = content.get("targets", {})
    if not isinstance(sections, Mapping):
        raise InputError(f"{file}: targets = {sections!r} is not a table; write [targets.<target>.<entry>]")
    for target in sections:
        if target not in TARGETS:
            raise InputError(f"{file}: unknown target [targets.{target}]; allowed: {', '.join(TARGETS)}")
    tables = {key: value for key, value in content.items() if key not in ("schema_version", "targets")}
    general = dict(_leaves(tables, "", file))
    special = {
        target: dict(_leaves(section, "", f"{file}: [targets.{target}]")) for target, section in sections.items()
    }
    entries = _changed(base.entries, general, file)
    targets = {
        target: _changed(
            _changed(base.targets.get(target, base.entries), general, file),
            special.get(target, {}),
            f"{file}: [targets.{target}]",
        )
        for target in (*special, *(name for name in base.targets if name not in special))
    }
    return Tolerances(entries, source, targets)


def _changed(base: Mapping[str, Tolerance], entries: Entries, source: str) -> dict[str, Tolerance]:
    changed = dict(base)
    # An entry before those of its levels, which take from it what they leave out.
    for name, entry in sorted(entries.items(), key=lambda item: item[0].count(".")):
        whole = name.split(".level.")[0]
        default = changed.get(name) or changed.get(whole) or Tolerance(math.inf)
        changed[name] = _tolerance(entry, default, f"{source}: [{name}]", name)
    return changed


def _leaves(table: Any, prefix: str, source: str) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Tables that are entries, by dotted name; those of mip levels beside their map's."""
    if not isinstance(table, Mapping):
        raise InputError(f"{source}: {table!r} is not a table of entries; write [textures.<AxF name>.<measure>]")
    names = known_names()
    for key, value in table.items():
        name = f"{prefix}{key}"
        if not isinstance(value, Mapping):
            raise InputError(f"{source}: {name} = {value!r} is not in a table; write [{name}] and limit = {value!r}")
        if any(known.startswith(f"{name}.") for known in names):
            yield from _leaves(value, f"{name}.", source)
        elif name not in names:
            raise InputError(f"{source}: unknown entry [{name}]; allowed: {', '.join(_names_near(name))}")
        else:
            levels = value.get("level", {}) if name.startswith("textures.") else {}
            own = {key: held for key, held in value.items() if key != "level" or not name.startswith("textures.")}
            if own or levels == {}:
                yield name, own
            yield from _of_levels(name, levels, source)


def _of_levels(name: str, levels: Any, source: str) -> Iterator[tuple[str, Mapping[str, Any]]]:
    if not isinstance(levels, Mapping):
        raise InputError(f"{source}: [{name}]: level = {levels!r} is not a table; write [{name}.level.1]")
    for number, entry in levels.items():
        if not (number.isascii() and number.isdecimal() and str(int(number)) == number):
            raise InputError(f"{source}: [{name}.level.{number}]: give the number of a mip level: [{name}.level.1]")
        if not isinstance(entry, Mapping):
            raise InputError(f"{source}: {name}.level.{number} = {entry!r} is not in a table; write [{name}.level.1]")
        yield f"{name}.level.{number}", entry


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
