"""The report on texels: its promises, and a part of it computed again."""

import pytest

from experiments import common

NAME = "09_texel_fit"


def test_the_report_keeps_what_was_demanded():
    experiment, data = common.load(NAME), common.committed(NAME)
    assert set(data["models"]) == set(experiment.MODELS)
    for row in data["models"].values():
        assert row["texels"] == 256 * 256
        assert row["at_best"] >= experiment.DEMANDED * row["texels"]
        assert row["outcomes"]["NOT_CONVERGED"] <= 0.001 * row["texels"]
        for name, share in row["coverage"].items():
            assert share == pytest.approx(0.95, abs=0.01), name


@pytest.mark.slow
def test_a_part_of_it_comes_out_again():
    small = common.rounded(common.load(NAME).subset())["small"]
    for name, row in common.committed(NAME)["small"].items():
        found = small[name]
        assert found.pop("chi_square_mean") == pytest.approx(row.pop("chi_square_mean"), rel=1e-4)
        assert found == row
