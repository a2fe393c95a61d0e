"""Target engines: what each one's AxF material expects, `pack`, `unpack` and `validate`."""

from . import unity_2018 as unity_2018
from .base import PackedMaterial as PackedMaterial
from .base import PackedTexture as PackedTexture
from .base import Problem as Problem
