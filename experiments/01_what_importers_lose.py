"""What do engines' importers lose of AxF materials?

    python -m experiments.01_what_importers_lose [--quick]

Every synthetic material and the BASF paints go through every target's importer; a sphere in a studio is rendered of
each as AxF has it and as the engine's shader sees it, hardware filtering included. Judged is what the AxF model makes
of what comes back, not the engine's own shading model.
"""

import sys
from pathlib import Path
from typing import Any

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LogNorm

from axffit.axf import AxfMaterial
from axffit.targets import TARGETS
from experiments import common, materials

VISIBLE = 1.0
"""dE2000 that counts as just noticeable."""


def measured(material: AxfMaterial) -> dict[str, Any]:
    """Errors of the picture by target; texels that could not be kept; sizes."""
    before = materials.picture(material)
    rows = {}
    for name, module in TARGETS.items():
        packed = module.pack(material)
        kept = [t for t in packed.textures.values() if not t.defaulted]
        rows[name] = {
            **materials.errors(before, materials.picture(packed)),
            "bytes": sum(t.size_bytes for t in kept),
            "clamped_texels": sum(t.counts.clamped for t in kept),
            "notes": list(packed.notes),
        }
    return rows


def subset() -> dict[str, Any]:
    """The part that the tests compute again."""
    return materials.one_again(measured)


def main(*, quick: bool = False) -> None:
    """Compute and write the report."""
    data: dict[str, Any] = materials.results(measured, quick=quick) | {"visible_delta_e": VISIBLE}
    data["summary"] = summary(data["materials"])
    plot(data, common.write(__file__, data, text(data)) / "delta_e.png")


def plot(data: dict[str, Any], file: Path) -> None:
    """dE2000 in 99 % of the pixels, a row a material, a column a target."""
    matplotlib.use("agg")
    values = np.array([[row[target]["delta_e_p99"] for target in TARGETS] for row in data["materials"].values()])
    figure, axes = plt.subplots(figsize=(8.5, 1.3 + 0.34 * len(values)), layout="constrained")
    image = axes.imshow(values, norm=LogNorm(0.01, 30.0), cmap="viridis", aspect="auto")
    for (row, column), value in np.ndenumerate(values):
        axes.text(
            column, row, f"{value:.2g}", ha="center", va="center", fontsize=8, color="black" if value > 1.0 else "white"
        )
    axes.set_xticks(range(len(TARGETS)), list(TARGETS), fontsize=8)
    axes.set_yticks(range(len(values)), [name.replace(" (synthetic)", "") for name in data["materials"]], fontsize=8)
    figure.colorbar(image, label="dE2000, 99 % of the pixels")
    figure.savefig(file, dpi=90, metadata={"Software": None})
    plt.close(figure)


def summary(results: dict[str, Any]) -> dict[str, Any]:
    """For each target: medians over the materials, how many are visibly changed, the worst one."""
    rows = {}
    for target in TARGETS:
        p99 = {name: result[target]["delta_e_p99"] for name, result in results.items()}
        worst = max(p99, key=lambda name: p99[name])
        rows[target] = {
            "median_delta_e_mean": float(np.median([r[target]["delta_e_mean"] for r in results.values()])),
            "median_delta_e_p99": float(np.median(list(p99.values()))),
            "median_flip_mean": float(np.median([r[target]["flip_mean"] for r in results.values()])),
            "visible": sum(value > VISIBLE for value in p99.values()),
            "worst": worst,
            "worst_delta_e_p99": p99[worst],
        }
    return rows


def text(data: dict[str, Any]) -> str:
    """The report in Markdown."""
    results, rows = data["materials"], data["summary"]
    head = ["Target", "dE2000 mean", "dE2000 99 %", "FLIP mean", "visibly changed", "worst material", "its dE2000 99 %"]
    body = [
        [name, r["median_delta_e_mean"], r["median_delta_e_p99"], r["median_flip_mean"],
         f"{r['visible']} of {len(results)}", r["worst"], r["worst_delta_e_p99"]]
        for name, r in rows.items()
    ]  # fmt: skip
    each = [[name, *(r[target]["delta_e_p99"] for target in rows)] for name, r in results.items()]
    best, worst = (choose(rows, key=lambda n: rows[n]["median_delta_e_p99"]) for choose in (min, max))
    return f"""# What do engines' importers lose?

{len(results)} of {data["of_materials"]} materials, {len(rows)} targets, a sphere of {data["size"]} pixels in the
studio. Medians over the materials; "99 %" is what 99 % of a sphere's pixels do not exceed; visibly changed: above
dE2000 {VISIBLE:g} there. Measured is what comes back as an AxF material, not the engine's own shading.

{common.table(head, body)}

dE2000, 99 % of the pixels:

![dE2000 by material and target](delta_e.png)

{common.table(["Material", *rows], each)}

**Answer.** The importer that changes least is `{best}`: median dE2000 {rows[best]["median_delta_e_p99"]:.2g} in 99 % of
the pixels. The one that changes most is `{worst}`: {rows[worst]["median_delta_e_p99"]:.2g}. Visibly changed, of
{len(results)} materials, and the worst of each:

{_visible(rows)}
"""


def _visible(rows: dict[str, Any]) -> str:
    """One line a target."""
    return "\n".join(
        f"- `{name}`: {r['visible']} visibly changed, worst {r['worst']} with dE2000 {r['worst_delta_e_p99']:.3g}"
        for name, r in rows.items()
    )


if __name__ == "__main__":
    main(quick="--quick" in sys.argv)
