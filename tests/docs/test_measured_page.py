"""The CSV of docs/measured.md is read, and its table names every format."""

import re

from axffit import measured
from tests.conftest import PROJECT

PAGE = (PROJECT / "docs" / "measured.md").read_text(encoding="utf-8")


def test_the_examples_are_read(tmp_path):
    blocks = [block for block in re.findall(r"```\n(.*?)```", PAGE, re.DOTALL) if "," in block]
    assert len(blocks) == 2
    for block in blocks:
        path = tmp_path / "example.csv"
        path.write_text(block)
        assert measured.read(path).valid.all()


def test_every_format_has_a_row():
    rows = [line.split("|")[1] for line in PAGE.splitlines() if line.startswith("| ")]
    words = [row.strip().replace("`", "").split()[0].lower() for row in rows]
    for form in measured.FORMATS:
        assert form.name.split()[0].lower() in words
