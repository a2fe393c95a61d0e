"""The materials that experiments 01 and 03 look at, and how two pictures of one are compared."""

import json
import os
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from axffit import axf
from axffit.axf import AxfMaterial, AxfTexture, MaterialKind
from axffit.preview import Samples, Shown, Studio, encode_srgb, render_sphere, sphere_scene, tone_curve
from axffit.quantization.images import image_errors
from experiments import common

SYNTHETIC = common.ROOT / "data_synthetic"
SIZE, REPEATS = 48, 1.0
QUICK = ("solid_yellow", "patent_leather", "brushed_carbon")
"""Ids of the synthetic materials of a quick run; the BASF paints are always looked at."""
SUBSET = "solid_yellow"
SAMPLES = Samples(lobe=16, cosine=32, light=32)


def synthetic() -> Iterator[AxfMaterial]:
    """Every material of every synthetic package."""
    for file in sorted(SYNTHETIC.rglob("*.axf")):
        yield from axf.read(file).materials


def basf_paints(folder: Path) -> Iterator[AxfMaterial]:
    """The paints of ``axf_carpaint_basf``, without flakes: their stacks of slices are not public."""
    for paint in json.loads((folder / "carpaint2_params.json").read_text(encoding="utf-8")):
        used = [k for k, coefficient in enumerate(paint["CT_coeffs"]) if coefficient > 0]
        lobes = {name: np.asarray(paint[name])[used] for name in ("CT_coeffs", "CT_F0s", "CT_spreads")}
        values = {"CT_diffuse": paint["CT_diffuse"], "IOR": paint["IOR"], "cc_no_refraction": paint["cc_no_refraction"]}
        table = color_table(folder / paint["BRDFcolors_file"])
        yield AxfMaterial(
            id=paint["slug"],
            name=f"BASF {paint['name']}",
            kind=MaterialKind.CAR_PAINT,
            textures={
                "brdfcolors": AxfTexture((table,)),
                "clearcoatior": AxfTexture((np.full((1, 1, 1), paint["IOR"], np.float32),)),
            },
            properties={**values, **lobes},
        )


def color_table(file: Path) -> np.ndarray:
    """A table [theta_d, theta_h, RGB] of a CSV file of rows (theta_d index, theta_h index, R, G, B)."""
    rows = np.loadtxt(file, delimiter=",", skiprows=1)
    side = int(rows[:, 0].max()) + 1
    table = np.zeros((side, side, 3), np.float32)
    table[rows[:, 0].astype(int), rows[:, 1].astype(int)] = rows[:, 2:]
    return table


def chosen(*, quick: bool) -> list[AxfMaterial]:
    """The synthetic materials and, where the reference data lie beside the project, the BASF paints."""
    folder = Path(os.environ.get("AXFFIT_REFERENCE_DATA", common.ROOT.parent / "shared" / "data")) / "axf_carpaint_basf"
    paints = list(basf_paints(folder)) if folder.exists() else []
    return [*paints, *(m for m in synthetic() if not quick or m.id in QUICK)]


def count() -> int:
    """How many materials a whole run looks at."""
    return len(chosen(quick=False))


Measure = Callable[[AxfMaterial], dict[str, Any]]


def one_again(measured: Measure) -> dict[str, Any]:
    """The part that the tests compute again: one solid paint."""
    return {m.name: measured(m) for m in synthetic() if m.id == SUBSET}


def results(measured: Measure, *, quick: bool) -> dict[str, Any]:
    """What was measured of each material, and of how many there are; those of one name are told apart by their ids."""
    looked_at = chosen(quick=quick)
    names = Counter(m.name for m in looked_at)
    labels = [m.name if names[m.name] == 1 else f"{m.name}, {m.id}" for m in looked_at]
    return {
        "size": SIZE,
        "of_materials": count(),
        "materials": {label: measured(m) for label, m in zip(labels, looked_at, strict=True)},
    }


def picture(shown: Shown, size: int = SIZE) -> np.ndarray:
    """A sphere of it in the studio as a display takes it, sRGB values (size, size, 3)."""
    return encode_srgb(tone_curve(render_sphere(shown, Studio(), size=size, repeats=REPEATS, samples=SAMPLES)))


def errors(before: np.ndarray, after: np.ndarray) -> dict[str, Any]:
    """Means and 99 % of dE2000 and FLIP over the pixels of the sphere, and PSNR."""
    found = image_errors(before, after, sphere_scene(len(before)).coverage > 0.0)
    if found.delta_e_2000 is None or found.flip is None:
        raise RuntimeError("the experiments need colour-science and flip-evaluator: pip install axffit[color,flip]")
    return {
        "delta_e_mean": found.delta_e_2000.mean,
        "delta_e_p99": found.delta_e_2000.p99,
        "delta_e_max": found.delta_e_2000.max,
        "flip_mean": found.flip.mean,
        "flip_p99": found.flip.p99,
        "psnr_db": found.psnr,
    }
