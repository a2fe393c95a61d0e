"""The tests that ``pytest --pyargs axffit.testing --axf FILE`` runs, one a material and law; not axffit's own tests."""

from collections.abc import Callable
from typing import TYPE_CHECKING

import pytest

from axffit.testing.plugin import CHECKS, MEASURED, NO_MATERIAL

if TYPE_CHECKING:
    from axffit.testing.checks import Check


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """One test a check, named by material and law; one that is skipped, with the reason, where there is none."""
    checks = metafunc.config.stash.get(CHECKS, None)
    if checks is None:
        nothing = pytest.param(None, id="no material", marks=pytest.mark.skip(reason=NO_MATERIAL))
        metafunc.parametrize("check", [nothing])
    else:
        metafunc.parametrize("check", [pytest.param(check, id=check.id) for check in checks])


def test_law(check: "Check", record_property: Callable[[str, object], None]) -> None:
    """A law holds on a material."""
    from axffit.testing.checks import NotApplicable

    measured = broken = None
    try:
        measured = check.run()
    except NotApplicable as reason:
        pytest.skip(str(reason))
    except AssertionError as error:
        broken = f"{check.material}: {error}"
    if broken is not None:
        # Out here, or pytest would print the message twice: as the failure and as its cause.
        pytest.fail(broken, pytrace=False)
    if measured is not None:
        record_property(MEASURED, f"{check.material}: {measured}")
