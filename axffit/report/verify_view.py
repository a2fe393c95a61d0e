"""A verdict's JSON as the words and numbers that its section shows."""

from collections.abc import Mapping
from typing import Any

from axffit.report.numbers import MISSING, count, number, percent, significant
from axffit.report.pictures import LIGHTS, SHAPES, SMALLEST_GAIN
from axffit.report.summary import engines

TEXTURES = {
    "diffusecolor": "Diffuse color",
    "specularcolor": "Specular color",
    "normal": "Normal",
    "specularlobe": "Specular lobe",
    "opacity": "Opacity",
    "fresnel": "Fresnel F0",
    "anisrotation": "Anisotropy rotation",
    "height": "Height",
    "brdfcolors": "BRDF colors",
    "btfflakes": "Flakes",
    "clearcoatcolor": "Clear-coat color",
    "clearcoatnormal": "Clear-coat normal",
    "clearcoatior": "Clear-coat IOR",
}

MEASURES = {
    ("angle", "degrees"): "angle",
    ("axis_angle", "degrees"): "axis angle",
    ("relative", ""): "relative",
    ("absolute", ""): "absolute",
    ("absolute", "mm"): "height",
    ("delta_e_2000", "dE2000"): "ΔE 2000",
    ("f0", ""): "F0",
    ("ior", ""): "IOR",
    ("filtered_angle", "degrees"): "angle between texels",
    ("filtered_length", ""): "length lost between texels",
    ("filtered_axis_angle", "degrees"): "axis angle between texels",
    ("filtered_f0", ""): "F0 between texels",
    ("filtered_ior", ""): "IOR between texels",
    ("filtered_relative", ""): "relative between texels",
    ("filtered_absolute", ""): "absolute between texels",
}

UNITS = {"degrees": "°", "mm": "mm", "dE2000": ""}

STATISTICS = {"mean": "mean", "p95": "95 %", "p999": "99.9 %", "max": "max"}


def verify_view(content: Mapping[str, Any]) -> dict[str, Any]:
    """Rows and sentences of a section of kind "verify"."""
    result = content["result"]
    textures = [_texture(row, content["error_maps"].get(row["name"])) for row in result["textures"]]
    return {
        "kicker": f"{result['material']['kind']} {engines(result)}",
        "badge": {
            "tone": "good" if result["within"] else "bad",
            "text": "within tolerance" if result["within"] else "outside tolerance",
        },
        "sentence": _sentence(result),
        "failures": result["failures"],
        "textures": sorted(textures, key=lambda row: row["defaulted"]),
        "reflectance": [_reflectance(row) for row in result["brdf"]["rows"]],
        "reflectance_note": _reflectance_note(result["brdf"]),
        "classes": _classes(result["brdf"]),
        "colors": [(each["illuminant"], *_three(each)) for each in result["brdf"]["colors"]],
        "expected": [
            (each["lighting"], _share(each["light"]), _share(each["picture"])) for each in result["brdf"]["expected"]
        ],
        "lut": None if result["lut"] is None else _lut(result["lut"]),
        "reasons": _reasons(result),
        "flags": result["flags"],
        "values": [(name, _value(value)) for name, value in result["values"].items()],
        "notes": result["notes"],
        "tolerances": result["tolerances"],
        "bytes": _size(sum(row["bytes"] for row in result["textures"])),
        "pictures": [_pair(facts) for facts in content["pictures"]],
    }


