"""Writes the tables of `docs/bounds.md`: [found, bound], their ratio, boxes and seconds of every class.

Lobes alone with the errors of the advised formats, then a texel of every synthetic material, packed for `unity_2018`.
"""

import math
import time
from pathlib import Path

import numpy as np

from axffit import brdf
from axffit.axf import read
from axffit.axf.maps import grid_shape, texel_centers
from axffit.quantization.bounds import LOBES, Form, NoBound, TexelClass, advised, bracket, classes_of, form_of
from axffit.quantization.bounds.texel_class import HALF, UNORM16_NORMAL
from axffit.targets import target_named

ROUGHNESSES = (0.01, 0.02, 0.03, 0.05, 0.1, 0.2, 0.3, 0.6, 1.0)
REFLECTANCES = (0.04, 1.0)
OTHERS = (brdf.WardDuer2006, brdf.Ward1992, brdf.CookTorrance)
EXPONENTIAL = (
    brdf.BlinnPhong1977,
    brdf.BlinnPhongVRay,
    brdf.BlinnPhongAshikhminShirley2000,
    brdf.PhongLewis1994,
)
TARGET, CHANNEL, SEED = "unity_2018", 0, 0
ROOT = Path(__file__).parents[1]


def exponential(n: float) -> TexelClass:
    """An exponent n = 2^n' with n' in half precision."""
    ratio = 2.0 ** (math.log2(n) * HALF)
    return TexelClass(UNORM16_NORMAL, (n, n), (1 / ratio, ratio), (0.04, 0.04), (-0.04 * HALF, 0.04 * HALF))


def row(names: str, form: Form, texels: TexelClass) -> str:
    """A line of a table."""
    start = time.process_time()
    try:
        both = bracket(form, texels)
    except NoBound as reason:
        return f"| {names} | no bound: {reason} |\n"
    seconds = time.process_time() - start
    cells = [
        f"{one.found:.3e} | {one.bound:.3e} | {one.bound / one.found:.3f} | {one.boxes}"
        for one in (both["peak_relative"], both["log_ratio"])
    ]
    return f"| {names} | {' | '.join(cells)} | {seconds:.1f} |\n"


def header(names: str) -> str:
    """First two lines."""
    columns = f"| {names} | {' | '.join(f'({k}) found | ({k}) bound | ratio | boxes' for k in 'bc')} | CPU s |\n"
    return columns + "|---" * (columns.count("|") - 1) + "|\n"


def closed() -> str:
    """The lobes with closed forms."""
    lines = header("model | alpha | F0")
    for model in LOBES:
        form = Form(specular=model, fresnel=brdf.Schlick1994)
        bracket(form, advised(ROUGHNESSES[0]))  # waits for JAX to compile
        for alpha in ROUGHNESSES:
            for f0 in REFLECTANCES:
                lines += row(f"{model.__name__} | {alpha} | {f0}", form, advised(alpha, f0))
    return lines


def lobes() -> str:
    """All others, and the exact Fresnel factor."""
    lines = header("model | Fresnel | alpha or exponent")
    cases = [(m, brdf.Schlick1994, advised(a, 0.04), a) for m in OTHERS for a in (0.01, 0.1, 1.0)]
    cases += [(brdf.GGX, brdf.Fresnel1818, advised(a, 0.04), a) for a in (0.1, 1.0)]
    cases += [(m, brdf.Schlick1994, exponential(n), n) for m in EXPONENTIAL for n in (8.0, 200.0, 20000.0)]
    seen = None
    for model, fresnel, texels, number in cases:
        form = Form(specular=model, fresnel=fresnel)
        if seen != form:
            bracket(form, texels)
        seen = form
        lines += row(f"{model.__name__} | {fresnel.__name__} | {number:g}", form, texels)
    return lines


def materials() -> str:
    """A texel of each material, in the red channel."""
    lines, target = header("material | base | coat"), target_named(TARGET)
    for path in sorted((ROOT / "data_synthetic").rglob("*.axf")):
        for material in read(path).materials:
            after = target.unpack(target.pack(material))
            height, width = grid_shape(material)
            rng = np.random.default_rng(SEED)
            uv = texel_centers(material, rng.integers(0, height, 1), rng.integers(0, width, 1))
            form, texels = form_of(material, after, CHANNEL), classes_of(material, after, uv, CHANNEL)[0]
            base = "car paint" if form.specular is None else f"{form.specular.__name__}, {form.fresnel.__name__}"
            axes = "" if texels.roughness_y is None else ", anisotropic"
            bracket(form, texels)  # waits for JAX to compile
            line = row(f"{material.id} | {base}{axes} | {form.coat or 'none'}", form, texels)
            print(line, end="", flush=True)
            lines += line
    return lines


if __name__ == "__main__":
    page = Path(__file__).with_name("bounds.md")
    text = page.read_text(encoding="utf-8")
    for name, table in (("materials", materials), ("lobes", lobes), ("closed forms", closed)):
        start, end = f"<!-- {name} -->\n", f"<!-- end of {name} -->\n"
        before, rest = text.split(start)
        _, after = rest.split(end)
        text = before + start + table() + end + after
        page.write_text(text, encoding="utf-8")
