"""What quantization loses: map errors, BRDF errors, tolerances, and the verdict."""

from .tolerances import Tolerance as Tolerance
from .tolerances import Tolerances as Tolerances
from .tolerances import default_tolerances as default_tolerances
from .tolerances import read_tolerances as read_tolerances
from .verdict import Verdict as Verdict
from .verify import verify as verify
from .verify import verify_packed as verify_packed
