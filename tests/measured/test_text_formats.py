"""What the text formats and UTIA mean, on small files and on the reference data."""

import numpy as np
import pytest

from axffit import measured
from axffit.errors import InputError
from axffit.measured import multiangle, plain_csv, utia
from axffit.measured.measurements import RGBChannels, Wavelengths
from tests.measured import makers


def read(tmp_path, name):
    makers.MAKERS[name](tmp_path / name)
    return measured.read(tmp_path / name)


def polar(v):
    return np.degrees(np.arctan2(np.hypot(v[..., 0], v[..., 1]), v[..., 2]))


def azimuth(v):
    return np.degrees(np.arctan2(v[..., 1], v[..., 0]))


def nanometers(samples):
    assert isinstance(samples.channels, Wavelengths)
    return samples.channels.nanometers.tolist()


def test_utia_rows_are_the_light_and_columns_the_viewer(tmp_path):
    table = np.random.default_rng(1).uniform(0, 1, (288, 288, 3))
    path = tmp_path / "a.bin"
    utia.write_table(path, table)
    raw = np.frombuffer(path.read_bytes(), "<f8").reshape(3, 288, 288)
    samples = measured.read(path)
    row, column = 48 * 2 + 10, 48 * 5 + 47
    place = 288 * row + column
    np.testing.assert_array_equal(samples.values[place], raw[:, row, column])
    assert [polar(samples.wi[place]), azimuth(samples.wi[place])] == pytest.approx([30, 75])
    assert [polar(samples.wo[place]), azimuth(samples.wo[place])] == pytest.approx([75, -7.5])
    assert samples.valid.all()
    path.write_bytes(np.frombuffer(path.read_bytes(), "<f8").astype(">f8").tobytes())
    with pytest.raises(InputError, match="big-endian"):
        measured.read(path)
    with pytest.raises(ValueError, match="shape"):
        utia.write_table(path, table[:3])


def test_utia_as_exr_is_the_same(tmp_path):
    import OpenEXR

    table = np.random.default_rng(1).uniform(0, 1, (288, 288, 3)).astype(np.float32)
    path = tmp_path / "a.exr"
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with OpenEXR.File(header, {c: table[..., k].copy() for k, c in enumerate("RGB")}) as file:
        file.write(str(path))
    np.testing.assert_array_equal(measured.read(path).values, table.reshape(-1, 3))
    path.write_bytes(path.read_bytes()[:2000])
    with pytest.raises(InputError, match="a.exr"):
        measured.read(path)


def test_zemax_angles_turn_about_the_mirror_direction(tmp_path):
    samples = read(tmp_path, "paint.zemax")
    values = makers.zemax_values()
    np.testing.assert_array_equal(samples.values[:, 0], values.ravel())
    angles = polar(samples.wo).reshape(2, 3, 4)
    np.testing.assert_allclose(angles[0, 0], [15, 5, 15, 45], atol=1e-9)
    np.testing.assert_allclose(angles[1, 2], [45, 55, 75, 105], atol=1e-9)
    # At 90 degrees the radial angle lies across the plane of incidence: spherical Pythagoras.
    np.testing.assert_allclose(np.cos(np.radians(angles[1, 1, 2])), np.cos(np.radians(45)) * np.cos(np.radians(30)))
    assert azimuth(samples.wi).max() == 0
    assert not samples.valid[-1]
    assert samples.valid.sum() == 23


def test_zemax_xyz_becomes_rgb(tmp_path):
    path = tmp_path / "a.zemax"
    makers.zemax_file(path)
    head, body = path.read_text().replace("Content Monochrome", "Content XYZ").split("Monochrome\n")
    path.write_text(head + "".join(f"Tristimulus{c}\n{body}" for c in "XYZ"))
    samples = measured.read(path)
    # Equal X, Y and Z: the row sums of the matrix of IEC 61966-2-1.
    np.testing.assert_allclose(samples.values[0], [1.2048, 0.9484, 0.9087], atol=1e-9)
    assert samples.channels == RGBChannels(white="D65")


