"""Writing results: every file of a run appears at its end, whole, or none does."""

import json
import os
import tempfile
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from axffit.errors import InputError

Writer = Callable[[Path], object]
Results = dict[Path, str | bytes | Writer]
"""Content, or a function that writes the file it is given, by path."""


def check_outputs(outputs: Iterable[Path | None], inputs: Iterable[Path] = ()) -> None:
    """Refuses, before any work, a result that could not be written or that would overwrite an input.

    Args:
        outputs: where the results are to go; None stands for a result that nobody asked for.
        inputs: the files that the run reads.

    Raises:
        InputError: naming the path and the mend.
    """
    taken = {path.resolve(): "is read by this run" for path in inputs}
    for path in outputs:
        if path is None:
            continue
        resolved = path.resolve()
        if resolved in taken:
            raise InputError(f"{path}: cannot be written, it {taken[resolved]}; choose another name")
        taken[resolved] = "is already the name of another result"
        if path.is_dir():
            raise InputError(f"{path}: is a folder; give the name of a file in it")
        if not path.parent.is_dir():
            raise InputError(f"{path}: the folder {path.parent} does not exist; create it or choose another")
        if not os.access(path.parent, os.W_OK):
            raise InputError(f"{path}: the folder {path.parent} may not be written; choose another")


def make_folder(path: Path) -> Path:
    """A folder for results, made where it is missing.

    Raises:
        InputError: it cannot be made or written.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{path}: the folder cannot be made ({error.strerror}); choose another") from error
    if not os.access(path, os.W_OK):
        raise InputError(f"{path}: the folder may not be written; choose another")
    return path


def json_text(content: Mapping[str, Any]) -> str:
    """JSON for people and machines: indented, no NaN (which is not JSON), one newline at the end."""
    return json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def write_all(results: Results) -> None:
    """Writes every result to a temporary file beside its place, then renames them all.

    Args:
        results: per path the content, or a function that writes the file it is given. An error while writing leaves
            none of the files and no temporary one; a file that was there before stays as it was.
    """
    ready: list[tuple[Path, Path]] = []
    try:
        for path, content in results.items():
            handle, name = tempfile.mkstemp(prefix=f".{path.stem}-", suffix=path.suffix, dir=path.parent)
            os.close(handle)
            temporary = Path(name)
            ready.append((temporary, path))
            _write(temporary, content)
            _give_usual_permissions(temporary)
        for temporary, path in ready:
            os.replace(temporary, path)
    finally:
        for temporary, _ in ready:
            temporary.unlink(missing_ok=True)


def _write(path: Path, content: str | bytes | Writer) -> None:
    if isinstance(content, str):
        path.write_text(content, encoding="utf-8")
    elif isinstance(content, bytes):
        path.write_bytes(content)
    else:
        content(path)


def _give_usual_permissions(path: Path) -> None:
    """A temporary file is its owner's alone; the result shall be as any new file."""
    mask = os.umask(0)
    os.umask(mask)
    path.chmod(0o666 & ~mask)
