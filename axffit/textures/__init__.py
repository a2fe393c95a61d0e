"""Number formats and re-rangings: each encodes, decodes, and says how far a value may move."""

from .codec import ROUNDINGS as ROUNDINGS
from .codec import Rounding as Rounding
from .codec import ScalarCodec as ScalarCodec
from .formats import FORMATS as FORMATS
from .formats import NumberFormat as NumberFormat
from .formats import format_named as format_named
from .rerange import Counts as Counts
from .rerange import Reranging as Reranging