def test_the_imaging_spheres_file_is_consistent_with_its_own_tis(reference_data):
    samples = measured.read(reference_data("zemax_imaging_sphere", "imaging_sphere_2008_planesymmetric_brdf.bsdf"))
    assert len(samples) == 13 * 19 * 11
    # What is zero lies beyond the horizon or within 7 degrees of it.
    assert polar(samples.wo)[~samples.valid].min() > 82
    # The integral of f cos over the file's own nodes is the TIS that the instrument's program states, to the coarseness
    # of the nodes; without the cosine it is half as large again.
    theta = np.radians([0, 5, 10, 15, 20, 30, 40, 50, 60, 70, 80])
    for k, stated in enumerate((0.134506, 0.1321704, 0.1371284, 0.1371577)):
        chosen = slice(k * 19 * 11, (k + 1) * 19 * 11)
        f_cosine = samples.values[chosen, 0] * samples.valid[chosen] * samples.wo[chosen, 2]
        product = f_cosine.reshape(19, 11) * np.sin(theta)
        total = 2 * np.trapezoid(np.trapezoid(product, theta, axis=1), np.radians(np.arange(0, 181, 10)))
        assert total == pytest.approx(stated, rel=0.09)


def test_astm_columns(tmp_path):
    samples = read(tmp_path, "paint.astm")
    assert samples.name == "a paint"
    assert nanometers(samples) == [465, 525, 630]
    np.testing.assert_allclose(samples.values, np.array(makers.ASTM_ROWS)[:, 4:])
    np.testing.assert_allclose(np.radians(polar(samples.wi)), [0.1, 0.5, 1.0])
    np.testing.assert_allclose(np.radians(azimuth(samples.wo)), [3, -1, 0.5])


def test_astm_noise_is_read(tmp_path):
    path = tmp_path / "a.astm"
    path.write_text("VARS theta_i,theta_s,BRDF,sigma_BRDF\n0.1,0.2,0.3,0.01\n")
    samples = measured.read(path)
    assert samples.sigma is not None
    assert samples.sigma.tolist() == [[0.01] * 3]
    assert "phi_i and phi_s not stated" in samples.provenance["grid"]


ALTA = {
    "COS_TH": ([0.5], [60, 60, 0]),
    "RUSIN_TH_TD_PD": ([0.0, 0.5, 0.0], [np.degrees(0.5), np.degrees(0.5), 180]),
    "RUSIN_TH_PH_TD_PD": ([0.0, 0.3, 0.5, 0.0], [np.degrees(0.5), np.degrees(0.5), 180]),
    "RUSIN_TH_TD": ([0.0, 0.5], [np.degrees(0.5), np.degrees(0.5), 180]),
    "ISOTROPIC_TV_TL": ([0.2, -0.4], [np.degrees(0.4), np.degrees(0.2), 180]),
    "ISOTROPIC_TV_TL_DPHI": ([0.2, 0.4, 0.5], [np.degrees(0.4), np.degrees(0.2), np.degrees(0.5)]),
    "ISOTROPIC_TL_TV_PROJ_DPHI": ([0.4, 0.0, 0.2], [np.degrees(0.4), np.degrees(0.2), 90]),
    "SPHERICAL_TL_PL_TV_PV": ([0.4, 1.0, 0.2, 1.5], [np.degrees(0.4), np.degrees(0.2), np.degrees(0.5)]),
    "CARTESIAN": ([0.0, 0.6, 0.8, 0.6, 0.0, 0.8], [36.8699, 36.8699, 90]),
}
"""By input: a row, and theta of light, of viewer, and their azimuth difference in degrees."""


@pytest.mark.parametrize("kind", ALTA)
def test_alta_inputs(kind, tmp_path):
    row, expected = ALTA[kind]
    path = tmp_path / "a.alta"
    path.write_text(
        f"#DIM {len(row)} 3\n#PARAM_IN {kind}\n#PARAM_OUT RGB_COLOR\n" + f"{' '.join(map(str, row))} 1 2 3\n"
    )
    samples = measured.read(path)
    difference = abs((azimuth(samples.wo[0]) - azimuth(samples.wi[0]) + 180) % 360 - 180)
    np.testing.assert_allclose([polar(samples.wi[0]), polar(samples.wo[0]), difference], expected, atol=1e-4)
    assert samples.values.tolist() == [[1, 2, 3]]


