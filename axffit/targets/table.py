"""What a target is, as data: its textures, its values, and the engine's own rules beside them.

A target module fills these tables; `engine` packs, reads and judges by them.
"""

import enum
from collections.abc import Mapping
from dataclasses import dataclass

from ..axf import MaterialKind
from ..axf.properties import PROPERTY_TYPES
from ..errors import InputError
from ..textures import format_named
from ..textures.rerange import Identity, Reranging
from .bitfields import FlagWord

SVBRDF = frozenset({MaterialKind.SVBRDF})
CAR_PAINT = frozenset({MaterialKind.CAR_PAINT})
COMMON = SVBRDF | CAR_PAINT

MAXIMUM_LOBES = 4
"""Components of the lobe descriptors."""

SLICE_TABLE = "thetaFI_sliceLUT"
"""The property that becomes a texture."""


class Absent(enum.Enum):
    """What the target gets when AxF has no such texture."""

    DEFAULT = "a 4x4 texture of the default color"
    HEIGHT_FLAG = "nothing: flag bit 3 says it is not sampled"
    COAT_FLAG = "nothing without any clear-coat texture (flag bit 1), otherwise a 4x4 texture of the default color"
    FLAKES = "nothing when there are no flakes"
    NOTHING = "nothing: the importer leaves it out"


class Scaling(enum.Enum):
    """How the value a texture is divided by is chosen."""

    FILL = "the largest value of an integer format, so that every code is used; 1 for a float format"
    ABOVE_ONE = "the largest value where it exceeds 1, otherwise 1"
    PER_CHANNEL = "each channel's largest value, at least 0.1"


@dataclass(frozen=True)
class FormatChoice:
    """A number format a texture may have, and the re-ranging that belongs to it.

    Attributes:
        format: its name.
        reranging: from AxF's range to the texture's, before any scale.
        announced: whether the source only announces it ("in the future"), so that no shader of its time reads it.
        curve: what follows the scale.
    """

    format: str
    reranging: Reranging
    announced: bool = False
    curve: Reranging = Identity()


@dataclass(frozen=True)
class TextureRow:
    """One texture of the target.

    Attributes:
        name: the target's name.
        axf_name: canonical AxF name of the texture (or of the property it is made from).
        kinds: the materials it belongs to.
        choices: for each number of AxF channels the formats allowed, the advised one first.
        default: what the shader samples when AxF has none, in the target's range, padded to the format's channels.
        absent: when that default is made.
        scale: name of the value the texture is divided by, or None.
        scaling: how that value is chosen.
        array: whether it is a Texture2DArray.
        provenance: the heading of the source, and what it says.
    """

    name: str
    axf_name: str
    kinds: frozenset[MaterialKind]
    choices: Mapping[int, tuple[FormatChoice, ...]]
    default: tuple[float, ...]
    absent: Absent = Absent.DEFAULT
    scale: str | None = None
    scaling: Scaling = Scaling.FILL
    array: bool = False
    provenance: str = ""

    def choice(self, channels: int, format: str) -> FormatChoice | None:
        """The choice of that format, or None if it is not allowed for so many AxF channels."""
        return next((choice for choice in self.choices[channels] if choice.format == format), None)

    def stored_choices(self, channels: int) -> tuple[FormatChoice, ...]:
        """The choices that store data in so many channels; a normal of three may be stored as two."""
        return tuple(
            choice
            for given, choices in self.choices.items()
            for choice in choices
            if min(given, format_named(choice.format).channels) == channels
        )


class ValueType(enum.Enum):
    """Type of a shader constant."""

    FLOAT = "float"
    UINT = "uint"
    FLOAT3 = "float3"
    FLOAT4 = "float4"

    @property
    def length(self) -> int:
        """Components; 1 for a number."""
        return {ValueType.FLOAT3: 3, ValueType.FLOAT4: 4}.get(self, 1)


class Role(enum.Enum):
    """What a value says that is no AxF property."""

    NONE = "the engine's own"
    SIZE_U = "size of the material along u in mm"
    SIZE_V = "size of the material along v in mm"
    FLAGS = "packed flags"
    BRDF_TYPE = "packed diffuse and specular model"
    BRDF_VARIANTS = "packed variants"
    LOBES_COUNT = "how many lobes are used"
    SCALE = "what a texture is divided by"


@dataclass(frozen=True)
class ValueRow:
    """One value of the target.

    Attributes:
        name: the target's name.
        type: type of the shader constant.
        kinds: the materials it belongs to.
        source: the AxF property it comes from, or its role.
        default: used when the property is absent; for a vector also the padding of unused components.
        exposed: whether the user of the engine may change it.
        unit: unit, or what the number is.
        provenance: the heading of the source, and what it says.
    """

    name: str
    type: ValueType
    kinds: frozenset[MaterialKind]
    source: str | Role
    default: float
    exposed: bool = False
    unit: str = ""
    provenance: str = ""

    def __post_init__(self) -> None:
        if not isinstance(self.source, Role) and self.source not in PROPERTY_TYPES:
            raise ValueError(f"{self.name}: {self.source!r} is no AxF property; give one, or a role")

    @property
    def axf_name(self) -> str:
        """The AxF property it comes from, or ""."""
        return "" if isinstance(self.source, Role) else self.source


@dataclass(frozen=True)
class Tables:
    """Everything a target is made of.

    Attributes:
        name: the target's name.
        textures: its textures.
        values: its values.
        flags: type of its packed flags.
    """

    name: str
    textures: tuple[TextureRow, ...]
    values: tuple[ValueRow, ...]
    flags: type[FlagWord]

    def row(self, name: str) -> TextureRow:
        """The row of a texture.

        Raises:
            InputError: the target has no such texture.
        """
        row = next((row for row in self.textures if row.name == name), None)
        if row is None:
            raise InputError(
                f"{self.name} has no texture {name!r}; it has {', '.join(row.name for row in self.textures)}"
            )
        return row

    def row_of(self, axf_name: str, kind: MaterialKind) -> TextureRow | None:
        """The row of an AxF texture in materials of that kind, or None where the target has no place for it."""
        return next((row for row in self.textures if row.axf_name == axf_name and kind in row.kinds), None)

    def value_of(self, source: str | Role, kind: MaterialKind) -> ValueRow | None:
        """The value that holds a property or plays a role in materials of that kind, or None."""
        return next((row for row in self.values if row.source == source and kind in row.kinds), None)
