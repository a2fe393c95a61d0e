"""docs/formats.md is what its script computes, and names every format."""

import runpy
from pathlib import Path

import numpy as np
import pytest

from axffit.textures import FORMATS

DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "formats.md").read_text(encoding="utf-8")
MAKE = runpy.run_path(str(DOCS / "make_formats.py"))


@pytest.mark.parametrize(
    ("name", "table"),
    [("channels", "channels_table"), pytest.param("unit vectors", "unit_vectors_table", marks=pytest.mark.slow)],
)
def test_the_tables_are_what_the_script_computes(name, table):
    written = PAGE.split(f"<!-- {name} -->\n")[1].split(f"<!-- end of {name} -->\n")[0]
    assert written == MAKE[table]()


def test_every_kind_of_channel_is_in_the_table():
    kinds = {codec for form in FORMATS.values() for codec in form.codecs if codec.error_bound(np.array([0.5])).any()}
    assert kinds == set(MAKE["CHANNELS"].values())
