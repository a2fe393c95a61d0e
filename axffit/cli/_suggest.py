"""`axffit verify --suggest`: the cheapest formats of a material's textures."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from axffit.cli._progress import ProgressCallback
from axffit.cli._tables import Content, table
from axffit.errors import InputError

if TYPE_CHECKING:
    from axffit.axf import AxfMaterial
    from axffit.quantization import Verdict
    from axffit.quantization.suggest import Suggestion


def check_target_alone(packed: Path | None, packed_for: str | None, read_by: str | None) -> None:
    """Refuse what has no formats to choose from.

    Raises:
        InputError: another program packed, or one engine's importer packs for another one's shader.
    """
    given = {"--packed": packed, "--packed-for": packed_for, "--read-by": read_by}
    for option, value in given.items():
        if value is not None:
            raise InputError(f"--suggest: chooses formats for one engine that packs and reads; leave {option} out")


def suggested(
    material: "AxfMaterial",
    verdict: "Verdict",
    tolerance: Path | None,
    progress: ProgressCallback,
    *,
    bounds: bool,
) -> "Suggestion":
    """The cheapest formats of a material that was judged in the advised ones.

    Raises:
        InputError: the tolerance file cannot be used.
    """
    from axffit.quantization import read_tolerances
    from axffit.quantization.suggest import suggest

    limits = None if tolerance is None else read_tolerances(tolerance)
    return suggest(material, verdict.target, limits, advised=verdict, bounds=bounds, progress=progress)


def suggestion_parts(document: Content) -> Iterator[object]:
    """Of each material with a suggestion a row a texture, what is outside, and the outcome."""
    for entry in document["materials"]:
        if "suggestion" in entry:
            content = entry["suggestion"]
            yield f"cheapest formats of {entry['verdict']['material']['id']}"
            columns = (
                "texture",
                "advised",
                "cheapest",
                "bytes before",
                "after",
                "outside tolerance, or only announced",
            )
            yield table(columns, map(_row, content["textures"]), text_columns=3)
            yield from (f"suggested formats, OUTSIDE: {failure}" for failure in content["failures"])
            yield content["summary"]
            yield ""


def _row(texture: Content) -> tuple[str, ...]:
    others = [
        f"{each['format']} {'announced' if each['within'] else 'outside'}"
        for each in texture["candidates"]
        if each["announced"] or not each["within"]
    ]
    sizes = (str(texture["bytes_before"]), str(texture["bytes_after"]))
    return texture["axf_name"], texture["advised"], texture["chosen"] or "none", *sizes, ", ".join(others)