def _reasons(result: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Each limit that has a reason: its name in a tolerance file, and why it is what it is."""
    checks = [measure for row in result["textures"] for measure in row["measures"]]
    checks += (result["lut"] or {"checks": []})["checks"] + result["brdf"]["rows"]
    return list({check["check"]: (check["check"], check["reason"]) for check in checks if check["reason"]}.values())


def _pair(facts: Mapping[str, Any]) -> dict[str, Any]:
    """Titles, captions and numbers of a picture before and after."""
    largest, most = (significant(facts[name], 2) for name in ("largest_steps", "most_steps"))
    gain = facts["difference_gain"]
    return {
        "title": f"{SHAPES[facts['shape']]} {LIGHTS[facts['light']][0]}",
        "size": (facts["width"], facts["height"]),
        "amplified": f"Difference × {number(gain, 4)}" if gain > SMALLEST_GAIN else None,
        "steps": f"of a display's 8-bit steps: {largest} at most, below {most} in 99.5 % of the picture",
        "numbers": [
            *_of_pixels("FLIP", facts["flip"]),
            *_of_pixels("ΔE 2000", facts["delta_e_2000"]),
            ("PSNR", "∞" if facts["psnr_db"] is None else f"{number(facts['psnr_db'], 3)} dB"),
        ],
    }


def _of_pixels(name: str, summary: Mapping[str, float] | None) -> list[tuple[str, str]]:
    """Mean, 99 % and maximum of a measure; nothing where it was not taken."""
    if summary is None:
        return []
    mean, p99, largest = (significant(summary[key], 2) for key in ("mean", "p99", "max"))
    return [(name, f"{mean} mean, {p99} in 99 % of the pixels, {largest} max")]


def _sentence(result: Mapping[str, Any]) -> str:
    textures = len(result["textures"])
    if result["within"]:
        levels = "every texture" if textures else "everything"
        parts = [f"{levels} ({textures})"]
        if result["lut"] is not None:
            parts.append("the slice table")
        if result["brdf"]["evaluated"]:
            proved = all(row["judged"] == "bound" for row in result["brdf"]["rows"])
            parts.append("the reflectance" if proved else "the reflectance found (not proved)")
        joined = ", ".join(parts[:-1]) + " and " + parts[-1] if len(parts) > 1 else parts[0]
        return f"{joined[0].upper()}{joined[1:]} within tolerance."
    outside = len(result["failures"])
    return f"{outside} {'check is' if outside == 1 else 'checks are'} outside tolerance."


def _texture(row: Mapping[str, Any], error_map: Mapping[str, Any] | None) -> dict[str, Any]:
    first = row["measures"][0]
    shape = " × ".join(str(size) for size in reversed(row["shape"]))
    return {
        "title": TEXTURES.get(row["axf_name"], row["axf_name"]),
        "name": row["name"],
        "format": row["format"],
        "transform": row["transform"],
        "rounding": row["rounding"].replace("_", " "),
        "size": shape if row["levels"] == 1 else f"{shape}, {row['levels']} levels",
        "defaulted": row["defaulted"],
        "measures": [_measure(measure) for measure in row["measures"]],
        "within": row["within"],
        "remarks": _remarks(row),
        "scale_top": None if error_map is None else _quantity(error_map["largest"], first["quantity"], first["unit"]),
        "exact": error_map is None or error_map["largest"] == 0,
        "block": 1 if error_map is None else error_map["texels_per_pixel"],
        "where": _place(first["where"]),
    }


def _is_ratio(quantity: str, unit: str) -> bool:
    return quantity in ("relative", "filtered_relative") and not unit


def _quantity(value: float | None, quantity: str, unit: str, digits: int = 3) -> str:
    """A value with its unit; relative errors as percentages; None is an error without limit."""
    if value is None:
        return "∞"
    if _is_ratio(quantity, unit):
        return percent(value, digits)
    text = significant(value, digits)
    short = UNITS.get(unit, unit)
    return text + short if short == "°" else " ".join(filter(None, (text, short)))


def _measure(measure: Mapping[str, Any]) -> dict[str, Any]:
    quantity, unit = measure["quantity"], measure["unit"]
    limit = measure["tolerance"]
    statistic = STATISTICS.get(measure["statistic"] or "", "")
    shown = MISSING if limit is None else _limit(limit, quantity, unit)
    return {
        "label": f"{MEASURES.get((quantity, unit), quantity.replace('_', ' '))}{_level(measure)}",
        "values": [_quantity(measure[name], quantity, unit) for name in ("mean", "p95", "max")],
        "tolerance": shown,
        "of": f"of {statistic}" if limit is not None and statistic != "max" else "",
        "judged": limit is not None,
        "within": measure["within"],
    }


def _level(measure: Mapping[str, Any]) -> str:
    return "" if measure["level"] is None else f", level {measure['level']}"


def _limit(limit: float, quantity: str, unit: str) -> str:
    if _is_ratio(quantity, unit):
        return f"{number(100 * limit)}\u00a0%"
    short = UNITS.get(unit, unit)
    return number(limit) + short if short == "°" else " ".join(filter(None, (number(limit), short)))


def _place(where: Mapping[str, Any]) -> str:
    parts = [f"level {where['level']}"] if where["level"] else []
    parts += [] if where["slice"] is None else [f"slice {where['slice']}"]
    return ", ".join([*parts, f"row {where['row']}", f"column {where['column']}"])


def _remarks(row: Mapping[str, Any]) -> list[str]:
    """What could not be kept as it was, in words."""
    remarks = []
    texels = lambda n: f"{count(n)} texel{'' if n == 1 else 's'}"  # noqa: E731
    if row["defaulted"]:
        remarks.append("not in the material: the target's default")
    if row["clamped"]:
        remarks.append(f"{texels(row['clamped'])} clamped, by {significant(row['excess'], 2)} at most")
    if row["wrapped"]:
        remarks.append(f"{texels(row['wrapped'])} brought back by whole turns")
    if row["replaced"]:
        remarks.append(f"{texels(row['replaced'])} without meaning (not a number, or not positive) became 1.5")
    if row["folded"]:
        remarks.append(f"{texels(row['folded'])} come back as another value (n < 1 as 1/n)")
    if row["floored"]:
        remarks.append(f"{texels(row['floored'])} of roughness read as 10⁻⁴")
    if row["non_finite"]:
        remarks.append(f"{texels(row['non_finite'])} not a number or infinite in the shader")
    return remarks


BRDF_ROWS = {
    "peak_relative": ("Largest error, of the peak", "max |f′ − f| cos θᵢ / peak of f cos θᵢ for that view"),
    "log_ratio": ("Largest ratio, within the lobe", "max |log f′ − log f| where f cos θᵢ is at least 10⁻³ of the peak"),
}


def _reflectance(row: Mapping[str, Any]) -> dict[str, Any]:
    title, formula = BRDF_ROWS.get(row["name"], (row["name"], row["title"]))
    limit = row["tolerance"]
    return {
        "definition": row["definition"],
        "title": title,
        "formula": formula,
        "found": _share(row["found"]),
        "bound": _share(row["bound"]) if row["judged"] == "bound" else MISSING,
        "tolerance": MISSING if limit is None else f"{number(100 * limit)}\u00a0%",
        "within": row["within"],
        "judged": limit is not None,
    }


def _share(value: float | None) -> str:
    return "∞" if value is None else percent(value)


def _reflectance_note(brdf: Mapping[str, Any]) -> str:
    if not brdf["evaluated"]:
        return f"Not evaluated: {brdf['reason']}"
    sample, bounds = brdf["sample"], brdf["bounds"]
    found = (
        f"Found: {count(sample['ascents'])} ascents for each from the worst of {count(sample['texels'])} texels, "
        f"{sample['views']} views and {count(sample['lights'])} lights each, at least 1° above the horizon. "
    )
    if bounds["reason"]:
        proved = f"Judged is what was found; no bound is proved: {bounds['reason']}. "
    else:
        groups, cells = len(bounds["classes"]), count(bounds["cells"])
        unproved = [f"({row['definition']}) {row['unproved']}" for row in brdf["rows"] if row["unproved"]]
        together = "together" if groups == 1 else f"in {groups} groups"
        proved = f"Bound: holds for every texel, view and light; {cells} texel classes are bounded {together}. "
        proved += (
            f"Judged is what was found where there is none: {'; '.join(unproved)}. " if unproved else "It is judged. "
        )
    return f"{found}{proved}Nearer to the horizon, where f jumps to 0: {_share(brdf['strip']['found'])} of the peak."


def _three(error: Mapping[str, Any]) -> list[str]:
    return [significant(error[name]) for name in ("mean", "p95", "max")]


def _classes(brdf: Mapping[str, Any]) -> list[dict[str, str]]:
    """The groups of texel classes: how many texels, how rough, and their bounds."""
    rows = []
    for each in (brdf["bounds"] or {"classes": []})["classes"]:
        bounds = [_share(each[kind]["bound"]) for kind in BRDF_ROWS]
        ranges = [each["ranges"]["roughness"], each["ranges"]["roughness_y"]]
        roughness = " × ".join(f"{number(low, 3)} – {number(high, 3)}" for low, high in filter(None, ranges))
        channel = MISSING if each["channel"] is None else ("red", "green", "blue")[each["channel"]]
        first = roughness if each["channel"] is None else channel
        rows.append({"texels": count(each["items"]), "which": first, "b": bounds[0], "c": bounds[1]})
    return rows


def _lut(lut: Mapping[str, Any]) -> dict[str, Any]:
    used = len({k for k in lut["entries"]})
    return {
        "name": lut["name"],
        "format": lut["format"],
        "entries": f"{len(lut['entries'])} entries, {used} different",
        "wrong": lut["wrong"],
        "within": lut["within"],
        "readings": [
            {
                "decode": reading["decode"],
                "rounding": reading["rounding"],
                "all": count(len(reading["failures"])),
                "used": _listed(reading["failures_used"]),
                "clean": not reading["failures_used"],
            }
            for reading in lut["readings"]
        ],
        "checks": [
            {
                "title": check["check"].removeprefix("lut."),
                "found": number(check["found"]),
                "tolerance": MISSING if check["tolerance"] is None else number(check["tolerance"]),
                "judged": check["tolerance"] is not None,
                "within": check["within"],
                "reason": check["reason"],
            }
            for check in lut["checks"]
        ],
    }


def _listed(values: list[int]) -> str:
    return "none" if not values else f"{len(values)}: {', '.join(str(k) for k in values)}"


def _value(value: Any) -> str:
    if isinstance(value, list | tuple):
        return "(" + ", ".join(number(float(x), 6) for x in value) + ")"
    return str(value) if isinstance(value, int) else number(float(value), 6)


def _size(size: int) -> str:
    return f"{number(size / 2**20, 3)} MiB" if size >= 2**20 else f"{number(size / 2**10, 3)} KiB"
