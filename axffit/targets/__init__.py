"""Target engines: what each one's AxF material expects, `pack`, `unpack` and `validate`."""

from collections.abc import Mapping
from types import ModuleType

from ..errors import InputError
from . import hdrp_10 as hdrp_10
from . import mdl as mdl
from . import png16 as png16
from . import unity_2018 as unity_2018
from . import unreal as unreal
from .base import PackedMaterial as PackedMaterial
from .base import PackedTexture as PackedTexture
from .base import Problem as Problem

TARGETS: Mapping[str, ModuleType] = {module.NAME: module for module in (unity_2018, hdrp_10, png16, unreal, mdl)}
"""Every target by name: a module with the methods of `engine.Engine` as functions: `pack`, `unpack`, `validate`,
`reading`, `texture_name`, `default_values`, `values_of` and `scale_of`."""


def target_named(name: str) -> ModuleType:
    """The target of that name.

    Raises:
        InputError: there is none; the message lists those there are.
    """
    if name not in TARGETS:
        raise InputError(f"unknown target {name!r}; allowed: {', '.join(TARGETS)}")
    return TARGETS[name]
