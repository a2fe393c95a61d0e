"""The committed report on car paints, and one paint computed again."""

import pytest

from experiments import common

NAME = "06_which_model_for_car_paint"


@pytest.mark.slow
def test_a_paint_comes_out_again(reference_data):
    experiment = common.load(NAME)
    data = reference_data("nbrdf_measured").parent
    again = experiment.subset(data, "cc_ibiza_sunset", "log")
    reported = common.committed(NAME)["paints"]["cc_ibiza_sunset"]["log"]["car paint"]
    for label in ("full", "one color", "single ggx"):
        for key, value in again[label].items():
            assert value == pytest.approx(reported[label][key], rel=1e-3), (label, key)


def test_each_paint_is_reported_in_both_metrics():
    report, experiment = common.committed(NAME), common.load(NAME)
    assert set(report["paints"]) == {*experiment.MERL, *experiment.RGL}
    assert all(set(row) == {"log", "cube-root"} for row in report["paints"].values())
    assert set(report["nvidia"]) == {"red", "blue"}


def test_what_was_missed_is_in_the_report_by_name():
    report, experiment = common.committed(NAME), common.load(NAME)
    assert report["summary"]["missed"] == experiment.summary(report["paints"])["missed"]
    text = (common.ROOT / "reports" / NAME / "report.md").read_text(encoding="utf-8")
    assert all(line in text for line in report["summary"]["missed"])
