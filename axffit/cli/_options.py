"""Options that several verbs share, so that they read alike everywhere."""

import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer

Material = Annotated[
    str | None, typer.Option(metavar="ID", help="Which material; needed where the file holds several.")
]
SampleName = Annotated[
    str | None, typer.Option(metavar="NAME", help="Which of the samples; needed where the file holds several.")
]
Json = Annotated[Path | None, typer.Option(metavar="FILE", help="Write every number as JSON to this file.")]
Html = Annotated[Path | None, typer.Option(metavar="FILE", help="Write a page that needs no other file.")]


def command_line(verb: str, files: list[Path], options: Mapping[str, object]) -> str:
    """The command that computes the same again, for a page to name; options that are None are left out."""
    words = ["axffit", verb, *(str(file) for file in files)]
    for name, value in options.items():
        words += [] if value is None else [f"--{name}", str(value)]
    return shlex.join(words)
