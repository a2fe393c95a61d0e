"""Conventions of directions and angles."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axffit import frames

ANGLE = st.floats(0.0, np.pi / 2)
AZIMUTH = st.floats(-np.pi, np.pi)


def scalar(*values):
    return tuple(jnp.asarray(v, float) for v in values)


@given(st.floats(1e-6, np.pi / 2), st.floats(1e-6, np.pi / 2 - 1e-6), AZIMUTH, AZIMUTH)
def test_half_difference_angles_return(theta_h, theta_d, phi_d, phi_h):
    angles = scalar(theta_h, theta_d, phi_d, phi_h)
    wi, wo = frames.half_difference_to_directions(*angles)
    np.testing.assert_allclose([jnp.linalg.norm(wi), jnp.linalg.norm(wo)], 1.0, rtol=1e-14)
    back = frames.directions_to_half_difference(wi, wo)
    # The half vector has length 2 cos theta_d: its direction is known to eps over that.
    slack = 1e-15 / np.cos(theta_d) + 1e-13
    np.testing.assert_allclose(back[0], theta_h, atol=slack)
    np.testing.assert_allclose(back[1], theta_d, atol=1e-13)
    for got, expected, sine in ((back[2], phi_d, np.sin(theta_d)), (back[3], phi_h, 1.0)):
        turn = np.angle(np.exp(1j * (float(got) - expected)))
        assert abs(turn) <= slack / (sine * np.sin(theta_h))


def test_difference_angle_keeps_its_digits_at_both_ends():
    for theta_d in (1e-9, np.pi / 2 - 1e-9):
        wi, wo = frames.half_difference_to_directions(*scalar(0.0, theta_d, 0.3))
        assert frames.directions_to_half_difference(wi, wo)[1] == pytest.approx(theta_d, abs=1e-16, rel=1e-7)


def test_exchanging_the_directions_turns_phi_d_by_pi_and_nothing_else():
    rng = np.random.default_rng(1)
    v = frames.spherical_to_direction(
        jnp.asarray(rng.uniform(0, 1.5, (2, 500))), jnp.asarray(rng.uniform(-3, 3, (2, 500)))
    )
    there, back = frames.directions_to_half_difference(v[0], v[1]), frames.directions_to_half_difference(v[1], v[0])
    for k in (0, 1, 3):
        np.testing.assert_allclose(there[k], back[k], atol=1e-14)
    np.testing.assert_allclose(np.cos(there[2] - back[2]), -1.0, atol=1e-12)


@given(ANGLE, AZIMUTH)
def test_spherical_coordinates_return(theta, phi):
    v = frames.spherical_to_direction(*scalar(theta, phi))
    back = frames.direction_to_spherical(v)
    np.testing.assert_allclose(frames.spherical_to_direction(*back), v, atol=1e-15)
    assert float(back[0]) == pytest.approx(theta, abs=1e-15)


def test_rotation_takes_its_own_axis_to_x():
    g = jnp.asarray(0.7)
    axis = jnp.stack([jnp.cos(g), jnp.sin(g), jnp.zeros(())])
    np.testing.assert_allclose(frames.rotate_tangent(axis, g), [1, 0, 0], atol=1e-16)
    np.testing.assert_allclose(
        frames.to_local(frames.tangent_frame(jnp.asarray([0.0, 0, 1]), g), axis), [1, 0, 0], atol=1e-16
    )


@given(st.floats(0, 3.0), AZIMUTH, st.floats(0.01, 100), AZIMUTH)
def test_tangent_frame_is_a_rotation_onto_the_normal(theta, phi, length, g):
    normal = length * frames.spherical_to_direction(*scalar(theta, phi))
    frame = frames.tangent_frame(normal, jnp.asarray(g))
    np.testing.assert_allclose(frame @ frame.T, np.eye(3), atol=2e-12)
    assert float(jnp.linalg.det(frame)) == pytest.approx(1.0, abs=2e-12)
    v = jnp.asarray([0.3, -0.2, 0.9])
    np.testing.assert_allclose(frames.to_world(frame, frames.to_local(frame, v)), v, atol=1e-12)
    np.testing.assert_allclose(frame[2], normal / jnp.linalg.norm(normal), atol=1e-14)


def test_tangent_frame_gradients_are_finite_and_zero_where_undefined():
    jacobian = jax.jacobian(frames.tangent_frame)
    np.testing.assert_array_equal(jacobian(jnp.zeros(3)), np.zeros((3, 3, 3)))
    at_normal = jacobian(jnp.asarray([0.0, 0.0, 1.0]))
    expected = np.zeros((3, 3, 3))
    expected[0, 2, 0] = expected[1, 2, 1] = -1  # the tangents dip by as much as the normal leans
    expected[2, 0, 0] = expected[2, 1, 1] = 1
    np.testing.assert_allclose(at_normal, expected, atol=1e-15)
    assert jnp.isfinite(jacobian(jnp.asarray([0.0, 0.0, -1.0]))).all()


@given(ANGLE, AZIMUTH, st.floats(1.0, 3.0))
def test_refraction_obeys_snell_in_the_plane_of_incidence(theta, phi, ior):
    v = frames.spherical_to_direction(*scalar(theta, phi))
    normal = jnp.asarray(frames.NORMAL)
    inside = frames.refract(v, normal, jnp.asarray(ior))
    np.testing.assert_allclose(jnp.linalg.norm(inside), 1.0, rtol=1e-14)
    np.testing.assert_allclose(inside[:2] * ior, v[:2], atol=1e-15)
    assert inside[2] >= np.sqrt(1 - 1 / ior**2) - 1e-12


def test_refraction_at_total_reflection_stays_finite():
    v = frames.spherical_to_direction(*scalar(1.2, 0.0))
    value, slope = jax.value_and_grad(lambda n: frames.refract(v, jnp.asarray(frames.NORMAL), n)[2])(jnp.asarray(0.5))
    assert (value, slope) == (0, 0)


def test_reflect_mirrors():
    normal = jnp.asarray([0.0, 0.6, 0.8])
    v = jnp.asarray([0.0, 0.0, 1.0])
    mirrored = frames.reflect(v, normal)
    np.testing.assert_allclose(frames.dot(mirrored, normal), frames.dot(v, normal), rtol=1e-15)
    np.testing.assert_allclose(mirrored + v, 2 * 0.8 * normal, rtol=1e-15)
