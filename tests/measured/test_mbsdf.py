import jax.numpy as jnp
import numpy as np
import pytest

from axffit import measured
from axffit.errors import InputError
from axffit.measured import files, mbsdf


@pytest.fixture
def table():
    return np.random.default_rng(1).normal(0.3, 0.2, (5, 5, 7, 3)).astype(np.float32)


@pytest.fixture
def path(tmp_path, table):
    path = tmp_path / "paint.mbsdf"
    mbsdf.write_table(path, table)
    return path


def test_a_written_table_is_read_back_bit_for_bit(path, table):
    np.testing.assert_array_equal(mbsdf.read_table(path), table)


def test_bytes_are_those_of_the_format(path, table):
    data = path.read_bytes()
    assert data.startswith(
        b"NVIDIA ARC MBSDF V1\nMBSDF_DATA_REFLECTION=\n\x01\x00\x00\x00\x05\x00\x00\x00\x07\x00\x00\x00"
    )
    i_in, i_out, i_phi = 3, 1, 6
    index = 3 * (i_in * 7 * 5 + i_out * 7 + i_phi)
    assert np.frombuffer(data, "<f4", 3, 55 + 4 * index).tolist() == table[i_in, i_out, i_phi].tolist()


def test_samples_sit_at_cell_centers_with_the_mirror_side_last(path, table):
    measurements = measured.read(path)
    sample = (3 * 5 + 1) * 7 + 6
    theta_in, theta_out, azimuth = np.radians([63.0, 27.0, 180.0 * 6.5 / 7])
    np.testing.assert_allclose(measurements.wi[sample], [np.sin(theta_in), 0, np.cos(theta_in)], atol=1e-12)
    np.testing.assert_allclose(measurements.wo[sample, 2], np.cos(theta_out))
    np.testing.assert_allclose(np.arctan2(*measurements.wo[sample, 1::-1]), azimuth)
    np.testing.assert_array_equal(measurements.values[sample], table[3, 1, 6])
    assert measurements.negative_count == np.count_nonzero(table < 0)
    assert measurements.valid.all()


def test_the_interpolant_returns_the_samples_and_interpolates_between_them(path, table):
    measurements, brdf = measured.read(path), measured.interpolant(path)
    values = np.asarray(brdf.evaluate(jnp.asarray(measurements.wi), jnp.asarray(measurements.wo)))
    np.testing.assert_allclose(values, np.maximum(measurements.values, 0.0), atol=1e-12)
    # 31.5 degrees is a quarter of the way from the center of row 1 (27) to that of row 2 (45).
    wi = jnp.array([np.sin(np.radians(31.5)), 0.0, np.cos(np.radians(31.5))])
    quarter = brdf.evaluate(wi, jnp.asarray(measurements.wo[(0 * 5 + 2) * 7 + 3]))
    clipped = np.maximum(table, 0.0)
    np.testing.assert_allclose(quarter, 0.75 * clipped[1, 2, 3] + 0.25 * clipped[2, 2, 3], rtol=1e-6)


def test_a_scalar_file_becomes_gray(tmp_path, table):
    path = tmp_path / "gray.mbsdf"
    mbsdf.write_table(path, table[..., :1])
    values = measured.read(path).values
    np.testing.assert_array_equal(values, np.repeat(table[..., :1].reshape(-1, 1), 3, 1))


def damage(data: bytes, kind: str) -> bytes:
    return {
        "truncated": data[:-5],
        "too long": data + b"\0",
        "only a header": data[:50],
        "other header": b"X" + data[1:],
        "type 7": data[:43] + b"\x07" + data[44:],
        "swapped bytes": data[:43] + np.frombuffer(data, "<u4", 3, 43).astype(">u4").tobytes() + data[55:],
        "empty": b"",
        "text": b"hello, this is text and no sample file",
    }[kind]


EXPECTED = {
    "truncated": "truncated: 2150 bytes, 2155 expected",
    "too long": "too long: 2156 bytes, 2155 expected",
    "only a header": "truncated: 50 bytes, the header alone has 55",
    "other header": "starts with",
    "type 7": "type 7 in the header",
    "swapped bytes": "type 16777216 in the header",
    "empty": "empty",
    "text": "starts with",
}


@pytest.mark.parametrize("kind", EXPECTED)
def test_damaged_files_are_refused_in_one_line_that_names_file_and_mend(path, kind):
    path.write_bytes(damage(path.read_bytes(), kind))
    with pytest.raises(InputError, match=EXPECTED[kind]) as caught:
        measured.read(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_missing_file_and_a_folder_are_refused(tmp_path):
    for path in (tmp_path / "nowhere.mbsdf", tmp_path):
        with pytest.raises(InputError, match="cannot be read"):
            measured.read(path)


def test_naming_another_material_is_refused(path):
    assert measured.read(path, "paint").name == "paint"
    with pytest.raises(InputError, match="holds one material"):
        measured.read(path, "red")


def test_writing_leaves_nothing_half_written(tmp_path, table, monkeypatch):
    monkeypatch.setattr(files.os, "replace", lambda *_: (_ for _ in ()).throw(OSError("disk full")))
    with pytest.raises(OSError, match="disk full"):
        mbsdf.write_table(tmp_path / "a.mbsdf", table)
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(ValueError, match="shape"):
        mbsdf.write_table(tmp_path / "a.mbsdf", table[0])


def test_the_reference_paints_have_the_documented_quality(reference_data):
    red = measured.read(reference_data("mbsdf_carpaint_nvidia", "carpaint_red.mbsdf"))
    assert len(red) == 45 * 45 * 90
    share = red.negative_count / red.values.size
    assert 0.11 < share < 0.14
