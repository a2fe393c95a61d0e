"""Proved upper bounds of what quantization does to a BRDF, beside the largest error found: [found, bound].

For a `Form` (which models) and a `TexelClass` (a box of parameters and their errors) `bracket` says, for both
definitions of the BRDF error, how large an error `search` could find with the library's own models, and which none
exceeds, proved by interval arithmetic with outward rounding. `upper_bounds` says only the latter, for a `Group` of the
many classes of a material. `form_of` and `classes_of` make form and class from a material before and after packing;
`hull` merges classes. What is not covered raises `NoBound`. The mathematics is in ``docs/bounds.md``.
"""

from .bracket import LOBES as LOBES
from .bracket import MOST_BOXES as MOST_BOXES
from .bracket import Bracket as Bracket
from .bracket import bracket as bracket
from .bracket import upper_bounds as upper_bounds
from .branch import Bounds as Bounds
from .descent import Group as Group
from .form import Coat as Coat
from .form import Form as Form
from .form import NoBound as NoBound
from .form import Paint as Paint
from .of_material import classes_of as classes_of
from .of_material import form_of as form_of
from .texel_class import TexelClass as TexelClass
from .texel_class import advised as advised
from .texel_class import hull as hull
