"""What an AxF material reflects, which lobes explain a measurement, what a texture format loses - in numbers.

The five entry points below load the parts they need on first use, so that ``import axffit`` costs nothing.
The subpackages (``axffit.brdf``, ``axffit.axf``, ``axffit.measured``, ``axffit.fitting``,
``axffit.quantization`` ...) are imported as usual.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from axffit.axf import read as read_axf
    from axffit.axf import write as write_axf
    from axffit.fitting import fit
    from axffit.measured import read as read_measurements
    from axffit.quantization import verify

__version__ = "0.1.0"

__all__ = ["__version__", "fit", "read_axf", "read_measurements", "verify", "write_axf"]

_ENTRY_POINTS = {
    "fit": ("axffit.fitting", "fit"),
    "read_axf": ("axffit.axf", "read"),
    "read_measurements": ("axffit.measured", "read"),
    "verify": ("axffit.quantization", "verify"),
    "write_axf": ("axffit.axf", "write"),
}


def __getattr__(name: str) -> Any:
    """An entry point of the package, imported when first asked for."""
    try:
        module, attribute = _ENTRY_POINTS[name]
    except KeyError:
        raise AttributeError(f"module 'axffit' has no attribute {name!r}") from None
    return getattr(import_module(module), attribute)


def __dir__() -> list[str]:
    """The names of the package, the entry points included."""
    return sorted({*globals(), *__all__})
