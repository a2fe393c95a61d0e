import math

import numpy as np
import pytest

from axffit.axf.ranges import FRESNEL_MAXIMUM, PROPERTY_RANGES, TEXTURE_RANGES, Outside


@pytest.mark.parametrize(
    ("key", "inside", "beyond"),
    [
        ("diffusecolor", [0.0, 1.0, 50.0], [-1e-6, math.nan]),
        ("normal", [-1.0, 0.0, 1.0, 1.0 + 2**-10], [-1.01, 1.01]),
        ("specularlobe", [0.0, 1.0], [-0.01, 1.01, math.inf]),
        ("anisrotation", [-math.pi, math.pi], [-3.2, 3.2]),
        ("opacity", [0.0, 1.0], [-0.01, 1.01]),
        ("clearcoatior", [1e-3, 1.5, math.inf], [0.0, -1.0, math.nan]),
        ("height", [-5.0, 0.0, 5.0], []),
    ],
)
def test_textures(key, inside, beyond):
    legal = TEXTURE_RANGES[key]
    assert not legal.beyond(np.array(inside)).any()
    assert legal.beyond(np.array(beyond, float)).all()


@pytest.mark.parametrize(
    ("name", "inside", "beyond"),
    [
        ("CT_F0s", [0.0, 1.0], [-0.1, 1.1]),
        ("CT_spreads", [1e-4, 8.0], [0.0, 9e-5]),
        ("thetaFI_sliceLUT", [0, 255], [-1, 256]),
        ("IOR", [0.5, 1.5], [0.0, -1.5]),
    ],
)
def test_properties(name, inside, beyond):
    legal = PROPERTY_RANGES[name]
    assert not legal.beyond(np.array(inside)).any()
    assert legal.beyond(np.array(beyond)).all()


def test_what_the_target_replaces_is_counted_and_everything_else_refused():
    counted = {key for key, legal in TEXTURE_RANGES.items() if legal.outside is Outside.COUNTED}
    colors = {"diffusecolor", "specularcolor", "fresnel", "clearcoatcolor", "brdfcolors", "btfflakes"}
    assert counted == colors | {"anisrotation", "clearcoatior"}
    assert all(legal.outside is Outside.ERROR for legal in PROPERTY_RANGES.values())
    assert FRESNEL_MAXIMUM.outside is Outside.ERROR


def test_ranges_are_written_as_intervals():
    assert str(TEXTURE_RANGES["opacity"]) == "[0, 1]"
    assert str(PROPERTY_RANGES["IOR"]) == "(0, inf)"
