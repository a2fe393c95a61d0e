"""What is lost when a material is refitted as another model?

    python -m experiments.08_refit_loss

Every SVBRDF of the bundled materials as Ward, Cook-Torrance and GGX, and every car paint with fewer lobes and as one
lobe below its coat, by what ``axffit refit`` does; the loss as it states it.
"""

from pathlib import Path
from typing import Any

import jax
import numpy as np
from rich.progress import track

from axffit import axf
from axffit.axf import AxfMaterial, MaterialKind
from axffit.cli import refit
from axffit.fitting.refit import MODELS
from axffit.quantization.tolerances import KINDS, default_tolerances
from experiments import common

TEXELS = 8


def cases() -> list[tuple[Path, AxfMaterial]]:
    """The bundled materials with their files."""
    files = sorted((common.ROOT / "data_synthetic").rglob("*.axf"))
    return [(file, material) for file in files for material in axf.read(file).materials]


def targets(material: AxfMaterial) -> list[tuple[str, int]]:
    """(model, lobes) that a material is refitted as."""
    coat = "+coat" if material.has_clear_coat else ""
    if material.kind is MaterialKind.CAR_PAINT:
        return [(f"carpaint{coat}", 2), (f"carpaint{coat}", 1), (f"ggx{coat}", 1)]
    return [(name + coat, 1) for name, model in MODELS.items() if model != material.specular_model]


def loss(file: Path, material: AxfMaterial, to: str, lobes: int) -> dict[str, Any]:
    """The loss as the command states it."""
    found = refit.run(file, to=to, material=material.id, lobes=lobes, texels=TEXELS)
    content = found.to_json()
    return content["loss"] | {"interpolation": content["interpolation"]}


def subset() -> dict[str, Any]:
    """The first SVBRDF as GGX or, if it is one, as Ward."""
    file, material = next(case for case in cases() if case[1].kind is MaterialKind.SVBRDF)
    to, lobes = targets(material)[-1]
    return {f"{material.id} as {to}": loss(file, material, to, lobes)}


def text(data: dict[str, Any]) -> str:
    """report.md."""
    rows, by_way = [], {}
    for case in data["cases"]:
        metrics, brdf = case["loss"]["metrics"], case["loss"]["brdf_found"]
        way = f"{case['from']} as {case['to']}"
        by_way.setdefault(way, []).append(metrics["cube_root"]["mean"])
        columns = [metrics[name]["mean"] for name in ("relative_cosine_rms", "log", "cube_root")]
        rows.append([case["material"], way, *columns, brdf["peak_relative"], brdf["log_ratio"]])
    worst = max(by_way, key=lambda way: np.median(by_way[way]))
    least = min(by_way, key=lambda way: np.median(by_way[way]))
    limits = [default_tolerances().entries[f"brdf.{kind}"].limit for kind in KINDS]
    kept = sum(row[-2] <= limits[0] and row[-1] <= limits[1] for row in rows)
    head = ("material", "refit", "cosine RMS", "log", "cube root", "(b) found", "(c) found")
    return f"""# What is lost when a material is refitted as another model?

`python -m experiments.08_refit_loss`: what `axffit refit` does with the log metric, and the loss as it states it, at
{TEXELS} texels a material. Metrics are those of fits; (b) is the largest difference found over the view's peak, (c) the
largest log ratio found where it matters, as in `verify`.

{common.table(head, rows)}

The least is lost from {least} (median cube-root error {np.median(by_way[least]):.3g}), the most from {worst}
({np.median(by_way[worst]):.3g}). Of {len(rows)} refits {kept} keep (b) and (c) within what `verify` tolerates of a
texture format by default ({limits[0]:g} and {limits[1]:g}): another lobe is another shape, and its peak or its tail
differs. A refit is a new material to look at, not a conversion.
"""


def main() -> None:
    """Every material and target."""
    jobs = [(file, material, *target) for file, material in cases() for target in targets(material)]
    found = []
    for file, material, to, lobes in track(jobs):
        source = "car paint" if material.kind is MaterialKind.CAR_PAINT else material.specular_model
        name = f"{lobes} lobe{'s' if lobes > 1 else ''}" if to.startswith("carpaint") else to.removesuffix("+coat")
        found.append({"material": material.id, "from": source, "to": name, "loss": loss(file, material, to, lobes)})
        # Every refit compiles programs of its own, and a process may hold 65 530 mappings of memory.
        jax.clear_caches()
    data = {"texels": TEXELS, "cases": found}
    common.write(__file__, data, text(data))


if __name__ == "__main__":
    main()
