"""``axffit inspect``: what an .axf file holds, and what of it was understood."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from axffit.cli import _options
from axffit.cli._output import Results, check_outputs, json_text, write_all
from axffit.cli._tables import show, table, value_text

if TYPE_CHECKING:
    from axffit.axf.hdf5 import Leaf

HELP = """Say what an .axf file holds, and what of it was understood.

Lists the materials with their models and variants, every texture with its
size and range of values, negatives and NaN, the properties, what had to be
inferred because the file does not say it, and every node that was not
recognized. Values outside their legal range are shown, not refused.

\b
Exit codes
  0  done
  2  unusable input: no AxF, damaged, or a representation that is refused

\b
Example
  axffit inspect paint.axf --tree
"""


def run(file: Path) -> dict[str, Any]:
    """Describes a file; see `axffit.axf.description.describe`.

    Raises:
        InputError: the file cannot be read.
    """
    from axffit import axf
    from axffit.axf.description import describe

    return describe(axf.read(file, validate=False))


def tree(file: Path, content: dict[str, Any] | None = None) -> list[str]:
    """Every node of the HDF5 file, a line each, with type and shape; with ``content``, what each was read as.

    Raises:
        InputError: the file is no HDF5, is damaged, or reaches outside itself.
    """
    from axffit.axf.hdf5 import opened, printable, walk

    with opened(file) as handle:
        found = walk(handle)
    roles = _roles(content) if content is not None else {}
    lines = [(parts, parts[-1] if parts else "/", "group", "/" + "/".join(parts)) for parts in found.groups]
    lines += [(leaf.parts, "@" * leaf.attribute + leaf.name, _type_of(leaf), leaf.path) for leaf in found.leaves]
    lines += [
        (node.parts, "@" * node.attribute + node.parts[-1], f"({node.what})", "")
        for node in found.unread
        if node.parts not in found.groups
    ]
    lines.sort(key=lambda line: line[0])
    return [
        printable("  ".join(filter(None, ("  " * (len(parts) - 1) + name, what, roles.get(path)))))
        for parts, name, what, path in lines
    ]


def _type_of(leaf: "Leaf") -> str:
    shape = "empty" if leaf.shape is None else "scalar" if leaf.shape == () else " x ".join(map(str, leaf.shape))
    kind = f"text of {leaf.dtype.itemsize} bytes" if leaf.dtype.kind == "S" else leaf.dtype.name or leaf.dtype.str
    return f"{kind}, {shape}"


def _roles(content: dict[str, Any]) -> dict[str, str]:
    """What is said about a node besides its type."""
    roles = {}
    for holder in (content, *content["materials"]):
        roles.update(dict.fromkeys(holder["unrecognized"], "(not recognized)"))
    for material in content["materials"]:
        for key, texture in material["textures"].items():
            roles[texture["node"]] = f"-> {key}"
    return roles


def command(
    file: Annotated[Path, typer.Argument(metavar="FILE.axf", help="The file to look into.")],
    *,
    show_tree: Annotated[
        bool, typer.Option("--tree", help="Also print every node of the HDF5 file, with types and shapes.")
    ] = False,
    json: _options.Json = None,
) -> None:
    """The verb as typer calls it; see `HELP`."""
    from axffit.errors import InputError

    check_outputs([json], [file])
    try:
        content = run(file)
    except InputError:
        # What cannot be interpreted can often still be looked at, which is what one needs then.
        if show_tree:
            show(*tree(file))
        raise
    results: Results = {} if json is None else {json: json_text(content)}
    write_all(results)
    show(*parts(content))
    if show_tree:
        show("", *tree(file, content))
    raise typer.Exit(0)


def parts(content: dict[str, Any]) -> list[object]:
    """The description for a terminal."""
    version = ".".join(map(str, content["axf_version"]))
    shown: list[object] = [f"{content['file']}: AxF {version}, {_counted(len(content['materials']), 'material')}"]
    for material in content["materials"]:
        shown += ["", *_material_parts(material)]
    shown += [f"inferred: {line}" for line in content["inferred"]]
    shown += [f"not recognized: {line}" for line in content["unrecognized"]]
    shown += [_kept(content["kept"])] if content["kept"] else []
    return shown


def _material_parts(material: dict[str, Any]) -> list[object]:
    named = f" ({material['name']})" if material["name"] != material["id"] else ""
    models = material["models"]
    if material["kind"] == "CarPaint2":
        what = f"{models['diffuse']} + {_counted(models['lobes'], 'Cook-Torrance lobe')}"
    else:
        variant = f":{models['specular_variant']}" if models["specular_variant"] else ""
        fresnel = f", Fresnel {models['fresnel_variant']}" if models["fresnel_variant"] else ", no Fresnel"
        turned = ", anisotropic" if models["anisotropic"] else ""
        what = f"{models['diffuse']} + {models['specular']}{variant}{fresnel}{turned}"
    coat = material["clear_coat"]
    if coat["present"]:
        what += ", coat " + ("refracts" if coat["refracts"] else "does not refract")
    shown: list[object] = [f"{material['id']}{named}: {material['kind']}, {what}", _profiles(material)]
    columns = ("texture", "type", "texels", "mm", "levels", "smallest", "largest", "negative", "NaN", "outside")
    rows = [_texture_row(key, texture) for key, texture in material["textures"].items()]
    if rows:
        shown.append(table(columns, rows, text_columns=4))
    shown += [f"{key} = {value_text(value)}" for key, value in material["properties"].items()]
    shown += [f"metadata {key}: {value}" for key, value in material["metadata"].items()]
    shown += [f"preview {path}: {' x '.join(map(str, shape))}" for path, shape in material["previews"].items()]
    shown += [f"inferred: {line}" for line in material["inferred"]]
    shown += [f"not recognized: {line}" for line in material["unrecognized"]]
    shown += [_kept(material["kept"])] if material["kept"] else []
    shown += [f"another representation: {entry['representation'] or entry['id']}" for entry in material["alternatives"]]
    shown += [f"UNUSABLE: {line}" for line in material["problems"]]
    return shown


def _profiles(material: dict[str, Any]) -> str:
    """The compatibility profiles that a material satisfies, or what keeps it from the nearest, and the AxF it needs."""
    satisfied = [f"{each['profile']} {each['version']}" for each in material["profiles"] if not each["obstacles"]]
    if satisfied:
        fits = f"profiles {', '.join(satisfied)}"
    else:
        nearest = min(material["profiles"], key=lambda each: len(each["obstacles"]))
        obstacles = "; ".join(nearest["obstacles"])
        fits = f"no profile; what keeps it from {nearest['profile']} {nearest['version']}: {obstacles}"
    least = material["minimum_version"]
    needs = "in no documented AxF version" if least is None else f"needs AxF {'.'.join(map(str, least))}"
    return f"{fits}; {needs}"


def _kept(paths: list[str]) -> str:
    return f"kept, to be written back: {_counted(len(paths), 'node')}"


def _texture_row(key: str, texture: dict[str, Any]) -> tuple[str, ...]:
    from axffit.report.numbers import significant

    def extreme(values: list[float | None], choose: Any) -> str:
        present = [value for value in values if value is not None]
        return significant(choose(present)) if present else "-"

    size = "x".join(map(str, texture["size"])) if texture["size"] else "?"
    slices = f"{texture['slices']} x " if texture["slices"] is not None else ""
    width, height = (significant(texture[name] or 0.0) for name in ("width_mm", "height_mm"))
    outside = f"{texture['outside']} {texture['outside_means']}" if texture["outside"] else "0"
    return (
        key,
        f"{texture['type']} x {texture['channels']}",
        slices + size,
        "constant" if texture["constant"] else f"{width} x {height}",
        str(texture["levels"]),
        extreme(texture["minimum"], min),
        extreme(texture["maximum"], max),
        str(texture["negative"]),
        str(texture["nan"]),
        outside,
    )


def _counted(count: int, noun: str) -> str:
    return f"{count} {noun}" + ("" if count == 1 else "s")
