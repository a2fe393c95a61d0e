"""The committed report of the published fits, held against a few materials fitted again."""

import pytest

from experiments import common

NAME = "05_published_fits"


def test_the_report_keeps_what_was_promised():
    report = common.committed(NAME)
    summary = report["summary"]
    assert summary["failures"] == []
    medians = summary["median_ratio_to_the_better_of_E1_and_E2"]
    assert medians["log"] <= 0.94
    assert medians["cube-root"] <= 0.82
    counts = {title: row["log"]["materials"] for title, row in summary["tables"].items()}
    assert counts == {"Löw E1": 60, "Löw E2": 60, "Ngan CT": 51, "Ngan Ward": 51, "Ngan Ward-Dür": 51}


def test_the_medians_of_the_published_parameters_are_those_of_the_reference():
    for title, row in common.committed(NAME)["summary"]["tables"].items():
        for metric, one in row.items():
            digits = 1e-4 if one["median_published_expected"] < 0.1 else 1e-3
            assert one["median_published"] == pytest.approx(one["median_published_expected"], abs=0.51 * digits), (
                title,
                metric,
            )


@pytest.mark.parametrize(
    ("material", "metric"),
    [
        pytest.param("delrin", "cosine", marks=pytest.mark.slow),
        pytest.param("chrome", "log", marks=pytest.mark.slow),
    ],
)
def test_a_subset_comes_out_again(reference_data, material, metric):
    experiment = common.load(NAME)
    data = reference_data("merl_published_fits").parent
    again = common.rounded(experiment.subset(data, (material,), (metric,)))[material]
    reported = common.committed(NAME)["materials"][material]
    for title, errors in again["published"].items():
        assert errors[metric] == pytest.approx(reported["published"][title][metric], rel=1e-5)
    for label, fits in again["fits"].items():
        assert fits[metric]["error"] == pytest.approx(reported["fits"][label][metric]["error"], rel=1e-4)
