"""Switches for the whole suite: float64, strict promotion, compilation cache, Hypothesis, reference data."""

import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, settings

PROJECT = Path(__file__).resolve().parents[1]

os.environ.setdefault("JAX_PLATFORMS", "cpu")
os.environ.setdefault("MPLBACKEND", "agg")
# As the command line does (axffit.cli._environment).
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import jax  # noqa: E402  (after JAX_PLATFORMS, which JAX reads once)

jax.config.update("jax_enable_x64", True)
jax.config.update("jax_numpy_dtype_promotion", "strict")
jax.config.update("jax_numpy_rank_promotion", "raise")
if "JAX_COMPILATION_CACHE_DIR" not in os.environ:
    jax.config.update("jax_compilation_cache_dir", str(PROJECT / ".cache" / "jax"))
jax.config.update("jax_persistent_cache_min_compile_time_secs", 0)
jax.config.update("jax_persistent_cache_min_entry_size_bytes", -1)

# Derandomized, so that a change that broke nothing turns nothing red; `all` (make test-all) looks ten times
# as far. A deadline and "too slow" would measure JAX's first compilation, not the test.
_COMMON: dict[str, Any] = {
    "derandomize": True,
    "database": None,
    "deadline": None,
    "suppress_health_check": [HealthCheck.too_slow],
}
settings.register_profile("ci", max_examples=40, **_COMMON)
settings.register_profile("all", max_examples=400, **_COMMON)
settings.load_profile(os.environ.get("AXFFIT_HYPOTHESIS_PROFILE", "ci"))


MAPPINGS = Path("/proc/self/maps")
MOST_MAPPINGS = 25_000


@pytest.fixture(autouse=True, scope="module")
def few_compiled_programs() -> Iterator[None]:
    """Lets go of compiled programs before they are too many.

    Each holds a few mappings of memory. Linux allows a process 65 530 of them; JAX crashes beyond.
    """
    yield
    if MAPPINGS.exists() and MAPPINGS.read_bytes().count(b"\n") > MOST_MAPPINGS:
        jax.clear_caches()


def find_reference_data(*parts: str) -> Path:
    """Path of a file or folder of the reference data, e.g. ``("nist_ptfe", "SOURCE.md")``.

    The data are no part of the project. They are looked for in the folder AXFFIT_REFERENCE_DATA, else in
    ``../shared/data`` beside the project. A missing path skips the test by name, or fails it where
    AXFFIT_REQUIRE_REFERENCE_DATA is 1.
    """
    root = Path(os.environ.get("AXFFIT_REFERENCE_DATA", PROJECT.parent / "shared" / "data"))
    path = root.joinpath(*parts)
    if path.exists():
        return path
    message = f"reference data {'/'.join(parts)} not found: point AXFFIT_REFERENCE_DATA at the data folder"
    if os.environ.get("AXFFIT_REQUIRE_REFERENCE_DATA") == "1":
        pytest.fail(message, pytrace=False)
    pytest.skip(message)


@pytest.fixture(scope="session")
def reference_data() -> Callable[..., Path]:
    """`find_reference_data`: ``reference_data("folder", "file")`` is a path, or skips the test by name."""
    return find_reference_data
