"""The AxF material, and the reader and writer of .axf files."""

from .appearance import Appearance as Appearance
from .appearance import appearance as appearance
from .appearance import to_brdf as to_brdf
from .extras import AxfExtra as AxfExtra
from .material import AxfFile as AxfFile
from .material import AxfMaterial as AxfMaterial
from .material import AxfTexture as AxfTexture
from .material import MaterialKind as MaterialKind
from .profiles import minimum_version as minimum_version
from .profiles import profiles as profiles
from .reader import read as read
from .surface import to_svbrdf as to_svbrdf
from .writer import write as write