def test_alta_divides_the_viewers_cosine_out(tmp_path):
    samples = read(tmp_path, "paint.alta")
    np.testing.assert_allclose(samples.values[0], 0.5 / np.cos(np.hypot(0.4, 0.1)) * np.ones(3))
    assert samples.name == "tape"


def test_the_retroreflective_tape_shines_back(reference_data):
    samples = measured.read(reference_data("alta_measured", "retro-3M-jaune.dat"))
    assert samples.name == "3M Yellow"
    for incidence in (15, 30):
        chosen = samples.valid & (np.abs(polar(samples.wi) - incidence) < 0.1) & (polar(samples.wo) < 80)
        back = chosen & ((samples.wi * samples.wo).sum(axis=1) > np.cos(np.radians(2)))
        assert samples.values[back].max() > 0.99 * samples.values[chosen].max()
    # At 60 degrees its gloss is brighter than what it sends back: the mirror direction is on the other side.
    chosen = np.flatnonzero(samples.valid & (np.abs(polar(samples.wi) - 60) < 0.1) & (polar(samples.wo) < 80))
    brightest = chosen[samples.values[chosen, 0].argmax()]
    assert samples.wi[brightest] * [-1, -1, 1] @ samples.wo[brightest] > np.cos(np.radians(2))


def test_pink_felt_is_read(reference_data):
    samples = measured.read(reference_data("alta_measured", "pink-felt-1d.alta"))
    assert len(samples) == 90
    np.testing.assert_allclose(samples.values[0], [0.109704419970512, 0.0794405192136765, 0.0616232864558697])


def test_nist_wavelengths_become_channels(tmp_path):
    samples = read(tmp_path, "ptfe.csv")
    assert nanometers(samples) == [351, 532]
    assert samples.values.tolist() == [[0.3, 0.3], [0.31, 0.31], [0.32, 0.32]]
    # A negative polar angle lies on the other side: -75 and 75 degrees at azimuth 0 are mirror directions.
    np.testing.assert_allclose(samples.wi[1] + samples.wo[1], [0, 0, 2 * np.cos(np.radians(75))], atol=1e-12)


def test_nist_wavelengths_of_other_directions_are_refused(tmp_path):
    path = tmp_path / "a.csv"
    makers.nist_file(path)
    path.write_text("".join(path.read_text().splitlines(keepends=True)[:-1]))
    with pytest.raises(InputError, match="do not list the same directions"):
        measured.read(path)


def test_the_ptfe_tables_agree_with_each_other(reference_data):
    regular = measured.read(reference_data("nist_ptfe", "PTFE.data.csv"))
    assert nanometers(regular) == [351, 532, 633, 1064]
    assert len(regular) == 1824
    random = measured.read(reference_data("nist_ptfe", "PTFE.data.random.csv"))
    assert (nanometers(random), len(random)) == ([532], 1760)
    # Both find the same material: a diffuser that is brighter toward the mirror direction at grazing angles.
    for samples, channel in ((regular, 1), (random, 0)):
        steep = samples.valid & (polar(samples.wi) < 50) & (polar(samples.wo) < 50)
        assert samples.values[steep, channel].mean() == pytest.approx(1 / np.pi, rel=0.1)
        grazing = samples.valid & (polar(samples.wi) > 55) & (polar(samples.wo) > 60)
        forward = (samples.wi[:, :2] * samples.wo[:, :2]).sum(axis=1) < 0
        values = samples.values[:, channel]
        assert values[grazing & forward].mean() > 1.1 * values[grazing & ~forward].mean()


