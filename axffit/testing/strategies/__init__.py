"""Hypothesis strategies for directions, model parameters, BRDFs and SVBRDFs, textures and AxF materials.

Every strategy draws valid things directly, the awkward ones often: grazing, normal, coincident and mirrored directions,
roughness 1e-4 and 10, exponents to 1e5, F0 0 and 1, an index of refraction of 1, black and high-dynamic-range colors.
Arguments are keyword-only and checked when the strategy is made.
"""

try:
    import hypothesis as hypothesis
except ModuleNotFoundError as error:
    if error.name != "hypothesis":
        raise
    raise ModuleNotFoundError(
        "axffit.testing.strategies needs Hypothesis: pip install 'axffit[testing]'", name="hypothesis"
    ) from None

from .brdfs import MODELS as MODELS
from .brdfs import brdfs as brdfs
from .brdfs import color_tables as color_tables
from .brdfs import flakes as flakes
from .brdfs import fresnels as fresnels
from .brdfs import parameters as parameters
from .directions import cosines as cosines
from .directions import direction_pairs as direction_pairs
from .directions import directions as directions
from .directions import lower_directions as lower_directions
from .materials import axf_files as axf_files
from .materials import axf_materials as axf_materials
from .materials import car_paint_materials as car_paint_materials
from .materials import svbrdf_materials as svbrdf_materials
from .surfaces import svbrdfs as svbrdfs
from .surfaces import texture_maps as texture_maps
from .textures import textures as textures
from .values import colors as colors
from .values import exponents as exponents
from .values import f0s as f0s
from .values import iors as iors
from .values import normals as normals
from .values import rotations as rotations
from .values import roughnesses as roughnesses
