"""docs/formats.md is what its script computes, and names every format."""

import runpy
from pathlib import Path

import numpy as np
import pytest

from axffit.textures import FORMATS

DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "formats.md").read_text(encoding="utf-8")
MAKE = runpy.run_path(str(DOCS / "make_formats.py"))


def written(name: str) -> str:
    return PAGE.split(f"<!-- {name} -->\n")[1].split(f"<!-- end of {name} -->\n")[0]


def test_the_table_of_channels_is_what_the_script_computes():
    assert written("channels") == MAKE["channels_table"]()


@pytest.mark.slow
def test_the_table_of_unit_vectors_is_what_the_script_computes():
    # Bounds to the digit. What a search of wide components finds hangs on the last bit of this machine's sines: three
    # seeds of it differ by up to .13 %.
    page, computed = (text.splitlines() for text in (written("unit vectors"), MAKE["unit_vectors_table"]()))
    assert page[:2] == computed[:2]
    assert len(page) == len(computed)
    for a, b in zip(page[2:], computed[2:], strict=True):
        *names, found, ratio = a.strip("| ").split(" | ")
        *names_b, found_b, ratio_b = b.strip("| ").split(" | ")
        assert names == names_b
        assert float(found) == pytest.approx(float(found_b), rel=0.004), a
        assert float(ratio) == pytest.approx(float(ratio_b), rel=0.004, abs=1e-3), a


def test_every_kind_of_channel_is_in_the_table():
    kinds = {codec for form in FORMATS.values() for codec in form.codecs if codec.error_bound(np.array([0.5])).any()}
    assert kinds == set(MAKE["CHANNELS"].values())
