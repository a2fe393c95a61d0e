"""The test that ``pytest --pyargs axffit.testing --axf FILE`` runs, once a material and law; not axffit's own tests."""

from collections.abc import Callable

import pytest

from axffit.testing.checks import Check, NotApplicable
from axffit.testing.plugin import MEASURED


def test_law(axffit_check: Check, record_property: Callable[[str, object], None]) -> None:
    """A law holds on a material; the plugin calls this once a check."""
    check = axffit_check
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
