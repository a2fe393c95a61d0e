"""The nine defects of public AxF implementations (axf-models section 8): ours has none of them.

Each defect has a check that takes an implementation as an argument. Ours passes it, and so that the check is known to
see the defect, every mutant that has it fails.
"""

import itertools
from collections.abc import Callable
from dataclasses import dataclass

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import pytest

from axffit.brdf import GGX, ColorTable, CookTorrance, Flakes, Fresnel1818, NoFresnel, texture_map
from axffit.brdf.fresnel import AbstractFresnel
from axffit.errors import InputError
from axffit.frames import half_difference_to_directions, spherical_to_direction
from axffit.hemisphere import directional_albedo
from axffit.numerics import normalize
from axffit.quantization.slice_lut import DECODES
from axffit.textures.formats import format_named
from axffit.textures.rerange import SliceIndex
from tests.brdf.test_fresnel import cook_torrance_1981

WHITE = jnp.ones(3)


def pairs(count=200, seed=0):
    rng = np.random.default_rng(seed)
    cosine, phi = jnp.asarray(rng.uniform(0.05, 1, (2, count))), jnp.asarray(rng.uniform(-np.pi, np.pi, (2, count)))
    return tuple(spherical_to_direction(jnp.arccos(c), p) for c, p in zip(cosine, phi, strict=True))


def lookup(table, theta_h, theta_d):
    return np.asarray(table.lookup(jnp.asarray(theta_h), jnp.asarray(theta_d)))


# 1. HDRP 7: Fresnel1818 computed and thrown away.


def check_that_the_exact_fresnel_counts(fresnel: Callable[[float], AbstractFresnel]):
    theta_d = jnp.linspace(0.1, 1.3, 7)
    wi, wo = half_difference_to_directions(jnp.zeros(7), theta_d, jnp.full(7, 0.4))
    share = GGX(WHITE, 0.3, fresnel(0.04)).evaluate(wi, wo) / GGX(WHITE, 0.3, NoFresnel()).evaluate(wi, wo)
    expected = [float(cook_torrance_1981(float(np.cos(theta)), 0.04)) for theta in theta_d]
    np.testing.assert_allclose(share[:, 0], expected, rtol=1e-10)


class ThrownAway(AbstractFresnel):
    f0: jnp.ndarray = eqx.field(converter=jnp.asarray)

    def factor(self, cos_d, one_minus_cos_d):
        Fresnel1818(self.f0).factor(cos_d, one_minus_cos_d)
        return jnp.ones_like(cos_d)


# 2. HDRP's Cook-Torrance of SVBRDFs lacks 1 / (i_z o_z).


def check_that_cook_torrance_reflects_its_light(lobe):
    """A narrow lobe in the documented normalization reflects 4 at every angle."""
    for theta in (0.0, 1.0):
        wo = spherical_to_direction(jnp.asarray(theta), jnp.asarray(0.0))
        albedo = directional_albedo(lobe(WHITE, 0.1), wo, polar_count=300, azimuth_count=300)
        assert float(albedo[0]) == pytest.approx(4.0, abs=0.02)


class WithoutCosines(CookTorrance):
    def value(self, wi, wo):
        return super().value(wi, wo) * wi[2] * wo[2]


# 3. A G1 with v_z in place of v_z² under the root.


def albedo_at_60_degrees(lobe) -> float:
    wo = spherical_to_direction(jnp.asarray(np.pi / 3), jnp.asarray(0.0))
    return float(directional_albedo(lobe(WHITE, 0.3), wo, polar_count=200, azimuth_count=200)[0])


def check_that_smiths_masking_is_smiths(lobe):
    assert albedo_at_60_degrees(lobe) == pytest.approx(3.273, abs=1e-3)


class Misprinted(GGX):
    def value(self, wi, wo):
        def ratio(z):
            square = self.roughness**2
            return (z + jnp.sqrt(square + (1 - square) * z * z)) / (z + jnp.sqrt(square + (1 - square) * z))

        return super().value(wi, wo) * (ratio(wi[2]) * ratio(wo[2]))


def test_the_misprint_loses_what_the_design_says():
    assert albedo_at_60_degrees(Misprinted) == pytest.approx(2.506, abs=1e-3)


# 4. UE: G called with its arguments in another order.


