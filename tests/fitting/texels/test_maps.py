"""Standard errors of the maps: they cover the truth, and there are none where the data say nothing."""

import jax
import numpy as np
import pytest
from scipy import stats

from axffit.errors import InputError
from axffit.fitting.texels.batch import Outcome
from axffit.fitting.texels.maps import layout
from axffit.fitting.texels.noise import Noise
from axffit.fitting.texels.problem import TexelModel
from axffit.fitting.texels.reweighted import fit_pixels
from axffit.fitting.texels.synthetic import made, true_maps

FALSE_ALARM = 1e-6
NOISE = Noise(0.01, 1e-5, known=True)


def covered(model, channels, texels, noise, seed):
    """Texels and how many true values lie within 1.96 standard errors, by map and channel."""
    made_ = made(model, texels, channels=channels, noise=noise.relative, floor=noise.floor / noise.relative, seed=seed)
    fitted = fit_pixels(model, made_.wi, made_.wo, np.asarray(made_.samples.values), noise)
    truth = true_maps(model, made_)
    counts = {}
    for name, map_ in fitted.maps.items():
        off = map_.values - truth[name]
        if name == "anisrotation":
            off = (off + np.pi / 2) % np.pi - np.pi / 2
        for channel in range(len(off)):
            known = np.isfinite(map_.errors[channel])
            inside = np.abs(off[channel][known]) <= 1.959964 * map_.errors[channel][known]
            counts[f"{name}{channel}"] = int(known.sum()), int(inside.sum())
    return fitted, counts


@pytest.mark.slow
@pytest.mark.parametrize(("relative", "known"), [(0.01, True), (0.05, False)], ids=["stated", "guessed"])
def test_95_percent_intervals_cover_the_truth(relative, known):
    """Per parameter within 94 to 96 % plus what chance allows; false alarm 1e-6 for each of the parameters."""
    model = TexelModel(anisotropic=True)
    fitted, counts = covered(model, 1, 768, Noise(relative, 1e-5, known=known), seed=4)
    assert (fitted.outcome <= Outcome.FINISHED).all()
    for name, (total, inside) in counts.items():
        assert total > 0.7 * 768, name
        if name == "normal2":
            continue  # n_z is quadratic in the tilt where the normal is upright: linearization gives no interval there.
        low, high = (
            stats.binom.ppf(level, total, share) for level, share in ((FALSE_ALARM, 0.94), (1 - FALSE_ALARM, 0.96))
        )
        assert low <= inside <= high, f"{name}: {inside} of {total}, allowed {low:g} to {high:g}"


def test_what_the_data_do_not_determine_has_no_error():
    model = TexelModel(normal=False)
    texels = made(model, 8, noise=0.01)
    pixels = np.array(texels.samples.values)
    pixels[:, :, 0] = texels.wi[:, 2][None] * 0.5 / np.pi
    pixels[:, :, 1] = 0.0
    pixels[:, 3:, 2] = np.nan
    pixels[:, :, 3] = 1e9
    fitted = fit_pixels(model, texels.wi, texels.wo, pixels, Noise(saturation=1e6))
    maps = fitted.maps
    assert list(fitted.outcome[[2, 3]]) == [Outcome.CONVERGED, Outcome.TOO_FEW_SAMPLES]
    np.testing.assert_allclose(maps["diffusecolor"].values[:, 0], 0.5, rtol=1e-9)
    for lane in (1, 3):
        assert not any(map_.values[:, lane].any() for name, map_ in maps.items() if name.endswith("color"))
        assert np.isnan(maps["specularlobe"].errors[:, lane]).all()
        assert np.isnan(maps["diffusecolor"].errors[:, lane]).all()
    assert np.isfinite(maps["specularlobe"].errors[:, 4:]).all()
    assert set(maps) == set(layout(model, 3))


def test_answers_are_those_of_64_bits_without_jax_in_64_bit_mode():
    model = TexelModel(normal=False)
    texels = made(model, 4, images=16)
    pixels = np.asarray(texels.samples.values)
    with jax.enable_x64(new_val=False):
        narrow = fit_pixels(model, texels.wi, texels.wo, pixels, NOISE)
    wide = fit_pixels(model, texels.wi, texels.wo, pixels, NOISE)
    np.testing.assert_array_equal(narrow.maps["specularlobe"].values, wide.maps["specularlobe"].values)


@pytest.mark.slow
def test_a_round_lobe_has_no_rotation():
    model = TexelModel(anisotropic=True, normal=False)
    texels = made(TexelModel(normal=False), 32)
    fitted = fit_pixels(model, texels.wi, texels.wo, np.asarray(texels.samples.values), NOISE)
    undetermined = np.isnan(fitted.maps["anisrotation"].errors)
    assert undetermined.mean() > 0.9
    assert np.isfinite(fitted.maps["specularlobe"].errors).all()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"relative": -1.0}, "noise of -1"),
        ({"floor": 0.0}, "floor of 0"),
        ({"floor": float("nan")}, "floor of nan"),
        ({"saturation": 0.0}, "saturation of 0"),
    ],
)
def test_a_noise_that_is_none_is_refused(options, said):
    with pytest.raises(InputError, match=said):
        Noise(**options)
