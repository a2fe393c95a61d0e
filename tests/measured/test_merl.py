import struct

import numpy as np
import pytest

from axffit import measured
from axffit.errors import InputError
from axffit.measured import merl

# Written out by hand: theta_h, theta_d and phi_d in degrees at the cell's center, and the number's place in its plane,
# phi_d + 180 theta_d + 16200 theta_h, with theta_h index = 90 sqrt(theta_h / 90 degrees) rounded down.
CELLS = [
    (0.0028, 0.5, 0.5, 0),
    (0.0028, 0.5, 1.5, 1),
    (0.0028, 0.5, 179.5, 179),
    (0.0028, 1.5, 0.5, 180),
    (0.0028, 89.5, 0.5, 16020),
    (0.0250, 0.5, 0.5, 16200),
    (0.0694, 0.5, 0.5, 32400),
    (0.1361, 10.5, 20.5, 3 * 16200 + 1820),
    (0.2250, 44.5, 90.5, 4 * 16200 + 8010),
    (0.4694, 30.5, 45.5, 6 * 16200 + 5445),
    (1.0028, 0.5, 0.5, 9 * 16200),
    (2.0250, 0.5, 0.5, 13 * 16200),
    (1.2250, 0.5, 0.5, 10 * 16200),
    (5.1361, 60.5, 90.5, 21 * 16200 + 10890),
    (10.3361, 5.5, 135.5, 30 * 16200 + 1035),
    (23.0028, 20.5, 10.5, 45 * 16200 + 3610),
    (40.6694, 30.5, 100.5, 60 * 16200 + 5500),
    (50.6250, 10.5, 90.5, 67 * 16200 + 1890),
    (70.2250, 3.5, 0.5, 79 * 16200 + 540),
    (85.0694, 1.5, 90.5, 87 * 16200 + 270),
]


@pytest.fixture(scope="module")
def written_by_hand(tmp_path_factory):
    """Numbers at places counted by hand: plane c of cell k holds 1500 (k + 1) (c + 1), the others -1."""
    planes = np.full((3, 90 * 90 * 180), -1.0)
    for k, place in enumerate(sorted({cell[3] for cell in CELLS})):
        planes[:, place] = 1500.0 * (k + 1) * np.array([1, 2, 3])
    path = tmp_path_factory.mktemp("merl") / "hand.binary"
    path.write_bytes(struct.pack("<iii", 90, 90, 180) + planes.astype("<f8").tobytes())
    return path


def half_difference(theta_h, theta_d, phi_d):
    theta_h, theta_d, phi_d = np.radians([theta_h, theta_d, phi_d])
    half = np.array([np.sin(theta_h), 0, np.cos(theta_h)])
    x = np.array([np.cos(theta_h), 0, -np.sin(theta_h)])
    across = np.cos(phi_d) * x + np.sin(phi_d) * np.array([0, 1, 0])
    return [np.cos(theta_d) * half + sign * np.sin(theta_d) * across for sign in (1, -1)]


def test_twenty_cells_lie_where_the_index_table_written_by_hand_says(written_by_hand):
    samples = measured.read(written_by_hand)
    order = {place: k for k, place in enumerate(sorted({cell[3] for cell in CELLS}))}
    assert samples.valid.sum() == len(order)
    found = {}
    for theta_h, theta_d, phi_d, place in CELLS:
        wi, wo = half_difference(theta_h, theta_d, phi_d)
        distance = np.abs(samples.wi - wi).max(axis=1) + np.abs(samples.wo - wo).max(axis=1)
        nearest = distance.argmin()
        value = (order[place] + 1) * np.array([1.0, 2 * 1.15, 3 * 1.66])
        np.testing.assert_allclose(samples.values[nearest], value, rtol=1e-14)
        found[place] = nearest
    assert sorted(found.values()) == np.flatnonzero(samples.valid).tolist()


def test_a_table_comes_back(tmp_path):
    table = np.random.default_rng(2).uniform(-0.2, 1.0, (*merl.SHAPE, 3))
    path = tmp_path / "a.binary"
    merl.write_table(path, table)
    np.testing.assert_allclose(merl.read_table(path), table, rtol=1e-15)
    with pytest.raises(ValueError, match="shape"):
        merl.write_table(path, table[1:])


def test_a_big_endian_header_is_named(tmp_path):
    path = tmp_path / "swapped.binary"
    path.write_bytes(struct.pack(">iii", 90, 90, 180) + bytes(100))
    with pytest.raises(InputError, match="big-endian"):
        measured.read(path)
