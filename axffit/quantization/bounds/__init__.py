"""Proved upper bounds of what quantization does to a lobe, beside the largest error found: [found, bound].

For a class of texels (a box in parameter space) and both definitions of the BRDF error, over all views and lights at
least 1° above the horizon: `search` climbs to the largest error with the library's own models; `branch` proves by
interval arithmetic with outward rounding that none is larger than the bound. The mathematics is in ``docs/bounds.md``.
"""

from .bracket import LOBES as LOBES
from .bracket import Bracket as Bracket
from .bracket import bracket as bracket
from .texel_class import TexelClass as TexelClass
from .texel_class import advised as advised
