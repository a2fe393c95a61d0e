"""Image files of textures: OpenEXR, PNG, DDS and KTX2, codes stored exactly, read back with every check."""

from .containers import AUTO as AUTO
from .containers import CONTAINERS as CONTAINERS
from .containers import Container as Container
from .containers import StoredFile as StoredFile
from .containers import container_for as container_for
from .containers import load as load
from .containers import save as save
from .image import MAXIMUM_BYTES as MAXIMUM_BYTES
from .image import TextureImage as TextureImage
from .image import check_bytes as check_bytes
