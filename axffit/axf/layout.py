"""The HDF5 spelling that reader and writer share: what is evidenced, and our own layout for the rest.

`docs/axf-layout.md` describes it for people.
"""

import re
import urllib.parse
from collections.abc import Iterable

VERSION_ATTRIBUTES = ("axf.version.major", "axf.version.minor", "axf.version.revision")
"""Root attributes, uint32 (evidenced)."""

OWN_VERSION = "axffit.version"
"""Root attribute: the version of axffit that wrote the file. It marks everything below that is our own."""

OWN_LAYOUT = "axffit.layout"
"""Root attribute, uint32: the number of the layout of our own, 1."""

LAYOUT_NUMBER = 1

MATERIALS = "com.xrite.Materials"
RESOURCES = "com.xrite.Resources"
REPRESENTATIONS = "com.xrite.Representations"

OWN_GROUP = "axffit.Material"
"""Our own group below a material's `com.xrite.Representations`; further representations are `…_1`, `…_2`, …"""

RGB = "RGB"
"""Beside a spectrum's `Data`: the linear RGB that was made of it; of level n: `RGBLevel<n>` (our own)."""

WAVELENGTHS = "Wavelengths"
"""Beside a spectrum's `Data`: its wavelengths in nanometers (our own)."""

TEXTURES = "Textures"
"""In our description: the nodes of the textures that are not at AxF's own place, "" for none, by canonical name."""

REPRESENTATION = "Representation"
"""In our description: the name of the representation, where it has one."""

OWN_GROUPS = re.compile(re.escape(OWN_GROUP) + r"(?:_(\d{1,9}))?")
"""The names of our own groups; the number of a further representation is group 1."""

DATA, WIDTH, HEIGHT = "Data", "WidthMM", "HeightMM"
"""A resource's values and its extent in millimeters (evidenced)."""

LEVEL = "Level"
"""Mip level n of a resource is the sibling `Level<n>` of `Data`, n = 1, 2, … (our own)."""


def is_container(parts: tuple[str, ...], nodes: Iterable[str]) -> bool:
    """Whether a path below a material is a group that only holds others: the resources, the representations.

    Args:
        parts: the names from the material's group on.
        nodes: the `Group/Resource` of every texture.
    """
    groups = {(RESOURCES, node.split("/")[0]) for node in nodes}
    if len(parts) == 2 and parts[0] == REPRESENTATIONS:
        return OWN_GROUPS.fullmatch(parts[1]) is not None
    return parts in ((RESOURCES,), (REPRESENTATIONS,)) or parts in groups


def escape(name: str) -> str:
    """A name that HDF5 can hold as one link: `/`, `%` and the names `.` and `..` are percent-encoded."""
    if set(name) == {"."}:
        return name.replace(".", "%2E")
    return name.replace("%", "%25").replace("/", "%2F")


def unescape(name: str) -> str:
    """The inverse of `escape`."""
    return urllib.parse.unquote(name)
