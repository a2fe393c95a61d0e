"""pytest plugin: the laws of reflectance on a material of your own.

``pytest --pyargs axffit.testing --axf paint.axf`` runs every law as a test of its own on every material of the file;
see ``docs/testing.md``. pytest loads this module at every start, so what costs time is imported only with ``--axf``.
"""

import sys
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from axffit.testing.checks import Check

CHECKS = pytest.StashKey[tuple["Check", ...]]()
"""The checks of the materials given on the command line, in the configuration's stash; absent without ``--axf``."""

ARGUMENT = "axffit_check"
"""Name of the argument through which a test receives one check; it is called once for each."""

MEASURED = "axffit"
"""Name of the user property under which a test hands what it measured to the summary."""

NO_MATERIAL = "no material was given, so no law was checked: name an .axf file with --axf FILE"

_LOADED_EARLY = frozenset({"axffit", "axffit.testing", "axffit.testing.plugin"})


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
        help="check this material of the files only; may be repeated",
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
        help="places of each material drawn at random (seeded), besides the extreme texels (default 8)",
    )
    group.addoption(
        "--axf-strict",
        action="store_true",
        help="negative colors, which files may hold and engines read as 0, fail the check negative-colors",
    )


@pytest.hookimpl(tryfirst=True)
def pytest_load_initial_conftests(early_config: pytest.Config) -> None:
    """Let ``--jaxtyping-packages`` instrument axffit: jaxtyping refuses packages that are imported already.

    Only this module and two that hold no code are; they are forgotten, and imported anew when next asked for.
    """
    loaded = {name for name in sys.modules if name.partition(".")[0] == "axffit"}
    if getattr(early_config.known_args_namespace, "jaxtyping_packages", None) and loaded <= _LOADED_EARLY:
        for name in loaded:
            del sys.modules[name]


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
            given.axf,
            materials=given.axf_material,
            engines=given.axf_target,
            texels=given.axf_texels,
            strict=given.axf_strict,
        )
    except InputError as error:
        raise pytest.UsageError(str(error)) from None


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """One call a check, named by material and law; one that is skipped, with the reason, where there is none."""
    if ARGUMENT not in metafunc.fixturenames:
        return
    checks = metafunc.config.stash.get(CHECKS, None)
    if checks is None:
        nothing = pytest.param(None, id="no material", marks=pytest.mark.skip(reason=NO_MATERIAL))
        metafunc.parametrize(ARGUMENT, [nothing])
    else:
        metafunc.parametrize(ARGUMENT, [pytest.param(check, id=check.id) for check in checks])


def pytest_terminal_summary(terminalreporter: Any) -> None:
    """What was measured and not judged, and why nothing ran where nothing did."""
    stats = terminalreporter.stats
    lines = list(_measured(stats))
    if any(NO_MATERIAL in str(report.longrepr) for report in stats.get("skipped", ())):
        lines.append(NO_MATERIAL)
    if lines:
        terminalreporter.section("axffit")
        for line in lines:
            terminalreporter.line(line)


def _measured(stats: dict[str, list[Any]]) -> Iterator[str]:
    for reports in stats.values():
        for report in reports:
            for name, value in getattr(report, "user_properties", ()):
                if name == MEASURED and getattr(report, "when", "") == "call":
                    yield value