def check_that_g_is_cook_and_torrances(masking):
    """G by the lobe's value: 1 where nothing is shadowed, else what the nearer edge of the groove leaves."""
    wi, wo = pairs()
    h = normalize(wi + wo)
    i_z, o_z, h_z, c = wi[:, 2], wo[:, 2], h[:, 2], jnp.sum(h * wo, axis=-1)
    expected = jnp.minimum(1.0, 2 * h_z * jnp.minimum(i_z, o_z) / c)
    assert (expected < 1).any()
    assert (expected == 1).any()
    np.testing.assert_allclose(masking(wi, wo), expected, rtol=1e-10)


def masking_of_the_lobe(wi, wo):
    """Ours: the lobe divided by what else is in it."""
    i_z, o_z = wi[:, 2], wo[:, 2]
    h = normalize(wi + wo)
    density = jnp.exp((h[:, 2] ** 2 - 1) / (h[:, 2] ** 2 * 0.25)) / (0.25 * h[:, 2] ** 4)
    return CookTorrance(WHITE, 0.5).evaluate(wi, wo)[:, 0] * jnp.pi * i_z * o_z / density


def masking_of_arguments(order):
    """Cook and Torrance's G(h_z, o_z, i_z, <h, o>) with its arguments in another order."""

    def masking(wi, wo):
        h = normalize(wi + wo)
        given = h[:, 2], wo[:, 2], wi[:, 2], jnp.sum(h * wo, axis=-1)
        h_z, o_z, i_z, c = (given[k] for k in order)
        return jnp.minimum(1.0, jnp.minimum(2 * h_z * o_z / c, 2 * h_z * i_z / c))

    return masking


RECIPROCAL = ((0, 1, 2, 3), (0, 2, 1, 3))  # G does not tell i and o apart
OTHER_ORDERS = [order for order in itertools.permutations(range(4)) if order not in RECIPROCAL]


# 5. MDL: bilinear weights applied to the wrong axes of the color table.


def check_that_weights_belong_to_their_axes(table):
    row, column = np.meshgrid(np.arange(4.0), np.arange(8.0), indexing="ij")
    ramp = table(np.stack([row, column, np.ones_like(row)], axis=-1))
    theta_h, theta_d = (5 + 0.75) / 8 * np.pi / 2, (2 + 0.6) / 4 * np.pi / 2
    np.testing.assert_allclose(lookup(ramp, theta_h, theta_d), [2.1, 5.25, 1], rtol=1e-12)


class ExchangedWeights(ColorTable):
    def lookup(self, theta_h, theta_d):
        height, width, _ = self.values.shape
        (column, u), (row, v) = self._texel(theta_h, width), self._texel(theta_d, height)
        low = (1 - v) * self.values[row, column] + v * self.values[row, column + 1]
        high = (1 - v) * self.values[row + 1, column] + v * self.values[row + 1, column + 1]
        return (1 - u) * low + u * high


class Transposed(ColorTable):
    def lookup(self, theta_h, theta_d):
        return super().lookup(theta_d, theta_h)


# 6. HDRP's first version: LUT bin limit taken from the next *virtual* bin.


