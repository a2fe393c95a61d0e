"""pytest plugin: the laws of reflectance on a material of your own.

``pytest --pyargs axffit.testing --axf paint.axf`` runs every law as a test of its own on every material of the file;
see ``docs/testing.md``. pytest loads this module at every start, so what costs time is imported only with ``--axf``.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from axffit.testing.checks import Check

CHECKS = pytest.StashKey[tuple["Check", ...]]()
"""The checks of the materials given on the command line, in the configuration's stash; absent without ``--axf``."""

MEASURED = "axffit"
"""Name of the user property under which a test hands what it measured to the summary."""

NO_MATERIAL = "no material was given, so no law was checked: name an .axf file with --axf FILE"


def pytest_addoption(parser: pytest.Parser) -> None:
    """The options of the plugin."""
    group = parser.getgroup("axffit", "laws of reflectance on your own material (pytest --pyargs axffit.testing)")
    group.addoption(
        "--axf", action="append", default=[], metavar="FILE", help=".axf file whose materials to check; may be repeated"
    )
    group.addoption(
        "--axf-material",
        action="append",
        default=[],
        metavar="ID",
        help="check this material of the file only; may be repeated",
    )
    group.addoption(
        "--axf-target",
        action="append",
        default=[],
        metavar="TARGET",
        help="also check what an engine receives, e.g. unity_2018: packed, validated, unpacked; may be repeated",
    )
    group.addoption(
        "--axf-texels",
        type=int,
        default=8,
        metavar="N",
        help="texels of each SVBRDF drawn at random (seeded), besides the extreme ones (default 8)",
    )


def pytest_configure(config: pytest.Config) -> None:
    """Read the files.

    Raises:
        UsageError: a file cannot be used, or an option has a wrong value.
    """
    given = config.option
    if not given.axf:
        for option, values in (("--axf-material", given.axf_material), ("--axf-target", given.axf_target)):
            if values:
                raise pytest.UsageError(f"{option} needs a file: give --axf FILE as well")
        return
    from axffit.errors import InputError
    from axffit.testing.checks import checks_of

    try:
        config.stash[CHECKS] = checks_of(
            given.axf, materials=given.axf_material, engines=given.axf_target, texels=given.axf_texels
        )
    except InputError as error:
        raise pytest.UsageError(str(error)) from None


def pytest_terminal_summary(terminalreporter: Any) -> None:
    """What was measured and not judged, and why nothing ran where nothing did."""
    lines = list(_measured(terminalreporter.stats))
    if any(_is_ours(report) for report in terminalreporter.stats.get("skipped", ())) and not lines:
        if CHECKS not in terminalreporter.config.stash:
            lines = [NO_MATERIAL]
    if lines:
        terminalreporter.section("axffit")
        for line in lines:
            terminalreporter.line(line)


def _is_ours(report: Any) -> bool:
    return "axffit/testing/" in getattr(report, "nodeid", "").replace("\\", "/")


def _measured(stats: dict[str, list[Any]]) -> Iterator[str]:
    for reports in stats.values():
        for report in reports:
            for name, value in getattr(report, "user_properties", ()):
                if name == MEASURED and getattr(report, "when", "") == "call":
                    yield value
