"""One page of everything, small, made once a session."""

import pytest

from axffit import report
from axffit.fitting import compare, fit
from axffit.quantization import verify
from tests.report.examples import HOSTILE, RUN, coated, ggx, material, samples


@pytest.fixture(scope="session")
def verified() -> report.VerifiedMaterial:
    made = material()
    return report.VerifiedMaterial(verify(made, bounds=False), made)


@pytest.fixture(scope="session")
def fitted() -> report.FittedSamples:
    data = samples(HOSTILE)
    return report.FittedSamples(fit("ggx", data), data, ggx())


@pytest.fixture(scope="session")
def compared() -> report.ComparedSamples:
    data = samples("compared")
    return report.ComparedSamples(compare(coated(), data), coated(), data, ggx(), "A & B")


@pytest.fixture(scope="session")
def page(verified, fitted, compared) -> report.Page:
    return report.demo_page(verified=[verified], fitted=[fitted], compared=[compared], run=RUN, sphere_size=24)
