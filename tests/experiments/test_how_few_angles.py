"""Experiment 07: a part of it again."""

import pytest

from experiments import common

NAME = "07_how_few_angles"


@pytest.mark.slow
def test_the_first_paint_comes_out_again():
    found = common.rounded(common.load(NAME).subset())
    (paint, *_) = common.committed(NAME)["paints"].values()
    for name, case in found.items():
        committed = paint[name]["1"]
        assert case["outcome"] == committed["outcome"]
        assert case.get("not_identified") == committed.get("not_identified")
        if "log_everywhere" in committed:
            assert case["log_everywhere"] == pytest.approx(committed["log_everywhere"], rel=0.02)
