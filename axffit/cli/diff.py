"""``axffit diff``: in what two materials differ."""

from pathlib import Path
from typing import Annotated, Any

import typer

from axffit.cli import _options
from axffit.cli._output import Results, check_outputs, json_text, write_all
from axffit.cli._tables import show, table, value_text

HELP = """Say in what two AxF materials differ, to the last bit.

Compares models, properties, metadata and every texture: what only one of
them has, sizes, types, and how far values differ and where.

\b
Exit codes
  0  the same
  1  they differ
  2  unusable input

\b
Example
  axffit diff before.axf after.axf --material paint
"""


def run(a: Path, b: Path, *, material: str | None = None, other: str | None = None) -> dict[str, Any]:
    """Compares two materials; see `axffit.axf.difference.difference`.

    Args:
        a: an .axf file.
        b: another, or the same.
        material: id of the material in ``a``, and in ``b`` unless ``other`` is given; needed where one holds several.
        other: id of the material in ``b``.

    Raises:
        InputError: a file cannot be read, or has no such material.
    """
    from axffit import axf
    from axffit.axf.difference import difference

    first = axf.read(a, validate=False).material(material)
    return difference(first, axf.read(b, validate=False).material(material if other is None else other))


def command(
    a: Annotated[Path, typer.Argument(metavar="A.axf", help="The one file.")],
    b: Annotated[Path, typer.Argument(metavar="B.axf", help="The other.")],
    *,
    material: _options.Material = None,
    other: Annotated[
        str | None, typer.Option("--other-material", metavar="ID", help="Which material of B, where its id differs.")
    ] = None,
    json: _options.Json = None,
) -> None:
    """The verb as typer calls it; see `HELP`."""
    check_outputs([json], [a, b])
    content = run(a, b, material=material, other=other)
    results: Results = {} if json is None else {json: json_text(content)}
    write_all(results)
    show(*parts(content, str(a), str(b)))
    raise typer.Exit(0 if content["same"] else 1)


def parts(content: dict[str, Any], a: str, b: str) -> list[object]:
    """The difference for a terminal."""
    title = f"{a} ({content['a']}) and {b} ({content['b']})"
    if content["same"]:
        return [f"{title}: the same, bit for bit"]
    shown: list[object] = [f"{title}: different"]
    pairs = [
        (f"{kind} {row['name']}".strip(), value_text(row["a"], exact=True), value_text(row["b"], exact=True))
        for kind, name in (("", "fields"), ("property", "properties"), ("metadata", "metadata"))
        for row in content[name]
    ]
    if pairs:
        shown.append(table(("", "A", "B"), pairs, text_columns=3))
    if content["textures"]:
        columns = ("texture", "", "largest difference", "mean", "values that differ", "at level, index")
        shown.append(table(columns, map(_texture_row, content["textures"]), text_columns=2))
    return shown


def _texture_row(row: dict[str, Any]) -> tuple[str, ...]:
    from axffit.report.numbers import significant

    if row["only_in"] is not None:
        return row["name"], f"only in {row['only_in'].upper()}", "", "", "", ""
    values = row["values"]
    if values is None:
        return row["name"], "; ".join(row["what"]), "", "", "", ""
    return (
        row["name"],
        "; ".join(row["what"]),
        significant(values["largest"]),
        significant(values["mean"]),
        f"{values['differing']} of {values['count']}",
        "" if values["at_level_and_index"] is None else ", ".join(map(str, values["at_level_and_index"])),
    )
