import dataclasses
import json
import math

import jax.numpy as jnp
import jsonschema
import numpy as np
import pytest

from axffit.brdf import Lambert
from axffit.errors import InputError
from axffit.fitting import compare
from axffit.fitting.compare import schema

from .paints import DIFFUSE, paint, sampled


def test_a_model_against_its_own_samples_is_exact():
    comparison = compare(paint(), sampled(paint()))
    assert comparison.metrics.log < 1e-15
    assert comparison.sentence == "The model reproduces every sample to rounding."


def test_the_sentence_names_the_region_that_was_spoiled():
    samples = sampled(paint())
    half = samples.wi + samples.wo
    theta_h = np.degrees(np.arctan2(np.hypot(half[:, 0], half[:, 1]), half[:, 2]))
    polar = np.degrees(np.arccos(np.minimum(samples.wi[:, 2], samples.wo[:, 2])))
    spoiled = (theta_h >= 5) & (theta_h < 15) & (polar < 30)
    assert spoiled.any()
    values = np.where(spoiled[:, None], samples.values / 1.25, samples.values)
    comparison = compare(paint(), dataclasses.replace(samples, values=values))
    assert "100% of the squared log error" in comparison.sentence
    assert "theta_h 5 to 15 degrees" in comparison.sentence
    assert "at 0 to 30)" in comparison.sentence
    assert "25% too bright" in comparison.sentence
    region = max(comparison.regions, key=lambda r: r.log_share)
    assert region.bias == pytest.approx(0.25)
    assert region.log_share == pytest.approx(1.0)


def test_regions_cover_every_sample_once():
    comparison = compare(Lambert(jnp.full(3, DIFFUSE)), sampled(paint()))
    assert sum(r.share for r in comparison.regions) == pytest.approx(1.0)
    assert sum(r.log_share for r in comparison.regions) == pytest.approx(1.0)
    assert sum(r.cosine_share for r in comparison.regions) == pytest.approx(1.0)
    assert sum(r.metrics.sample_count for r in comparison.regions) == comparison.metrics.sample_count
    assert "too dark" in comparison.sentence
    assert all(bias is not None and bias < 0 for bias in comparison.channel_bias)


def test_the_limits_of_the_data_stand_beside_the_metrics():
    samples = sampled(paint())
    wo, wi = samples.wi, samples.wo
    # Half of the samples brighter than their mirrored partners: no reciprocal model can follow.
    spoil = np.where(wi[:, 2] > wo[:, 2], 1.3, 1.0)[:, None]
    comparison = compare(paint(), dataclasses.replace(samples, values=samples.values * spoil))
    limit = comparison.limits[0]
    assert limit.kind == "reciprocal isotropic models"
    assert 0 < limit.log <= comparison.metrics.log
    assert limit.kind in comparison.sentence or "functions of" in comparison.sentence


def test_the_result_is_json_of_the_schema_even_for_black_data():
    samples = sampled(paint())
    black = dataclasses.replace(samples, values=np.zeros_like(samples.values))
    for measurements in (samples, black):
        content = compare(Lambert(jnp.full(3, 0.1)), measurements).to_json()
        jsonschema.validate(content, schema())
        json.dumps(content, allow_nan=False)
    assert "black" in compare(Lambert(jnp.full(3, 0.1)), black).sentence


def test_samples_without_a_usable_direction_are_refused():
    with pytest.raises(InputError, match="no valid sample"):
        compare(paint(), sampled(paint()), polar_limit=math.radians(0.5))
