"""What JAX must find in the environment before it is first imported."""

import os
import sys
from pathlib import Path


def cache_folder() -> Path:
    """The user's folder for what may be thrown away, by the custom of the platform."""
    if sys.platform == "win32":
        base = os.environ.get("LOCALAPPDATA", "~/AppData/Local")
    elif sys.platform == "darwin":
        base = "~/Library/Caches"
    else:
        base = os.environ.get("XDG_CACHE_HOME") or "~/.cache"
    return Path(base).expanduser() / "axffit"


def prepare_environment() -> None:
    """Asks JAX for float64 and, unless told otherwise, to keep what it compiles for the next run.

    Compiling is most of a short run. Where the folder cannot be made, nothing is kept. OpenBLAS gets one thread: on the
    narrow banded systems of a color table its threads cost four times what they save.
    """
    os.environ["JAX_ENABLE_X64"] = "1"
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    if "JAX_COMPILATION_CACHE_DIR" in os.environ:
        return
    folder = cache_folder() / "jax"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return
    os.environ["JAX_COMPILATION_CACHE_DIR"] = str(folder)
    os.environ.setdefault("JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS", "0")
    os.environ.setdefault("JAX_PERSISTENT_CACHE_MIN_ENTRY_SIZE_BYTES", "-1")
