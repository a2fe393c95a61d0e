"""Models by the names of the command line."""

import re

from axffit.brdf.carpaint import MAX_LOBES
from axffit.errors import InputError
from axffit.fitting.models import LOBES, AbstractFitModel, CarPaintModel, Coat, LambertModel, SingleLobeModel
from axffit.fitting.multilobe import F0, LobesModel

MODEL_NAMES = ("lambert", *LOBES, "carpaint")
"""Names that :func:`parse_model` knows, each also with ``+coat``."""


def parse_model(name: str, *, lobes: int | None = None, f0: F0 | None = None, ior: float = 1.5) -> AbstractFitModel:
    """The fit model of a command-line name such as ``ggx`` or ``carpaint+coat``.

    Args:
        name: one of :data:`MODEL_NAMES`, with ``+coat`` for a clear coat of known index that refracts.
        lobes: number of lobes; None is 3 for a car paint, else 1.
        f0: known value, or ``"shared"`` by all lobes (None is the same), or ``"each"``: one a lobe and channel.
        ior: index of refraction of the coat.

    Raises:
        InputError: the name is unknown, a number is out of range, or the model has no such choice.
    """
    match = re.fullmatch(r"([a-z0-9:-]+)(\+coat)?", name.strip().lower())
    known = {model.lower(): model for model in MODEL_NAMES}
    if match is None or match[1] not in known:
        raise InputError(f"unknown model {name!r}: choose one of {', '.join(MODEL_NAMES)}, each also with '+coat'")
    coat = Coat(ior) if match[2] else None
    kind = known[match[1]]
    if kind in ("lambert", "carpaint") and f0 is not None:
        raise InputError(f"{kind} takes no F0: it has no lobe, or fits one for each; choose another model")
    if kind == "lambert":
        return LambertModel(coat=coat)
    if kind == "carpaint":
        return CarPaintModel(lobes=3 if lobes is None else lobes, coat=coat)
    if lobes is not None and not 1 <= lobes <= MAX_LOBES:
        raise InputError(f"{lobes} lobes: give 1 to {MAX_LOBES}")
    if lobes in (None, 1) and f0 in (None, "shared"):
        return SingleLobeModel(lobe=kind, coat=coat)
    return LobesModel(lobe=kind, lobes=lobes or 1, coat=coat, f0="shared" if f0 is None else f0)


def parse_f0(text: str) -> F0:
    """``each``, ``shared`` or a number from 0 to 1.

    Raises:
        InputError: it is none of them.
    """
    try:
        return "each" if text == "each" else "shared" if text == "shared" else float(text)
    except ValueError:
        raise InputError(f"F0 {text!r}: give a number from 0 to 1, 'shared' or 'each'") from None
