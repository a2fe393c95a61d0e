"""A BRDF whose parameters are maps."""

import jax.numpy as jnp
import numpy as np

from axffit.brdf import GGX, SVBRDF, CarPaint, Flakes, Framed, Lambert, Schlick1994, Sum, constant_map, texture_map

RNG = np.random.default_rng(11)
COLOR, ROUGHNESS = RNG.random((4, 8, 3)), RNG.uniform(0.1, 0.5, (2, 2, 2))
NORMAL = np.concatenate([RNG.normal(scale=0.1, size=(8, 8, 2)), np.ones((8, 8, 1))], axis=-1)
ANGLE = RNG.uniform(-1, 1, (16, 4, 1))
WI, WO = jnp.asarray([0.48, 0.36, 0.8]), jnp.asarray([-0.6, 0.0, 0.8])


def build(shared, texel):
    lobe = GGX(texel["specular"], texel["roughness"], Schlick1994(texel["f0"]))
    return Framed(Sum((Lambert(texel["color"]), lobe)), texel["normal"], texel["angle"][0])


def material(**options):
    maps = {
        "color": texture_map([COLOR]),
        "roughness": texture_map([ROUGHNESS]),
        "normal": texture_map([NORMAL]),
        "angle": texture_map([ANGLE]),
        "specular": constant_map(np.asarray([0.9, 0.8, 0.7])),
        "f0": constant_map(np.asarray([0.04])),
    }
    return SVBRDF(maps, build, **options)


def test_maps_of_different_sizes_meet_at_one_uv():
    uv = jnp.asarray([0.41, 0.87])
    m = material()
    texel = {name: texture.fetch(uv) for name, texture in m.maps.items()}
    np.testing.assert_allclose(m.evaluate(uv, WI, WO), build(None, texel).evaluate(WI, WO), rtol=1e-13)


def test_batches_of_places_and_directions_broadcast():
    m = material()
    uv = jnp.asarray(RNG.random((5, 1, 2)))
    wi = jnp.stack([WI, WO])
    values = m.evaluate(uv, wi, WO)
    assert values.shape == (5, 2, 3)
    np.testing.assert_allclose(values[3, 1], m.at(uv[3, 0]).evaluate(WO, WO), rtol=1e-12)


def test_uv_is_position_over_size_and_repeats():
    m = material(size_mm=(20.0, 10.0))
    np.testing.assert_allclose(m.uv(jnp.asarray([5.0, 5.0])), [0.25, 0.5])
    here, next_tile = (m.evaluate(m.uv(jnp.asarray(p)), WI, WO) for p in ([5.0, 5.0], [25.0, -5.0]))
    np.testing.assert_allclose(here, next_tile, rtol=1e-12)


def test_opacity():
    assert material().opacity(jnp.asarray([0.1, 0.2])) == 1
    half = material(alpha=constant_map(np.asarray([0.5])))
    assert half.opacity(jnp.asarray([0.1, 0.2])) == 0.5


def test_parallax_of_a_raised_plane_is_the_similar_triangle():
    raised = material(size_mm=(10.0, 20.0), height=constant_map(np.asarray([2.0])))
    uv = raised.parallax(jnp.asarray([0.5, 0.5]), WO)
    np.testing.assert_allclose(uv, [0.5 + 2.0 * (-0.6 / 0.8) / 10, 0.5], rtol=1e-12)
    np.testing.assert_array_equal(material().parallax(jnp.asarray([0.5, 0.5]), WO), [0.5, 0.5])


def test_parallax_of_a_step_stops_at_the_wall():
    """The viewer is on the +u side of a block of 1 mm on the tile's middle half: its wall hides the floor behind."""
    width = 512
    step = np.zeros((1, width, 1))
    step[:, width // 4 : 3 * width // 4] = 1.0
    m = material(size_mm=(10.0, 10.0), height=texture_map([step]))
    # The ray through u = .7 on the floor is 3/8 mm high at the wall, u = .75.
    hit = m.parallax(jnp.asarray([0.7, 0.5]), jnp.asarray([0.8, 0.0, 0.6]), steps=400)
    assert abs(float(hit[0]) - 0.75) < 3 / width


def test_flakes_find_their_place_through_the_texel():
    slices = texture_map([RNG.random((2, 8, 8, 3))])

    def paint(slices, texel):
        place = {"uv": texel["uv"], "level": slices.level_of(texel["footprint"])}
        flakes = Flakes(slices, (0, 2, 2), num_theta_f=1, num_theta_i=1, max_theta_i=2, **place)
        return CarPaint(0.1, (0.0,), (0.0,), (1.0,), flakes=flakes)

    m = SVBRDF({}, paint, slices)
    uv = jnp.asarray([[0.1, 0.2], [0.6, 0.2]])
    values = m.evaluate(uv, WI, WO)
    assert not np.allclose(values[0], values[1])
    np.testing.assert_allclose(
        values[1], paint(slices, {"uv": uv[1], "footprint": jnp.asarray(0.0)}).evaluate(WI, WO), rtol=1e-12
    )


def test_a_footprint_chooses_each_maps_own_level():
    fine, coarse = RNG.random((8, 8, 3)), RNG.random((1, 1, 3))
    levels = [fine, RNG.random((4, 4, 3)), RNG.random((2, 2, 3)), coarse]
    m = SVBRDF({"color": texture_map(levels), "other": texture_map(levels[2:])}, lambda _, t: Lambert(t["color"]))
    uv = jnp.asarray([0.3, 0.7])
    for footprint, level in ((0.0, 0.0), (1 / 8, 0.0), (1 / 4, 1.0), (0.3, np.log2(2.4)), (1.0, 3.0), (7.0, 3.0)):
        at = m.at(uv, jnp.asarray(footprint))
        assert isinstance(at, Lambert)
        np.testing.assert_allclose(at.color, m.maps["color"].fetch(uv, jnp.asarray(level)), rtol=1e-12)
    assert m.maps["other"].level_of(jnp.asarray(1.0)) == 1.0
