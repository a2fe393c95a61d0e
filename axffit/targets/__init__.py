"""Target engines: what each one's AxF material expects, `pack`, `unpack` and `validate`."""

from collections.abc import Mapping
from types import ModuleType

from ..errors import InputError
from . import unity_2018 as unity_2018
from .base import PackedMaterial as PackedMaterial
from .base import PackedTexture as PackedTexture
from .base import Problem as Problem

TARGETS: Mapping[str, ModuleType] = {unity_2018.NAME: unity_2018}
"""Every target by name: a module with `pack`, `unpack`, `validate`, `reading`, `texture_name`
and `default_values`."""


def target_named(name: str) -> ModuleType:
    """The target of that name.

    Raises:
        InputError: there is none; the message lists those there are.
    """
    if name not in TARGETS:
        raise InputError(f"unknown target {name!r}; allowed: {', '.join(TARGETS)}")
    return TARGETS[name]
