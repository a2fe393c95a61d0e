"""Does the slice table of a car paint's flakes survive an 8-bit UNORM texture, and what does a wrong entry cost?

    python -m experiments.04_slice_lut [--quick]

Every entry 0..255 through every way a shader may hold and round the texel (`quantization.slice_lut`, exhaustive), and
through R8_UINT; then the tables of the synthetic paints: the entries each way loses, and how far the slices that the
wrong entries lead to are from the right ones.
"""

import sys
from collections.abc import Callable, Iterator
from typing import Any

import matplotlib
import matplotlib.pyplot as plt
import numpy as np

from axffit.axf import AxfMaterial
from axffit.quantization.slice_lut import DECODES, ENTRIES, READINGS, lut_readings
from experiments import common, materials


def lost() -> dict[str, Any]:
    """How many of the 256 entries each way loses, and the first of them."""
    return {
        f"{reading.decode}, {reading.rounding}": {"lost": len(reading.failures), "first": list(reading.failures[:5])}
        for reading in lut_readings()
    }


def paints() -> Iterator[AxfMaterial]:
    """The synthetic paints with flakes."""
    for material in materials.synthetic():
        if "btfflakes" in material.textures and "thetaFI_sliceLUT" in material.properties:
            yield material


def read_back(decode: str, rounding: str) -> np.ndarray:
    """What entries 0..255 come back as, (256,)."""
    held = DECODES[decode]()
    return READINGS[rounding](held * held.dtype.type(255)).astype(int)


def flake_error(material: AxfMaterial, entries: np.ndarray) -> float:
    """RMS difference over RMS of the slices that a table of other entries leads to, over all bins and texels.

    Step k of a bin shows slice entry + k as long as that lies below the next entry, and black otherwise.
    """
    slices = material.textures["btfflakes"].data.astype(np.float64)
    table = np.asarray(material.properties["thetaFI_sliceLUT"])
    bins = min(int(material.properties["max_thetaI"]), len(table) - 1)
    black = np.zeros_like(slices[0])
    squared = given = 0.0
    for number in range(bins):
        for step in range(int(table[number + 1]) - int(table[number])):
            right, seen = slices[table[number] + step], int(entries[number]) + step
            shown = slices[seen] if seen < min(int(entries[number + 1]), len(slices)) else black
            squared, given = squared + np.sum((shown - right) ** 2), given + np.sum(right**2)
    return float(np.sqrt(squared / given))


def paint_rows(material: AxfMaterial) -> dict[str, Any]:
    """For each way: entries of this paint's table that come back wrong, and the error of the slices."""
    table = np.asarray(material.properties["thetaFI_sliceLUT"])
    rows: dict[str, Any] = {}
    seen: dict[tuple[int, ...], float] = {tuple(table): 0.0}
    for decode in DECODES:
        for rounding in READINGS:
            back = read_back(decode, rounding)[table]
            key = tuple(int(e) for e in back)
            if key not in seen:
                seen[key] = flake_error(material, back)
            wrong = int(np.count_nonzero(back != table))
            rows[f"{decode}, {rounding}"] = {"wrong": wrong, "entries": len(table), "slices_rms": seen[key]}
    return rows


def subset() -> dict[str, Any]:
    """The part that the tests compute again: all 256 entries, and the first paint's table."""
    first = next(paints())
    return {"lost": lost(), "paint": {first.name: paint_rows(first)}}


def main(*, quick: bool = False) -> None:
    """Compute and write the report."""
    chosen = list(paints())[: 1 if quick else None]
    data = {"entries": len(ENTRIES), "lost": lost(), "paints": {m.name: paint_rows(m) for m in chosen}}
    at = common.write(__file__, data, text(data))
    plot(data, at / "lost.png")


def plot(data: dict[str, Any], file: Any) -> None:
    """Lost entries by way."""
    matplotlib.use("agg")
    figure, axes = plt.subplots(figsize=(7.5, 3.6), layout="constrained")
    names = list(data["lost"])[::-1]
    bars = axes.barh(names, [data["lost"][name]["lost"] for name in names], color="#4878a8")
    axes.bar_label(bars, padding=3, fontsize=8)
    axes.set(xlabel="entries of 0..255 that come back wrong", xlim=(0, 280))
    axes.tick_params(labelsize=8)
    figure.savefig(file, dpi=90, metadata={"Software": None})
    plt.close(figure)


def text(data: dict[str, Any]) -> str:
    """The report in Markdown."""
    ways, found = data["lost"], data["paints"]
    body = [[name, row["lost"], ", ".join(map(str, row["first"])) or "none"] for name, row in ways.items()]
    each = [
        [paint, way, f"{row['wrong']} of {row['entries']}", row["slices_rms"]]
        for paint, rows in found.items()
        for way, row in rows.items()
        if row["wrong"]
    ]
    rounded = max(row["lost"] for name, row in ways.items() if name.endswith("rounded"))
    worst = max((row["slices_rms"] for rows in found.values() for row in rows.values()), default=0.0)
    hit = sorted({paint for paint, *_ in each})
    truncated = {name.removesuffix(", truncated"): row["lost"] for name, row in ways.items() if "truncated" in name}
    return f"""# Does the slice table survive 8 bits?

k / 255 in R8_UNORM, read back as 255 · texel, all {data["entries"]} values of k:

{common.table(["Texel held as, index", "lost", "first of them"], body)}

![Lost entries](lost.png)

Tables of the synthetic paints, where an entry is lost, with the RMS error of the slices shown over their RMS:

{common.table(["Paint", "Way", "entries wrong", "slices, relative RMS"], each) if each else "None loses an entry."}

**Answer.** It does if the shader rounds: {rounded} of {data["entries"]} entries are lost, however the texel is held.
If it truncates, none are lost from {_listed(truncated, lambda n: n == 0)}; {_losses(truncated)}.
{len(hit)} of {len(found)} synthetic paints have entries that some truncating way loses; their slices are then up to
{100 * worst:.0f} % off (RMS).
"""


def _listed(lost: dict[str, int], which: Callable[[int], bool]) -> str:
    return " or ".join(f"`{name}`" for name, count in lost.items() if which(count))


def _losses(lost: dict[str, int]) -> str:
    return ", ".join(f"{count} from `{name}`" for name, count in lost.items() if count)


if __name__ == "__main__":
    main(quick="--quick" in sys.argv)
