"""The table of directions: both ways to write it, and each way to get it wrong."""

import numpy as np
import pytest

from axffit.errors import InputError
from axffit.fitting.texels.stack import read_stack
from tests.fitting.texels.stacks import write_image

VECTORS = "file,light_x,light_y,light_z,view_x,view_y,view_z"
ANGLES = "file, light_theta, light_phi, view_theta, view_phi, irradiance"


@pytest.fixture
def table(tmp_path):
    write_image(tmp_path / "a.exr", np.arange(24.0).reshape(2, 3, 4))

    def write(*lines):
        path = tmp_path / "directions.csv"
        path.write_text("\n".join(lines) + "\n")
        return path

    return write


def test_vectors_and_angles_give_the_same_directions(table):
    vectors = read_stack(table(VECTORS, "a.exr,0,2,2,0,0,5"))
    angles = read_stack(table(ANGLES, "a.exr, 45, 90, 0, 0, 0.5"))
    np.testing.assert_allclose(vectors.wi, [[0, np.sqrt(0.5), np.sqrt(0.5)]], atol=1e-15)
    np.testing.assert_allclose(vectors.wi, angles.wi, atol=1e-15)
    np.testing.assert_allclose(vectors.wo, angles.wo, atol=1e-15)
    np.testing.assert_array_equal(vectors.image(0), np.arange(24.0).reshape(2, 3, 4)[..., :3])
    np.testing.assert_array_equal(angles.image(0), 2.0 * vectors.image(0))


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        (["file,light_x", "a.exr,1"], "has columns file, light_x; needed are file and either"),
        ([VECTORS.removeprefix("file,"), "0,0,1,0,0,1"], "needed are file"),
        ([VECTORS], "has a header and no images"),
        ([VECTORS, "b.exr,0,0,1,0,0,1"], "line 2: no such image 'b.exr'"),
        ([VECTORS, "a.exr,0,0,1,0,0,up"], "line 2: view_z is 'up'"),
        ([VECTORS, "a.exr,0,0,1,0,0"], "line 2: view_z is None"),
        ([VECTORS, "a.exr,0,0,1,0,0,nan"], "line 2: view_z is 'nan'"),
        ([VECTORS, "a.exr,0,0,0,0,0,1"], r"line 2: direction \(0, 0, 0\) is not above"),
        ([VECTORS, "a.exr,0,0,1,1,0,-1"], r"line 2: direction \(1, 0, -1\) is not above"),
        ([ANGLES, "a.exr,95,0,0,0,1"], r"line 2: direction \(95, 0\) is not above"),
        ([ANGLES, "a.exr,0,0,0,0,0"], "line 2: irradiance 0; give a number above 0"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_a_table_that_cannot_be_used_is_refused(table, lines, said):
    with pytest.raises(InputError, match=said):
        read_stack(table(*lines))


def test_files_that_cannot_be_used_are_refused(table, tmp_path):
    with pytest.raises(InputError, match="no such file"):
        read_stack(tmp_path / "nothing.csv")
    (tmp_path / "binary.csv").write_bytes(b"\xff\xfe\x00\x80")
    with pytest.raises(InputError, match="is no CSV text"):
        read_stack(tmp_path / "binary.csv")
    write_image(tmp_path / "a.exr", np.ones((2, 3, 2)))
    with pytest.raises(InputError, match="has 2 channels"):
        read_stack(table(VECTORS, "a.exr,0,0,1,0,0,1")).image(0)
