"""Programs outside Python that tests read axffit's files with (h5dump, cargo, npm)."""

import os
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

import pytest

REQUIRE = "AXFFIT_REQUIRE_TOOLS"


def find_tool(name: str, *, mend: str = "") -> str:
    """Path of a program, e.g. ``find_tool("h5dump", mend="Debian: hdf5-tools")``.

    A missing program skips the test by name, or fails it where AXFFIT_REQUIRE_TOOLS is 1.

    Args:
        name: the program, looked for on PATH.
        mend: where it comes from, for the message.
    """
    path = shutil.which(name)
    if path is None:
        unavailable(f"{name} not found on PATH: install it" + (f" ({mend})" if mend else ""))
    return path


def unavailable(message: str) -> NoReturn:
    """Skips the test by name, or fails it where AXFFIT_REQUIRE_TOOLS is 1."""
    if os.environ.get(REQUIRE) == "1":
        pytest.fail(message, pytrace=False)
    pytest.skip(message)


def fetch(command: Sequence[str | Path], folder: Path, *, timeout: float = 240) -> None:
    """Runs a package manager; where it cannot get its packages the test skips by name, or fails as in `find_tool`."""
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=timeout, check=False)
    if done.returncode != 0:
        last = (done.stderr or done.stdout).strip().splitlines()[-1:]
        unavailable(f"{Path(command[0]).name} {command[1]} cannot get its packages: {' '.join(last)}")


def run_tool(command: Sequence[str | Path], folder: Path, *, timeout: float = 240) -> str:
    """What a program prints; its own words in the assertion where it fails."""
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=timeout, check=False)
    assert done.returncode == 0, f"{command}: {done.stdout[-2000:]}\n{done.stderr[-4000:]}"
    return done.stdout
