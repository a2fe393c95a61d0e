"""Is half precision "unnoticeable for 99 % of applications"?

    python -m experiments.03_is_half_enough [--quick]

Three pictures of every material beside the one of AxF's floats: its values rounded to half and filtered as AxF means
them (the format alone); packed for `unity_2018` (half, with UNORM16 normals and angles) and for `hdrp_10` (half
throughout), both filtered as the hardware does it.
"""

import sys
from dataclasses import replace
from typing import Any

import numpy as np

from axffit.axf import AxfMaterial
from axffit.targets import hdrp_10, unity_2018
from experiments import common, materials

WAYS = {"half": "half alone", "unity_2018": "unity_2018, filtered", "hdrp_10": "hdrp_10, filtered"}
LIMITS = {"delta_e_p99": 1.0, "flip_mean": 0.05}
"""What counts as unnoticed: dE2000 in 99 % of the pixels, mean FLIP."""


def as_half(material: AxfMaterial) -> AxfMaterial:
    """Every texture rounded to the nearest half."""

    def rounded(level: np.ndarray) -> np.ndarray:
        return np.clip(level, -65504, 65504).astype(np.float16).astype(np.float32)

    textures = {k: replace(t, levels=tuple(map(rounded, t.levels))) for k, t in material.textures.items()}
    return replace(material, textures=textures)


def measured(material: AxfMaterial) -> dict[str, Any]:
    """Errors of the picture in each way."""
    before = materials.picture(material)
    shown = {"half": as_half(material), "unity_2018": unity_2018.pack(material), "hdrp_10": hdrp_10.pack(material)}
    return {way: materials.errors(before, materials.picture(shown[way])) for way in WAYS}


def subset() -> dict[str, Any]:
    """The part that the tests compute again."""
    return materials.one_again(measured)


def main(*, quick: bool = False) -> None:
    """Compute and write the report."""
    data: dict[str, Any] = materials.results(measured, quick=quick) | {"limits": LIMITS}
    data["summary"] = summary(data["materials"])
    common.write(__file__, data, text(data))


def summary(results: dict[str, Any]) -> dict[str, Any]:
    """For each way: how many materials stay within both limits, and the worst."""
    rows = {}
    for way in WAYS:
        found = {name: result[way] for name, result in results.items()}
        noticed = [name for name, e in found.items() if any(e[key] > limit for key, limit in LIMITS.items())]
        worst = max(found, key=lambda name: found[name]["delta_e_p99"])
        rows[way] = {
            "unnoticed": len(found) - len(noticed),
            "noticed": noticed,
            "median_delta_e_p99": float(np.median([e["delta_e_p99"] for e in found.values()])),
            "largest_delta_e_p99": found[worst]["delta_e_p99"],
            "largest_flip_mean": max(e["flip_mean"] for e in found.values()),
            "worst": worst,
        }
    return rows


def text(data: dict[str, Any]) -> str:
    """The report in Markdown."""
    results, rows = data["materials"], data["summary"]
    count = len(results)
    head = ["Way", "unnoticed", "median dE2000 99 %", "largest", "largest mean FLIP", "worst material"]
    body = [
        [WAYS[way], f"{r['unnoticed']} of {count}", r["median_delta_e_p99"], r["largest_delta_e_p99"],
         r["largest_flip_mean"], r["worst"]]
        for way, r in rows.items()
    ]  # fmt: skip
    each = [
        [name, *(x for way in WAYS for x in (r[way]["delta_e_p99"], r[way]["flip_mean"]))]
        for name, r in results.items()
    ]
    columns = [f"{WAYS[way]}: {what}" for way in WAYS for what in ("dE2000 99 %", "FLIP mean")]
    half, unity, hdrp = (rows[way] for way in WAYS)
    return f"""# Is half enough?

{count} of {data["of_materials"]} materials, a sphere of {data["size"]} pixels in the studio. Unnoticed: dE2000 of
at most {LIMITS["delta_e_p99"]:g} in 99 % of the pixels and mean FLIP of at most {LIMITS["flip_mean"]:g}.
Half alone keeps negative colors; the targets clamp them at 0.

{common.table(head, body)}

{common.table(["Material", *columns], each)}

**Answer.** Half as a number format is unnoticed for {half["unnoticed"]} of {count} materials
({100 * half["unnoticed"] / count:.0f} %): median dE2000 {half["median_delta_e_p99"]:.2g} in 99 % of the pixels, at
most {half["largest_delta_e_p99"]:.2g} ({half["worst"]}). Packed as `unity_2018` wants it and filtered by the hardware,
{unity["unnoticed"]} of {count} stay unnoticed, the worst is {unity["worst"]} with dE2000
{unity["largest_delta_e_p99"]:.3g}; as `hdrp_10`, all half, {hdrp["unnoticed"]} of {count}, the worst {hdrp["worst"]}
with {hdrp["largest_delta_e_p99"]:.3g}{_noticed(rows)}
"""


def _noticed(rows: dict[str, Any]) -> str:
    noticed = sorted({*rows["unity_2018"]["noticed"], *rows["hdrp_10"]["noticed"]})
    return f". Noticed in either engine: {', '.join(noticed)}." if noticed else "."


if __name__ == "__main__":
    main(quick="--quick" in sys.argv)
