"""The committed report on car paints, and two paints computed again."""

import numpy as np
import pytest

from experiments import common

NAME = "06_which_model_for_car_paint"


@pytest.mark.slow
@pytest.mark.parametrize("name", ["cc_ibiza_sunset", "color-changing-paint2"])
def test_a_paint_comes_out_again(reference_data, name):
    experiment = common.load(NAME)
    data = reference_data("nbrdf_measured").parent
    again = experiment.subset(data, name, "log")
    reported = common.committed(NAME)["paints"][name]["log"]["car paint"]
    for label in ("full", "one color", "single ggx"):
        for key, value in again[label].items():
            assert value == pytest.approx(reported[label][key], rel=1e-3), (label, key)


def test_either_set_of_azimuths_holds_its_directions_both_ways_round(reference_data):
    experiment = common.load(NAME)
    data = reference_data("nbrdf_measured").parent
    fitted, judged = experiment.samples_of(data, "cc_ibiza_sunset")
    for samples in (fitted, judged):
        polar = np.round(np.stack([samples.wi[:, 2], samples.wo[:, 2]], axis=1), 9)
        assert {*map(tuple, polar)} == {*map(tuple, polar[:, ::-1])}
    sets = [{*map(tuple, np.round(np.hstack([one.wi, one.wo]), 9))} for one in (fitted, judged)]
    assert not sets[0] & sets[1]


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
