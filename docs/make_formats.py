"""Writes the tables of `docs/formats.md`: proven bound, exhaustive maximum and their ratio of every format."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from axffit.textures import FORMATS, ROUNDINGS
from axffit.textures.codec import ScalarCodec
from axffit.textures.floats import HALF, SINGLE
from axffit.textures.packed_floats import SharedExponent, UnsignedFloat
from axffit.textures.unit_vectors import UNIT_VECTORS
from axffit.textures.unorm import Snorm, SrgbUnorm, Uint, Unorm
from axffit.textures.worst_angle import largest_angle
from axffit.textures.worst_case import worst_case

CHANNELS: Mapping[str, ScalarCodec] = {
    "UNORM2": Unorm(2),
    "UNORM8": Unorm(8),
    "UNORM10": Unorm(10),
    "UNORM16": Unorm(16),
    "SNORM8": Snorm(8),
    "SNORM16": Snorm(16),
    "UNORM8 sRGB": SrgbUnorm(8),
    "float of 10 bits": UnsignedFloat(10),
    "float of 11 bits": UnsignedFloat(11),
    "shared exponent": SharedExponent(),
    "half": HALF,
    "single": SINGLE,
}
"""Every kind of channel that rounds."""

SMALLEST_NORMAL = {codec: 2.0**-14 for codec in CHANNELS.values()} | {SINGLE: 2.0**-126, SharedExponent(): 2.0**-16}


def channels_table() -> str:
    """Of each kind of channel and rounding, as Markdown."""
    lines = ["| channel | of | rounding | error | proven bound | exhaustive maximum | ratio |", "|---" * 7 + "|"]
    for name, codec in CHANNELS.items():
        formats = ", ".join(form.name for form in FORMATS.values() if codec in form.codecs and form.channels != 3)
        formats = formats or ", ".join(form.name for form in FORMATS.values() if codec in form.codecs)
        for rounding in ROUNDINGS:
            worst = worst_case(codec, rounding)
            # An error that grows with the number is stated relative to it.
            sides = {"absolute": np.ones_like(worst.numbers)}
            if codec.is_float:
                normal = np.abs(worst.numbers) >= SMALLEST_NORMAL[codec]
                sides = {"relative": np.where(normal, np.abs(worst.numbers), np.inf)}
                sides["absolute, subnormal"] = np.where(normal, np.inf, 1.0)
            for side, unit in sides.items():
                bound, error = np.max(worst.bounds / unit), np.max(worst.errors / unit)
                row = (name, formats, rounding, side, f"{bound:.4g}", f"{error:.4g}", f"{bound / error:.4f}")
                lines.append(f"| {' | '.join(row)} |")
    exact = ", ".join(form.name for form in FORMATS.values() if isinstance(form.codecs[0], Uint))
    lines.append(f"| UINT | {exact} | any | absolute | 0 | 0 | exact |")
    return "\n".join(lines) + "\n"


def unit_vectors_table() -> str:
    """Of each encoding of unit vectors and rounding, degrees, as Markdown."""
    lines = ["| encoding | rounding | proven bound | largest found | ratio |", "|---" * 5 + "|"]
    for name, encoding in UNIT_VECTORS.items():
        for rounding in ROUNDINGS:
            bound = np.degrees(encoding.angle_bound(rounding))
            found = np.degrees(largest_angle(encoding, rounding))
            lines.append(f"| {name} | {rounding} | {bound:.4g} | {found:.4g} | {bound / found:.3f} |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    page = Path(__file__).with_name("formats.md")
    text = page.read_text(encoding="utf-8")
    for name, table in (("channels", channels_table()), ("unit vectors", unit_vectors_table())):
        start, end = f"<!-- {name} -->\n", f"<!-- end of {name} -->\n"
        before, rest = text.split(start)
        text = before + start + table + end + rest.split(end)[1]
    page.write_text(text, encoding="utf-8")