def test_geometries_of_multi_angle_instruments():
    names = ["45as-15", "45as15", "r45as25", "45as45", "45as110", "15as-15", "45as25az90", "45as25AZ-90"]
    wi, wo = multiangle.directions(names)
    signed = np.degrees(np.arctan2(wo[:, 0], wo[:, 2]))
    np.testing.assert_allclose(signed[:6], [-60, -30, -20, 0, 65, -30], atol=1e-9)
    np.testing.assert_allclose(polar(wi), [45, 45, 45, 45, 45, 15, 45, 45])
    # Out of the plane, as far from the mirror direction, on either side.
    mirror = wi[6] * [-1, -1, 1]
    assert np.degrees(np.arccos(wo[6] @ mirror)) == pytest.approx(25)
    np.testing.assert_allclose(wo[7], wo[6] * [1, -1, 1], atol=1e-12)


def test_reflectance_factors_become_f_in_both_forms(tmp_path):
    samples = read(tmp_path, "multiangle.csv")
    factors = np.array(list(makers.MULTIANGLE_ROWS.values()))
    np.testing.assert_allclose(samples.values[:, 0], factors / np.pi)
    assert samples.provenance["instrument"] == "made"
    turned = tmp_path / "b.csv"
    turned.write_text("# values: percent\nwavelength,45as15,45as110\n400,10,20\n500,30,40\n700,50,60\n")
    samples = measured.read(turned)
    assert nanometers(samples) == [400, 500, 700]
    np.testing.assert_allclose(samples.values * np.pi, [[0.1, 0.3, 0.5], [0.2, 0.4, 0.6]])


def test_plain_csv_rules(tmp_path):
    samples = read(tmp_path, "plain.csv")
    assert samples.name == "made"
    np.testing.assert_allclose(polar(samples.wo), [20, 40, 60])
    np.testing.assert_allclose(samples.values[:, 2], [0.3, 0.2, 4.5])
    path = tmp_path / "b.csv"
    path.write_text(
        "# angles: radians\n# values: f_cos_o\n# origin: made\n"
        "phi_o,theta_o,theta_i,phi_i,R,G,B,valid,weight,sigma\n0.1,1.0,0.5,0,1,2,3,1,2,0.5\n0.1,1.0,0.5,0,1,2,3,0,1,0.5\n"
    )
    samples = measured.read(path)
    np.testing.assert_allclose(samples.values[0], np.array([1, 2, 3]) / np.cos(1.0))
    assert samples.sigma is not None
    np.testing.assert_allclose(samples.sigma[0], 0.5 / np.cos(1.0))
    assert samples.valid.tolist() == [True, False]
    np.testing.assert_allclose(samples.weights, [2 / 3, 1 / 3])
    assert samples.provenance["origin"] == "made"


# What is right, what stands there instead, and what is said.
SPOILED = {
    ("zemax", "ScatterType BRDF", "ScatterType BTDF"): "only BRDF",
    ("zemax", "SpectralContent Monochrome", "SpectralContent Lab"): "Monochrome and XYZ",
    ("zemax", "ScatterRadial 4", "ScatterRadial four"): "number of its angles",
    ("zemax", "0 10 30 60", "0 30 10 60"): "do not rise",
    ("zemax", "Source Measured", "Kind Measured"): "unknown keyword 'Kind'",
    ("zemax", "TIS 1.5", "TOS 1.5"): "where a block of TIS",
    ("astm", "NUM_POINTS 3", "NUM_POINTS 4"): "NUM_POINTS 4, but 3 rows",
    ("astm", "465nm,525nm", "465nm,465nm"): "twice",
    ("astm", "theta_s", "theta_x"): "theta_i and theta_s are needed",
    ("astm", "465nm,525nm", "525nm,465nm"): "columns of values",
    ("astm", "1.0,0.0,1.2", "1.0,0.0,12"): "radians",
    ("alta", "#DIM 3 1", "#DIM 2 1"): "has 3 inputs",
    ("alta", "#DIM 3 1", "#DIM 3 1\n#VS 1"): "ranges are not read",
    ("alta", "#PARAM_IN ISOTROPIC_TL_TV_PROJ_DPHI", "#PARAM_IN STARK_3D"): "known are",
    ("alta", "#PARAM_OUT INV_STERADIAN_COSINE_FACTOR", "#PARAM_OUT ENERGY"): "known are",
    ("multiangle", "45as15,", "45as,"): "no geometry",
    ("multiangle", "45as110,", "45as140,"): "below the horizon",
    ("multiangle", "R,G,B\n", "L,a,b\n"): "beside geometry",
    ("multiangle", "geometry,", "# values: Lab\ngeometry,"): "allowed are",
}