def check_that_a_virtual_bin_ends_with_its_own(flakes):
    """Six bins of theta_d stored, twelve looked up, two slices each: bins 2k and 2k + 1 both show slices 2k, 2k + 1."""
    slices = np.broadcast_to(np.arange(1.0, 13.0)[:, None, None, None], (12, 1, 1, 3))
    model = flakes(texture_map([slices]), (0, 2, 4, 6, 8, 10, 12), num_theta_f=12, num_theta_i=6, max_theta_i=6)
    for bin_d in range(1, 11):
        angles = (np.array([1, bin_d]) - 0.5) * np.pi / 24
        np.testing.assert_allclose(lookup(model, *angles), 2 * (bin_d // 2) + 2, rtol=1e-9)


class NextVirtualBin(Flakes):
    def _along_theta_h(self, bin_i, bin_f, weight):
        lut = jnp.asarray((*self.slice_lut, 0, 0), jnp.int32)
        own, uv = self._own_bin(bin_i)
        following, _ = self._own_bin(bin_i + 1)

        def fetch(step):
            valid = (lut[own] + step < lut[following]) & (own < self.max_theta_i)
            texel = self.slices.fetch(uv, self.level, jnp.where(valid, lut[own] + step, 0))
            return jnp.where(valid, texel, jnp.zeros_like(texel))

        return (1.0 - weight) * fetch(bin_f) + weight * fetch(bin_f + 1)


# 7. uint(255 * texel) truncating a LUT entry.


def check_that_an_entry_comes_back(read):
    """However a device holds the texel k / 255."""
    for decode, texels in DECODES.items():
        np.testing.assert_array_equal(read(texels()), np.arange(256), err_msg=decode)


# 8. UE: int to 8 bit cast that wraps slices above 255.


def check_that_no_slice_wraps(store):
    """A table whose entries do not fit is refused by name, and never stored as other entries."""
    np.testing.assert_array_equal(store(np.array([0.0, 7.0, 255.0])), [0, 7, 255])
    for entries in ([0.0, 300.0], [256.0], [-1.0]):
        try:
            stored = store(np.array(entries))
        except InputError as refusal:
            assert f"{entries[-1]:g}" in str(refusal)  # noqa: PT017
        else:
            raise AssertionError(f"{entries} were stored as {stored}")


# 9. UE: floor instead of round when quantizing.


def check_that_quantizing_rounds(encode):
    """The nearest code, half a step away at most; floor is up to a whole one off, and half a step dark on average."""
    values = np.random.default_rng(9).random(20_000)
    error = encode(values) / 255 - values
    assert np.abs(error).max() <= 0.5 / 255 + 1e-12
    assert abs(error.mean()) < 0.02 / 255


R8_UNORM = format_named("R8_UNORM")
R8_UINT = format_named("R8_UINT")


def stored_as_unorm(entries):
    return R8_UNORM.encode(SliceIndex().forward(entries)[:, None])[:, 0]


def stored_as_uint(entries):
    return R8_UINT.encode(entries[:, None])[:, 0]


@dataclass(frozen=True)
class Defect:
    check: Callable
    ours: tuple
    mutants: dict[str, object]


DEFECTS = {
    "1 Fresnel thrown away": Defect(
        check_that_the_exact_fresnel_counts, (Fresnel1818,), {"thrown away": ThrownAway, "none": lambda f0: NoFresnel()}
    ),
    "2 no 1 / (i_z o_z)": Defect(
        check_that_cook_torrance_reflects_its_light, (CookTorrance,), {"without the cosines": WithoutCosines}
    ),
    "3 misprinted G1": Defect(check_that_smiths_masking_is_smiths, (GGX,), {"v_z under the root": Misprinted}),
    "4 order of G's arguments": Defect(
        check_that_g_is_cook_and_torrances,
        (masking_of_the_lobe, *map(masking_of_arguments, RECIPROCAL)),
        {f"order {order}": masking_of_arguments(order) for order in OTHER_ORDERS},
    ),
    "5 weights on the wrong axes": Defect(
        check_that_weights_belong_to_their_axes,
        (ColorTable,),
        {"exchanged weights": ExchangedWeights, "transposed": Transposed},
    ),
    "6 limit of the next virtual bin": Defect(
        check_that_a_virtual_bin_ends_with_its_own, (Flakes,), {"next virtual bin": NextVirtualBin}
    ),
    "7 entry truncated": Defect(
        check_that_an_entry_comes_back,
        (SliceIndex().inverse,),
        {"truncated": lambda texel: np.trunc(255 * texel), "floored": lambda texel: np.floor(texel * np.float32(255))},
    ),
    "8 slice wraps": Defect(
        check_that_no_slice_wraps,
        (stored_as_unorm, stored_as_uint),
        {
            "wrapped": lambda entries: entries.astype(int).astype(np.uint8),
            "clamped": lambda entries: np.clip(entries, 0, 255).astype(np.uint8),
        },
    ),
    "9 floored": Defect(
        check_that_quantizing_rounds,
        (lambda x: R8_UNORM.encode(x[:, None])[:, 0].astype(float),),
        {
            "cast": lambda x: (255 * x).astype(np.uint8).astype(float),
            "our own floor": lambda x: R8_UNORM.encode(x[:, None], "floor")[:, 0].astype(float),
        },
    ),
}
MUTANTS = [(defect, mutant) for defect, entry in DEFECTS.items() for mutant in entry.mutants]


@pytest.mark.parametrize("name", DEFECTS)
def test_ours_has_no_such_defect(name):
    for implementation in DEFECTS[name].ours:
        DEFECTS[name].check(implementation)


@pytest.mark.parametrize(("name", "mutant"), MUTANTS)
def test_an_implementation_with_the_defect_is_found(name, mutant):
    with pytest.raises(AssertionError):
        DEFECTS[name].check(DEFECTS[name].mutants[mutant])