def spoiled(path, maker, right, wrong):
    """A made file with something wrong in it."""
    getattr(makers, f"{maker}_file")(path)
    text = path.read_text()
    assert right in text
    path.write_text(text.replace(right, wrong))
    return path


@pytest.mark.parametrize("fault", SPOILED, ids=" ".join)
def test_faults_are_named(fault, tmp_path):
    maker = fault[0]
    path = tmp_path / ("a.csv" if maker == "multiangle" else f"a.{maker}")
    with pytest.raises(InputError, match=SPOILED[fault]):
        measured.read(spoiled(path, *fault))


def test_a_value_of_zemax_may_differ_from_the_stated_total(tmp_path):
    path = spoiled(tmp_path / "a.zemax", "zemax", "TIS 1.5\n13.0", "TIS 1.5\n1.0")
    assert measured.read(path).values[12, 0] == 1.0


PLAIN_WRONG = {
    "no column theta_i": "theta_o,phi_i,phi_o,f\n1,2,3,4\n",
    "columns of values g, h": "theta_i,phi_i,theta_o,phi_o,g,h\n1,2,3,4,5,6\n",
    "columns of values (none)": "theta_i,phi_i,theta_o,phi_o\n1,2,3,4\n",
    "is no number": "theta_i,phi_i,theta_o,phi_o,f\n1,2,3,4,five\n",
    "twice": "theta_i,phi_i,theta_o,phi_o,f,f\n1,2,3,4,5,5\n",
    "beyond 180": "# angles: radians\ntheta_i,phi_i,theta_o,phi_o,f\n45,2,3,4,5\n",
    "allowed are degrees": "# angles: gon\ntheta_i,phi_i,theta_o,phi_o,f\n1,2,3,4,5\n",
    "other numbers than 0 and 1": "theta_i,phi_i,theta_o,phi_o,f,valid\n1,2,3,4,5,2\n",
    "weight must be": "theta_i,phi_i,theta_o,phi_o,f,weight\n1,2,3,4,5,-1\n",
    "give sigma, or sigma_NAME": "theta_i,phi_i,theta_o,phi_o,f,sigma_g\n1,2,3,4,5,1\n",
    "no rows": "theta_i,phi_i,theta_o,phi_o,f\n",
}


@pytest.mark.parametrize("message", PLAIN_WRONG)
def test_plain_csv_faults_are_named(message, tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(PLAIN_WRONG[message])
    with pytest.raises(InputError) as caught:
        measured.read(path)
    assert message in str(caught.value)


@pytest.mark.parametrize("name", ["paint.mbsdf", "paint.astm"])
def test_any_samples_come_back_from_plain_csv(name, tmp_path):
    samples = read(tmp_path, name)
    path = tmp_path / "copy.csv"
    plain_csv.write(path, samples)
    back = measured.read(path)
    for attribute in ("wi", "wo", "weights"):
        np.testing.assert_allclose(getattr(back, attribute), getattr(samples, attribute), atol=1e-14)
    np.testing.assert_array_equal(back.values, samples.values)
    np.testing.assert_array_equal(back.valid, samples.valid)
    assert back.name == samples.name
    assert type(back.channels) is type(samples.channels)


def test_text_in_another_encoding_is_refused(tmp_path):
    path = tmp_path / "a.csv"
    for data, message in ((b"theta_i,phi_i,theta_o,phi_o,f\n\xff\n", "UTF-8"), ("theta_i".encode("utf-16"), "a.csv")):
        path.write_bytes(data)
        with pytest.raises(InputError, match=message):
            measured.read(path)
